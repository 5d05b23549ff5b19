#include "kinds/branch_point_start.hpp"

#include <fmt/format.h>

#include "base/user_error.hpp"
#include "orbit/curve_conditions.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "run/orbit_start.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

/// A branch point that the second parameter breaks has no curve in two parameters.
void refuse_broken(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start) {
  const std::vector<int> free = free_problem_parameters(settings);
  const PeriodicOrbitSystem plain(system, settings.signature(), free);
  const BranchPointBreaking breaking = branch_point_breaking(plain, start.start.orbit);
  if (!breaking.known || !breaking.by(1)) return;
  const std::string first_name = system.parameter_name(free[0]);
  const std::string second_name = system.parameter_name(free[1]);
  throw UserError(fmt::format(
      "{}: the branch point of label {} is one at this value of {} alone: the branches that cross there part when {} "
      "changes, so there is no curve of branch points in two parameters; with three there is: ISW = 3 and ICP = [{}, "
      "{}, ...] with a third parameter",
      start.source, start.label, second_name, second_name, first_name, second_name));
}

/// Where neither further parameter breaks the branch point, these are surfaces in three.
void refuse_persistent(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start) {
  const std::vector<int> free = free_problem_parameters(settings);
  const PeriodicOrbitSystem plain(system, settings.signature(), free);
  const Orbit& x = start.start.orbit;
  const BranchPointBreaking breaking = branch_point_breaking(plain, x);
  if (!breaking.known || breaking.by(1) || breaking.by(2)) return;
  throw UserError(
      fmt::format("{}: the branch point of label {} persists when {} or {} changes, as that of a symmetric system "
                  "does: such points "
                  "are surfaces in three parameters, and curves in two; use ISW = 2 with ICP = [{}, {}]",
                  start.source, start.label, system.parameter_name(free[1]), system.parameter_name(free[2]),
                  system.parameter_name(free[0]), system.parameter_name(free[1])));
}

}  // namespace

void start_persistent_branch_points(const HybridSystem& system, const RunSettings& settings, SelectedStart& start) {
  refuse_broken(system, settings, start);
}

void start_generic_branch_points(const HybridSystem& system, const RunSettings& settings, SelectedStart& start) {
  refuse_persistent(system, settings, start);
}

}  // namespace tchat
