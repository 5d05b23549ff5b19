/// A run in the units of its own orbit (model/scaled_problem.hpp): its start and the weights of its norm there, and its
/// points back in the units of the user.
#pragma once

#include <memory>
#include <optional>

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
  Eigen::VectorXd sizes;  ///< of the states in the units of the user, n

  const HybridSystem& system() const { return problem->system(); }
};

/// `system` outlives the result. A state that is zero on the orbit has the size 1 / sqrt(THU) where THU is given.
OwnUnits in_own_units(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start);

/// The same where states that are zero on the orbit, as at a grazing point, have far other sizes next to it: those that
/// they have at the `first` point plus its tangent, which is as long as anything else changes by its size. None where
/// `own` will do.
std::optional<OwnUnits> in_units_along(const HybridSystem& system, const RunSettings& settings,
                                       const SelectedStart& start, const OwnUnits& own, const DefiningSystem& defining,
                                       const PathPoint& first);

/// The orbit and the tangent of a point, alone, in the units of the user.
PathPoint in_users_units(const PathPoint& point, const Eigen::VectorXd& units);

}  // namespace tchat
