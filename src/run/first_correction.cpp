#include "run/first_correction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "continuation/orbit_trend.hpp"
#include "continuation/path_follower.hpp"
#include "files/solution_file.hpp"
#include "model/function_values.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/mesh_adaptation.hpp"
#include "orbit/ring_system.hpp"
#include "plugin/problem_setup.hpp"
#include "run/solver_settings.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

/// What data of five digits explain: a fold or codimension-two point lies so far from the value that they give it.
constexpr double relative_move = level::five_digits;
constexpr double absolute_move = level::located;  // of the size that a parameter is known to have
/// A larger move of ICP(1) than by rounding is told.
constexpr double told_move = level::orbit;
/// The least part of the way from known to wanted parameter values that is tried as one step.
constexpr double smallest_part = 1.0 / 1024;
/// The largest change_between() orbits of such a step: further away are other branches.
constexpr double largest_change = 0.3;
constexpr int most_meshes = 10;
/// Meshes whose points have moved by less than this part of an interval are the same.
constexpr double settled = 0.1;

/// From here on a torus, or a chain whose report nobody reads to the end.
constexpr int many_segments = 12;

/// Lines of which there are too many to read: the largest, in their order.
std::string largest_lines(std::vector<std::pair<double, std::string>> lines) {
  constexpr std::size_t most = 24;
  std::string text;
  if (lines.size() > most) {
    std::vector<double> sizes;
    for (const auto& [value, line] : lines) sizes.push_back(std::isnan(value) ? HUGE_VAL : std::abs(value));
    std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(most), sizes.end(), std::greater<>());
    const double least = sizes[most];
    const std::size_t all = lines.size();
    std::erase_if(lines, [least](const auto& line) { return std::abs(line.first) <= least; });
    if (lines.size() > most) lines.resize(most);
    text = fmt::format(" (the {} largest of {})", lines.size(), all);
  }
  for (const auto& [value, line] : lines) text += line;
  return text;
}

std::string all_lines(const std::vector<std::pair<double, std::string>>& lines) {
  std::string text;
  for (const auto& [value, line] : lines) text += line;
  return text;
}

OrbitResidual residual_at(PathFollower& follower, const DefiningSystem& defining, const Orbit& x) {
  CondensedSystem& condensed = follower.condensed();
  OrbitResidual residual = condensed.make_residual();
  condensed.evaluate(x, residual);
  defining.integral_values(x, x, condensed.rule(), residual.integral.data());
  return residual;
}

/// The residual of each boundary condition of the uncorrected start, largest collocation defect included.
std::string residual_report(PathFollower& follower, const DefiningSystem& defining, const Orbit& start) {
  const CondensedSystem& condensed = follower.condensed();
  const OrbitResidual residual = residual_at(follower, defining, start);
  const int m = defining.segments();
  std::vector<std::pair<double, std::string>> lines;
  const auto add = [&lines](double value, const std::string& what) {
    lines.emplace_back(value, fmt::format("\n  {:11.4e}  {}", value, what));
  };
  std::size_t coupling = 0;
  const auto n = static_cast<std::size_t>(defining.dimension());
  const std::size_t per_segment = residual.collocation.size() / static_cast<std::size_t>(m);
  for (int s = 0; s < m; ++s) {
    double defect = 0.0;
    for (std::size_t i = 0; i < per_segment; ++i)
      defect = std::max(defect, defining.system().unit_of(static_cast<int>(i % n) + 1) *
                                    std::abs(residual.collocation[static_cast<std::size_t>(s) * per_segment + i]));
    if (start.shape.stored_nodes() > 1)
      add(defect, fmt::format("differential equations on segment {} (largest defect)", s + 1));
    for (int r = 0; r < defining.coupling_rows(s); ++r)
      add(defining.coupling_unit(s, r) * residual.coupling[coupling++], defining.coupling_name(s, r));
  }
  for (int r = 0; r < defining.integral_conditions(); ++r)
    add(residual.integral[static_cast<std::size_t>(r)], defining.integral_name(r));
  for (const HeldMonitor& held : follower.held())
    add(held.monitor->value(start, condensed.rule()) - held.value,
        fmt::format("{} minus {:.10g}, at which it is held", held.name, held.value));
  return start.shape.segments > many_segments ? largest_lines(std::move(lines)) : all_lines(lines);
}

/// The parameters that the command line gave another value, without those that Newton's method is to find.
std::vector<int> changed_parameters(const SelectedStart& selected, const DefiningSystem& system, int principal) {
  const std::vector<int>& free = system.free_parameters();
  const ParameterVector& wanted = selected.start.orbit.par;
  std::vector<int> changed;
  for (int k = 1; k < system.layout().first_duration(); ++k) {
    const bool found = k != principal && std::find(free.begin(), free.end(), k) != free.end();
    if (!found && wanted(k - 1) != selected.known_parameters(k - 1)) changed.push_back(k);
  }
  return changed;
}

/// Of the states, relative to 1 + max |u|, and of the durations, relative to the period.
double change_between(const Orbit& from, const Orbit& to) {
  const double states = (to.states - from.states).cwiseAbs().maxCoeff() / (1.0 + from.states.cwiseAbs().maxCoeff());
  double durations = 0.0;
  for (int s = 0; s < from.shape.segments; ++s)
    durations = std::max(durations, std::abs(to.duration(s) - from.duration(s)));
  return std::max(states, durations > 0.0 ? durations / std::abs(from.period()) : 0.0);
}

struct Approach {
  NewtonResult result;
  double reached = 0.0;  ///< part of the way
  bool begun = false;    ///< the orbit was found at the known values
};

/// Natural continuation along the straight line from the known parameter values to those wanted.
Approach approach(PathFollower& follower, const SelectedStart& selected, const std::vector<int>& changed,
                  PathPoint& point) {
  const ParameterVector wanted = selected.start.orbit.par;
  const ParameterVector& known = selected.known_parameters;
  Orbit orbit = selected.start.orbit;
  orbit.par = known;
  point = follower.make_point(std::move(orbit));
  Approach way;
  way.result = follower.start_at_fixed_parameter(point);
  way.begun = way.result.converged();
  PathPoint trial = point;
  for (double part = 0.25; way.begun && way.reached < 1.0 && part >= smallest_part;) {
    const double next = std::min(way.reached + part, 1.0);
    trial = point;
    for (const int k : changed)
      trial.orbit.par(k - 1) = next == 1.0 ? wanted(k - 1) : known(k - 1) + next * (wanted(k - 1) - known(k - 1));
    way.result = follower.start_at_fixed_parameter(trial);
    if (way.result.converged() && change_between(point.orbit, trial.orbit) < largest_change) {
      std::swap(point, trial);
      way.reached = next;
      part *= 1.5;
    } else {
      part *= 0.5;
    }
  }
  return way;
}

std::string values_at(const SelectedStart& selected, const HybridSystem& system, const std::vector<int>& changed,
                      double part) {
  std::string text;
  for (const int k : changed) {
    const double known = selected.known_parameters(k - 1);
    text += fmt::format("{}{} = {:.6g}", text.empty() ? "" : ", ", system.parameter_name(k),
                        known + part * (selected.start.orbit.par(k - 1) - known));
  }
  return text;
}

/// Does the start of a curve with a condition satisfy all other equations, or as well as five digits of data do?
bool solves_but_for_condition(PathFollower& follower, const DefiningSystem& system, const Orbit& start) {
  if (follower.condition() == nullptr) return false;
  const OrbitResidual residual = residual_at(follower, system, start);
  return residual.finite() && residual.largest() < level::located;
}

[[noreturn]] void refuse(PathFollower& follower, const DefiningSystem& system, const SelectedStart& selected,
                         const std::string& trouble) {
  const Orbit& start = selected.start.orbit;
  const std::string failure = evaluation_failure(system, follower.condensed().rule(), start);
  if (!failure.empty())
    throw ComputationError(fmt::format("the starting solution from {} cannot be evaluated: {}; {}", selected.source,
                                       failure, undefined_value_advice));
  const std::string advice =
      solves_but_for_condition(follower, system, start)
          ? "The start satisfies all of these: what fails is the curve's own condition. With these parameters free it "
            "may hold at every point, so that there is no curve, or nowhere near; free others (ICP)."
          : system.make_analysis(start.shape)->start_advice(start);
  throw ComputationError(fmt::format(
      "no convergence at the first point, from {}: {} Residuals of the start, condition by condition:{}\n  {}",
      selected.source, trouble, residual_report(follower, system, start), advice));
}

/// The orbit on the mesh adapted to it, or on one that is half or a quarter of the way there: on a coarse mesh the
/// whole way takes it out of reach of Newton's method. `old`: its mesh with the numbers of intervals of `shape`. False
/// when all fail.
bool adapt_mesh(PathFollower& follower, const OrbitShape& shape, const std::vector<double>& old,
                const std::vector<double>& adapted, PathPoint& point) {
  for (const double share : {1.0, 0.5, 0.25}) {
    std::vector<double> mesh = adapted;
    for (std::size_t j = 0; j < mesh.size(); ++j) mesh[j] = old[j] + share * (adapted[j] - old[j]);
    PathPoint trial = point;
    follower.change_mesh(trial, shape, mesh);
    if (!follower.start_at_fixed_parameter(trial).converged()) continue;
    std::swap(point, trial);
    return true;
  }
  return false;
}

/// On meshes adapted to the point until they settle; the last good one is kept.
void settle_mesh(PathFollower& follower, PathPoint& point) {
  const int intervals = point.orbit.shape.intervals;
  MeshEquidistribution equidistribution;
  for (int pass = 0; pass < most_meshes; ++pass) {
    const std::vector<double> mesh = equidistribution.mesh(point.orbit, follower.condensed().rule(), intervals);
    const OrbitShape shape = equidistribution.shape();
    const std::vector<double> old = resampled_mesh(point.orbit.shape, point.orbit.mesh, shape);
    double moved = 0.0;
    for (std::size_t j = 1; j + 1 < mesh.size(); ++j)  // where a segment ends and another one starts none moves
      if (mesh[j] > mesh[j - 1] && mesh[j + 1] > mesh[j])
        moved = std::max(moved, std::abs(mesh[j] - old[j]) / (mesh[j + 1] - mesh[j - 1]));
    const bool has_settled = moved < settled && shape == point.orbit.shape;
    if (has_settled || !adapt_mesh(follower, shape, old, mesh, point)) return;
  }
}

/// Has parameter k moved from the value of the start by more than data of five digits explain?
bool has_moved_far(const HybridSystem& system, int k, double asked, double value) {
  const double explained = relative_move * std::abs(asked) + absolute_move * system.parameter_size(k, 0.0);
  return std::abs(value - asked) > explained;
}

/// The free parameters beside ICP(1) that Newton's method has moved by more than data of five digits explain; "" when
/// there is none.
std::string moved_beside(const Orbit& start, const Orbit& found, const DefiningSystem& system, int principal,
                         const std::string& principal_name, const std::string& source) {
  std::string text;
  const int unfolding = system.unfolding(start) ? system.layout().unfolding(system.segments()) : 0;
  for (const int k : system.free_parameters()) {
    if (k == unfolding) continue;  // zero up to rounding, whose size is unknown
    const double asked = start.par(k - 1);
    const double value = found.par(k - 1);
    if (k == principal || !has_moved_far(system.system(), k, asked, value)) continue;
    const HybridSystem& problem = system.system();
    text += fmt::format(
        "{}the first point has {} = {:.12g}, the start from {} {:.12g}: it is free, and found with {} fixed",
        text.empty() ? "" : "; ", problem.parameter_name(k), value, source, asked, principal_name);
  }
  return text;
}

/// A start at a turning point of ICP(1), such as an impacting orbit at the grazing where it begins: with ICP(1) fixed
/// Newton's method only halves its error, and rounding decides on which side of the turning point it ends, and so where
/// the branch is followed to. By minimum norm it is the turning point itself. A monitor keeps its value to first order
/// only: with an energy as ICP(1), stationary where a family begins to impact, Newton's method goes far along the
/// family, or, as its equations are singular there, anywhere.
void settle_turning_point(PathFollower& follower, const HybridSystem& system, const Orbit& start, double asked,
                          PathPoint& point, NewtonResult& result) {
  constexpr int regular_iterations = 3;
  const Eigen::Index k = follower.principal() - 1;
  const auto move = [&](const PathPoint& to) { return std::abs(to.orbit.par(k) - asked); };
  const auto keeps_value = [&](const PathPoint& to) {
    return !has_moved_far(system, follower.principal(), asked, to.orbit.par(k));
  };
  const auto is_near = [&](const PathPoint& to) { return change_between(start, to.orbit) < largest_change; };
  const bool is_far = !keeps_value(point);
  const bool is_elsewhere = !is_near(point);
  const bool is_turning = result.iterations > regular_iterations && follower.principal_share(point) <= level::visible;
  if (!result.converged() || !(is_far || is_elsewhere || is_turning)) return;
  PathPoint at = follower.make_point(start);
  const NewtonResult there = follower.start_by_minimum_norm(at);
  const double difference = std::abs(at.orbit.par(k) - point.orbit.par(k));
  const bool is_same = difference <= level::orbit * system.parameter_size(follower.principal(), at.orbit.par(k));
  const bool is_better = is_far ? move(at) <= move(point) : is_elsewhere ? keeps_value(at) && is_near(at) : is_same;
  if (there.converged() && is_better) {
    point = std::move(at);
    result = there;
    return;
  }
  // The factors that the follower holds are to be those of the point.
  point = follower.make_point(start);
  result = follower.start_at_fixed_parameter(point);
}

}  // namespace

FirstCorrection correct_start(PathFollower& follower, const DefiningSystem& system, const SelectedStart& selected,
                              const RunSettings& settings) {
  Orbit start = selected.start.orbit;
  follower.monitors().store(start, follower.condensed().rule());
  const HybridSystem& problem = system.system();
  const int principal = follower.principal();
  const std::string name = parameter_name(problem, settings, principal);
  const double asked = start.par(principal - 1);
  PathPoint point = follower.make_point(start);
  NewtonResult result = follower.start_at_fixed_parameter(point);
  settle_turning_point(follower, problem, start, asked, point, result);
  const std::string trouble = describe(result.status);
  FirstCorrection corrected{{}, follower.newton().history(), {}, {}};

  std::string followed;
  const std::vector<int> changed = changed_parameters(selected, system, principal);
  if (!result.converged() && !changed.empty()) {
    const Approach way = approach(follower, selected, changed, point);
    result = way.result;
    if (way.reached < 1.0) result.status = NewtonStatus::too_many_iterations;
    corrected.history = follower.newton().history();
    if (way.begun && way.reached < 1.0)
      followed = fmt::format(" From {} the orbit was followed towards {} as far as {}, and no further.",
                             values_at(selected, problem, changed, 0.0), values_at(selected, problem, changed, 1.0),
                             values_at(selected, problem, changed, way.reached));
  }
  if (!result.converged() && selected.second) {
    point = follower.make_point(*selected.second);
    result = follower.start_at_fixed_parameter(point);
    corrected.history = follower.newton().history();
  }
  if (!result.converged()) {
    point = follower.make_point(start);
    result = follower.start_by_minimum_norm(point);
    corrected.history = follower.newton().history();
    if (!result.converged())
      refuse(follower, system, selected,
             fmt::format("{} with ICP(1) fixed, {} by minimum-norm steps with it free.{}", trouble,
                         describe(result.status), followed));
    const double found = point.orbit.par(principal - 1);
    const double move = std::abs(found - asked);
    if (has_moved_far(problem, principal, asked, found) && !settings.start_may_move)
      corrected.refusal = fmt::format(
          "no orbit was found at {} = {:.10g}, the value of the start from {}: {} with ICP(1) fixed; with it free "
          "there "
          "is one at {} = {:.10g}.{} The orbit asked for may not exist (beyond a fold), or the start be too far from "
          "it: "
          "begin where an orbit is known and continue to this value (UZR={{{}: {:.10g}}}), or take the one found with "
          "ICPMOVE=1",
          name, asked, selected.source, trouble, name, found, followed, name, asked);
    if (move > told_move * problem.parameter_size(principal, asked))
      corrected.note = fmt::format(
          "the first point has {} = {:.12g}, the start from {} {:.12g}: with ICP(1) fixed there was no convergence",
          name, found, selected.source, asked);
    corrected.point = std::move(point);
    return corrected;
  }
  if (!selected.from_solution && settings.adapt_mesh_every > 0 && start.shape.intervals > 1)
    settle_mesh(follower, point);
  corrected.note = moved_beside(start, point.orbit, system, principal, name, selected.source);
  corrected.point = std::move(point);
  return corrected;
}

namespace {

/// A matrix with a smaller scaled reciprocal condition leaves some direction undetermined.
constexpr double singular_condition = level::negligible;
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
  constexpr double interpolated = level::differences;
  const double residual = attempt.empty() ? follower.relative_residual(stored) : attempt.front().residual;
  return residual <= std::max(newton_settings(settings).tolerance_states, interpolated);
}

/// Newton's method may go far along the branch that crosses, whose orbits solve the equations as well.
bool has_drifted(const Orbit& stored, const Orbit& corrected) {
  constexpr double far = level::same;  // what the digits of files and the errors of a label move is much smaller
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
