/// A run in the units of its own orbit (model/scales.hpp): its start and the weights of its norm there, and its points
/// back in the units of the user.
#pragma once

#include <memory>

#include "continuation/path_follower.hpp"
#include "model/scales.hpp"
#include "run/orbit_start.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

/// What a run computes with. The sizes of states are those of the start, throughout the run.
struct OwnUnits {
  std::unique_ptr<ScaledProblem> problem;
  SelectedStart start;
  /// With THU, or default_weight(), for states in own units.
  RunSettings settings;

  Eigen::VectorXd units;  ///< none: all are 1

  const HybridSystem& system() const { return problem->system(); }
};

OwnUnits in_own_units(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start);

/// A point with its states and their changes along the tangent in the units of the user.
PathPoint in_users_units(const PathPoint& point, const Eigen::VectorXd& units);

}  // namespace tchat
