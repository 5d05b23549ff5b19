/// A run in the units of its own orbit (model/scaled_problem.hpp): its start and the weights of its norm there, and its
/// points back in the units of the user.
#pragma once

#include <memory>

#include "continuation/path_follower.hpp"
#include "model/scaled_problem.hpp"
#include "run/orbit_start.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

/// What a run computes with. The sizes of states are those of the start, throughout the run.
struct OwnUnits {
  std::unique_ptr<ScaledProblem> problem;
  SelectedStart start;
  RunSettings settings;   ///< with THU, or default_weight(), for states in own units
  Eigen::VectorXd units;  ///< of the states, n; none: all are 1

  const HybridSystem& system() const { return problem->system(); }
};

/// `system` outlives the result.
OwnUnits in_own_units(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start);

/// The orbit and the tangent of a point, alone, in the units of the user.
PathPoint in_users_units(const PathPoint& point, const Eigen::VectorXd& units);

}  // namespace tchat
