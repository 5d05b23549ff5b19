#include "run/branch_start.hpp"
#include "run/solver_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/user_error.hpp"
#include "continuation/branch_analysis.hpp"
#include "continuation/path_follower.hpp"
#include "files/labelled_solution.hpp"
#include "orbit/ring_system.hpp"
#include "run/first_correction.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

/// A matrix with a smaller scaled reciprocal condition leaves some direction undetermined.
constexpr double singular_condition = 1e-12;
/// The stored direction is a tangent when its angle to the tangent is smaller than about 2 degrees.
constexpr double parallel = 0.999;

/// The largest entries of the null direction, each as a share of the largest.
std::string undetermined(const HybridSystem& system, const DefiningSystem& defining, const OrbitVector& direction,
                         const OrbitShape& shape) {
  struct Entry {
    double size;
    std::string name;
  };
  std::vector<Entry> entries;
  for (int s = 0; s < shape.segments; ++s) {
    for (int a = 0; a < shape.dimension; ++a) {
      const double start = std::abs(direction.states(a, shape.first_node(s)));
      const double end = std::abs(direction.states(a, shape.last_node(s)));
      entries.push_back({std::max(start, end), fmt::format("{} on segment {}", system.state_name(a + 1), s + 1)});
    }
    entries.push_back({std::abs(direction.durations(s)), fmt::format("the duration of segment {}", s + 1)});
  }
  for (std::size_t g = 0; g < defining.free_parameters().size(); ++g)
    entries.push_back({std::abs(direction.globals(static_cast<Eigen::Index>(g))),
                       system.parameter_name(defining.free_parameters()[g])});
  double largest = 0.0;
  for (const Entry& e : entries) largest = std::max(largest, e.size);
  std::string text;
  for (const Entry& e : entries)
    if (e.size > 0.1 * largest) text += fmt::format("{}{}", text.empty() ? "" : ", ", e.name);
  return text;
}

void refuse_singular(PathFollower& follower, const DefiningSystem& defining, const PathPoint& point) {
  const CondensedSystem::Singularity singularity = follower.singularity(point);
  if (singularity.reciprocal_condition >= singular_condition) return;
  throw ComputationError(fmt::format(
      "the boundary value problem is singular (scaled reciprocal condition {:.1e}): it leaves {} undetermined, so that "
      "Newton converges only by luck; pin that direction, for instance by a jump that sets the state, or free another "
      "parameter (if this is the one point where branches cross, start beside it: its label BP is then found)",
      singularity.reciprocal_condition,
      undetermined(defining.system(), defining, singularity.direction, point.orbit.shape)));
}

/// On top of a branch point Newton's matrix is singular and the iteration stalls. A stored orbit that satisfies every
/// equation to the tolerance, or as well as a branch point can be interpolated, is taken as it is. To be called after
/// an attempt to correct it.
bool solves_without_correction(PathFollower& follower, const Orbit& stored, const RunSettings& settings) {
  const std::vector<NewtonIteration>& attempt = follower.newton().history();
  if (attempt.empty()) return follower.solves(stored);
  constexpr double interpolated = 1e-8;
  return attempt.front().residual <= std::max(newton_settings(settings).tolerance_states, interpolated);
}

/// Newton's method may go far along the branch that crosses, whose orbits solve the equations as well.
bool has_drifted(const Orbit& stored, const Orbit& corrected) {
  constexpr double far = 1e-5;  // what the digits of files and the errors of a label move is much smaller
  return (corrected.states - stored.states).cwiseAbs().maxCoeff() > far * (1.0 + stored.states.cwiseAbs().maxCoeff());
}

/// Files do not have the parameter that unfolds equations, which is zero at every solution.
OrbitStart with_unfolding(OrbitStart start, const DefiningSystem& system) {
  if (!system.unfolding(start.orbit)) return start;
  start.orbit.par(system.layout().unfolding(start.orbit.shape.segments) - 1) = 0.0;
  if (start.direction && start.direction->globals.size() < system.free_count()) {
    start.direction->globals.conservativeResize(system.free_count());
    start.direction->globals(system.free_count() - 1) = 0.0;
  }
  return start;
}

/// A branch point has two tangents, and the computed one is any mixture of them: the stored one belongs to the branch.
void use_direction(PathFollower& follower, const OrbitVector& direction, PathPoint& point) {
  point.tangent = direction;
  follower.renormalise(point);
}

}  // namespace

bool start_is_branch_point(const SelectedStart& selected) {
  constexpr int branch_point = static_cast<int>(PointType::branch_point);
  constexpr int of_equilibria = static_cast<int>(PointType::equilibrium_branch_point);
  const auto is_branch_point = [](int type) { return type == branch_point || type == of_equilibria; };
  const std::vector<int>& types = selected.types;
  return selected.from_solution &&
         (is_branch_point(basic_type(selected.type)) || std::any_of(types.begin(), types.end(), is_branch_point));
}

FirstPoint first_point(PathFollower& follower, const DefiningSystem& system, const SelectedStart& selected,
                       const RunSettings& settings) {
  const OrbitStart start = with_unfolding(selected.start, system);
  PathPoint point = follower.make_point(start.orbit);
  NewtonResult result;
  const bool fitting_direction = start.direction && is_same_problem_type(selected.problem_type, settings.problem_type);
  bool along = false;
  bool as_stored = false;
  if (fitting_direction && !selected.parameters_changed) {
    result = follower.start_along(point, *start.direction);
    if (start_is_branch_point(selected)) {
      const bool is_lost = !result.converged() || has_drifted(start.orbit, point.orbit);
      if (is_lost && solves_without_correction(follower, start.orbit, settings)) {
        point = follower.make_point(start.orbit);
        result.status = NewtonStatus::converged;
        as_stored = true;
      }
      if (result.converged()) use_direction(follower, *start.direction, point);
    }
    along = result.converged() && std::abs(follower.alignment(point, *start.direction)) > parallel;
  }
  FirstPoint first{std::move(point), {}, {}, along};
  std::string refusal;
  if (!along) {
    FirstCorrection corrected = correct_start(follower, system, selected, settings);
    refusal = std::move(corrected.refusal);
    first = {std::move(corrected.point), std::move(corrected.history), std::move(corrected.note), false};
    // Close to a branch point the tangent found from the nearly singular matrix may be that of the other branch.
    if (start_is_branch_point(selected) && fitting_direction && !selected.parameters_changed)
      use_direction(follower, *start.direction, first.point);
    // Another parameter value turns the tangent somewhat; without one, another signature has made the direction new.
    const double least = selected.parameters_changed ? 0.0 : parallel;
    const double cosine = fitting_direction ? follower.alignment(first.point, *start.direction) : 0.0;
    if (cosine < -least) follower.reverse(first.point);
    first.stored_direction = std::abs(cosine) > least;
  } else if (!as_stored) {
    first.correction = follower.newton().history();
  }
  std::string why_none =
      system.make_analysis(start.orbit.shape)->why_no_solution(first.point.orbit, start.orbit, selected.source);
  if (why_none.empty()) why_none = system.why_no_solution(first.point.orbit);
  if (!why_none.empty()) throw ComputationError(why_none);
  // A branch point is where the matrix is singular.
  if (!start_is_branch_point(selected)) refuse_singular(follower, system, first.point);
  if (!refusal.empty()) throw ComputationError(refusal);
  return first;
}

}  // namespace tchat
