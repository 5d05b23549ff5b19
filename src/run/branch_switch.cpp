#include "run/branch_switch.hpp"
#include "base/levels.hpp"
#include "run/crossing_branches.hpp"
#include "run/solver_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "base/messages.hpp"
#include "files/solution_file.hpp"
#include "orbit/curve_conditions.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

/// The orbit where the branch bifurcates, the direction of the new branch there and that of the known one.
struct Bifurcation {
  Orbit orbit;
  OrbitVector direction;
  OrbitVector known;
};

/// A first point that is nearer to the known branch than this share of its step lies on it.
constexpr double left_behind = 0.1;
/// A first point that is farther from the bifurcation than so many of its steps is not of the branch that leaves there.
constexpr double too_far = 5.0;
/// A difference of so many tolerances of Newton's method is one.
constexpr double visible = 3.0;
/// Of the step asked for: what is tried, one after the other, to leave the known branch.
constexpr double displacements[] = {1.0, 3.0, 0.3, 10.0, 0.1};

RunSettings once(RunSettings settings) {
  settings.branch_mode = periodic_orbit.branch_mode;
  return settings;
}

bool has_section(const RunSettings& settings) { return settings.segments.front().index.event != no_function; }

/// The orbit twice over: every segment again, or, without a section, one segment of twice as many intervals.
RunSettings doubled(RunSettings settings) {
  if (!has_section(settings)) {
    settings.mesh_intervals *= 2;
    return settings;
  }
  const std::size_t m = settings.segments.size();
  const std::vector<SegmentSettings> segments = settings.segments;
  settings.segments.insert(settings.segments.end(), segments.begin(), segments.end());
  renumber_monitors(settings, static_cast<int>(m));
  // The k-th monitored event of the first half is watched in the second half too.
  int monitored = 0;
  for (const SegmentSettings& segment : segments) monitored += static_cast<int>(segment.monitor.size());
  const std::vector<int> tests = settings.test_functions;
  for (const int k : tests) settings.test_functions.push_back(k + monitored);
  // A duration of the second half weighs as much as that of the first half, unless a weight of its own was given.
  const std::vector<IndexedValue> weights = settings.parameter_weights;
  for (const IndexedValue& w : weights) {
    const int repeated = w.index + static_cast<int>(m);
    const bool given =
        std::any_of(weights.begin(), weights.end(), [&](const IndexedValue& other) { return other.index == repeated; });
    if (settings.layout.is_duration(w.index, static_cast<int>(m)) && !given)
      settings.parameter_weights.push_back({repeated, w.value});
  }
  return settings;
}

/// The critical vector v, which changes sign after one period (5.21), on one segment of two periods. In the first its
/// duration changes by sigma, in the second by -sigma; at the time t of the one segment, whose duration stays, it is
/// v - sigma f t / T in the first and -v - sigma f (2 - t / T) in the second.
void double_segment(const DefiningSystem& defining, const Orbit& x, const OrbitVector& v, OrbitVector& direction) {
  const int last = x.shape.last_node(0);
  Eigen::VectorXd f(x.shape.dimension);
  for (int k = 0; k <= last; ++k) {
    defining.system().value(FunctionKind::field, defining.signature().front().field, x.node(0, k), x.par.data(),
                            f.data());
    f *= v.durations(0);
    direction.states.col(k) = v.states.col(k) - x.tau(0, k) * f;
    direction.states.col(last + k) = -v.states.col(k) - (1.0 - x.tau(0, k)) * f;
  }
}

/// `states` of one period, twice.
void repeat_segment(const Eigen::MatrixXd& states, Eigen::MatrixXd& twice) {
  const Eigen::Index last = states.cols() - 1;
  twice.leftCols(last + 1) = states;
  twice.rightCols(last + 1) = states;
}

/// An orbit without a section twice over, as one segment of two periods.
Bifurcation double_without_section(const DefiningSystem& defining, const PathPoint& point, const OrbitVector& v) {
  const Orbit& x = point.orbit;
  OrbitShape shape = x.shape.in_common();
  shape.intervals *= 2;
  if (x.shape.own) shape = shape.with_own_meshes();
  std::vector<double> mesh;
  for (const double tau : x.mesh) mesh.push_back(0.5 * tau);
  for (std::size_t j = 1; j < x.mesh.size(); ++j) mesh.push_back(0.5 + 0.5 * x.mesh[j]);
  Bifurcation result{{shape, mesh, Eigen::MatrixXd(shape.dimension, shape.columns()), x.par},
                     OrbitVector(shape, defining.free_count()),
                     OrbitVector(shape, defining.free_count())};
  repeat_segment(x.states, result.orbit.states);
  result.orbit.duration(0) = 2.0 * x.duration(0);
  double_segment(defining, x, v, result.direction);
  repeat_segment(point.tangent.states, result.known.states);
  result.known.durations = 2.0 * point.tangent.durations;
  result.known.globals = point.tangent.globals;
  return result;
}

/// The orbit twice over; the critical vector changes sign after one period (5.21).
Bifurcation double_at(PathFollower& follower, const DefiningSystem& defining, const PathPoint& point) {
  const Orbit& x = point.orbit;
  CriticalMultiplier critical(defining, x.shape, -1);
  if (!critical.evaluate(follower.condensed(), x))
    throw ComputationError("the critical vector of the period doubling was not found");
  const OrbitVector& v = critical.null_vector();
  if (!defining.has_event(0)) return double_without_section(defining, point, v);
  OrbitShape shape = x.shape.in_common();
  shape.segments *= 2;
  std::vector<double> mesh = x.mesh;
  if (x.shape.own) {
    std::vector<int> intervals;
    for (int s = 0; s < shape.segments; ++s) intervals.push_back(x.shape.intervals_of(s % x.shape.segments));
    shape.own = OwnIntervals(intervals);
    mesh.insert(mesh.end(), x.mesh.begin(), x.mesh.end());
  }
  Bifurcation result{{shape, mesh, Eigen::MatrixXd(shape.dimension, shape.columns()), x.par},
                     OrbitVector(shape, defining.free_count()),
                     OrbitVector(shape, defining.free_count())};
  const int m = x.shape.segments;
  result.orbit.par.make_room(shape.segments);
  result.orbit.states << x.states, x.states;
  result.direction.states << v.states, -v.states;
  result.direction.durations << v.durations, -v.durations;
  const OrbitVector& along = point.tangent;
  result.known.states << along.states, along.states;
  result.known.durations << along.durations, along.durations;
  result.known.globals = along.globals;
  for (int s = 0; s < m; ++s) result.orbit.duration(m + s) = x.duration(s);
  return result;
}

/// The null vector of the problem bordered by the tangent of the known branch: any right-hand side brings it out of the
/// nearly singular matrix. If that was so near to a singular one that another closing row took the place of the
/// tangent, a null vector of the problem, the solution is across that, and may be the tangent itself.
Bifurcation branch_at(PathFollower& follower, const PathPoint& point) {
  CondensedSystem& condensed = follower.condensed();
  if (auto crossing = condensed.system().crossing_directions(point.orbit, point.tangent); !crossing.empty()) {
    orient(condensed.system(), point.orbit, crossing.front());
    return {point.orbit, std::move(crossing.front()), point.tangent};
  }
  OrbitVector v = condensed.make_vector();
  const std::vector<double> border(static_cast<std::size_t>(condensed.border_rows()), 0.0);
  condensed.solve(any_right_hand_side(condensed), border, v);
  const double of_v = take_off(point, v);
  if (condensed.closing_rows_gave_way()) {
    OrbitVector null = condensed.make_vector();
    condensed.null_vector(null);
    if (take_off(point, null) > of_v) v = null;
  }
  orient(condensed.system(), point.orbit, v);
  return {point.orbit, v, point.tangent};
}

/// The largest difference of states, durations and free parameters, relative to their sizes, as Newton's tolerances
/// are.
double largest_difference(const DefiningSystem& system, const Orbit& a, const Orbit& b) {
  double largest = (a.states - b.states).cwiseAbs().maxCoeff() / (1.0 + b.states.cwiseAbs().maxCoeff());
  const double time = time_size(system, b);
  for (int s = 0; s < a.shape.segments; ++s)
    largest = std::max(largest, std::abs(a.duration(s) - b.duration(s)) / (time + std::abs(b.duration(s))));
  for (int g = 0; g < system.free_count(); ++g) {
    const int p = system.free_parameters()[static_cast<std::size_t>(g)];
    largest = std::max(largest, std::abs(a.par(p - 1) - b.par(p - 1)) / parameter_size(system, b, g));
  }
  return largest;
}

/// The point of the known branch in the plane through `reached` across the tangent there, by as many steps as it takes;
/// nothing where they do not get there.
std::optional<Orbit> beside_on_branch(PathFollower& follower, const PathPoint& start, const Orbit& reached) {
  constexpr int most_steps = 40;
  constexpr int most_halvings = 6;
  const std::vector<int>& free = follower.condensed().system().free_parameters();
  PathPoint here = start;
  PathPoint next = start;
  int halvings = 0;
  for (int k = 0; k < most_steps && halvings <= most_halvings; ++k) {
    const double rest = dot_difference(here.dual, reached, here.orbit, free);
    if (follower.step(here, std::ldexp(rest, -halvings), next).converged()) {
      if (halvings == 0) return next.orbit;
      std::swap(here, next);
      halvings = 0;
    } else {
      ++halvings;
    }
  }
  return std::nullopt;
}

/// Is `reached`, by a step of length ds from `from`, another point than the one that the known branch has as far along
/// its own tangent? Not after a step so short that Newton's tolerance for the states hides the difference.
bool has_left(PathFollower& follower, const PathPoint& from, const OrbitVector& known, double ds, const Orbit& reached,
              double tolerance) {
  const std::vector<int>& free = follower.condensed().system().free_parameters();
  Orbit displaced = from.orbit;
  advance(displaced, ds, from.tangent, free);
  const DefiningSystem& system = follower.condensed().system();
  const double displacement = largest_difference(system, displaced, from.orbit);
  if (left_behind * displacement < visible * tolerance) return false;
  PathPoint start = from;
  start.tangent = known;
  follower.renormalise(start);
  const double along = dot_difference(start.dual, reached, start.orbit, free);
  std::optional<Orbit> expected;
  const bool close = std::abs(along) < left_behind * std::abs(ds);  // to the bifurcation, where Newton goes anywhere
  if (!close) expected = beside_on_branch(follower, start, reached);
  if (!expected) {
    expected = start.orbit;
    advance(*expected, along, start.tangent, free);
  }
  return largest_difference(system, reached, *expected) > left_behind * displacement;
}

/// Did a step of length ds end near the bifurcation? From a direction that is none Newton's method finds whatever
/// solutions there are anywhere. Where the end is farther than the step is long, because the parameter changes much
/// along the branch, a shorter step ends nearer in proportion.
bool is_near(PathFollower& follower, const PathPoint& from, double ds, const Orbit& reached) {
  const std::vector<int>& free = follower.condensed().system().free_parameters();
  Orbit displaced = from.orbit;
  advance(displaced, ds, from.tangent, free);
  const DefiningSystem& system = follower.condensed().system();
  const double length = largest_difference(system, reached, from.orbit);
  if (length <= too_far * largest_difference(system, displaced, from.orbit)) return true;
  constexpr double part = 0.25;
  constexpr double least_share = 2.0 * part;
  PathPoint nearer = from;
  return follower.step(from, part * ds, nearer).converged() &&
         largest_difference(system, nearer.orbit, from.orbit) <= least_share * length;
}

/// The longest step that converges, of at most so much; nothing when none does.
std::optional<double> first_step(PathFollower& follower, const PathPoint& from, StepSettings settings, double share,
                                 PathPoint& first, NewtonResult& result) {
  settings.initial *= share;
  settings.maximum = std::max(settings.maximum, std::abs(settings.initial));
  StepSize step(settings);
  do {
    result = follower.step(from, step.value(), first);
    if (result.converged()) return step.value();
  } while (step.failed());
  return std::nullopt;
}

/// The first point of the branch that leaves along the tangent of `from`.
struct Departure {
  PathPoint first;
  std::vector<NewtonIteration> history;
  NewtonResult result;        ///< of the last step that was tried
  bool any = false;           ///< one step converged,
  bool has_departed = false;  ///< and its point is of another branch, near the bifurcation
};

Departure depart(PathFollower& follower, const PathPoint& from, const OrbitVector& known, const StepSettings& step,
                 double tolerance, std::span<const double> shares) {
  Departure result{from, {}, {}};
  for (const double share : shares) {
    const std::optional<double> ds = first_step(follower, from, step, share, result.first, result.result);
    if (!ds) continue;
    result.any = true;
    result.history = follower.newton().history();
    if (!is_near(follower, from, *ds, result.first.orbit)) continue;
    if (!has_left(follower, from, known, *ds, result.first.orbit, tolerance)) continue;
    result.has_departed = true;
    break;
  }
  return result;
}

/// The tangents of the branches that leave where several null vectors cross the known one; none where one does.
std::vector<OrbitVector> several_tangents(PathFollower& follower, const Bifurcation& at, const StepSettings& step,
                                          double tolerance) {
  PathPoint point = follower.make_point(at.orbit);
  point.tangent = at.known;
  follower.renormalise(point);
  const std::vector<PathPoint> null = null_directions(follower, point);
  if (null.size() < 2) return {};
  constexpr double shortest = 0.3;  // of the step that is asked for: far shorter ones say nothing
  return crossing_tangents(follower, null, [&](const PathPoint& direction, double length) -> std::optional<Orbit> {
    StepSettings of_length = step;
    of_length.initial = length * std::abs(step.initial);
    of_length.minimum = shortest * of_length.initial;
    Departure departure =
        depart(follower, direction, at.known, of_length, tolerance, std::span(displacements).first(1));
    if (!departure.has_departed) return std::nullopt;
    return std::move(departure.first.orbit);
  });
}

/// From a direction that is none it takes many iterations, with a matrix of their own each, to come to a branch.
RunSettings patient(RunSettings settings) {
  constexpr int iterations = 25;
  settings.max_newton = settings.full_newton = iterations;
  return settings;
}

/// "1", "1 to 3"
std::string up_to(std::size_t count) { return count == 1 ? "1" : fmt::format("1 to {}", count); }

}  // namespace

BranchSetup switch_branch(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected) {
  constexpr int period_doubling = static_cast<int>(PointType::period_doubling);
  constexpr int branch_point = static_cast<int>(PointType::branch_point);
  constexpr int equilibrium_branch_point = static_cast<int>(PointType::equilibrium_branch_point);
  const auto bifurcation_type = std::find_if(selected.types.begin(), selected.types.end(), [](int type) {
    return type == period_doubling || type == branch_point || type == equilibrium_branch_point;
  });
  const bool doubling = bifurcation_type != selected.types.end() && *bifurcation_type == period_doubling;
  if (bifurcation_type == selected.types.end())
    throw UserError(fmt::format(
        "{}: ISW = -1 switches at {}, but the run does not start from such a label; name one, for example "
        "IRS={}1",
        selected.source, problem_type(settings).facts().starts_at, problem_type(settings).facts().start_example));
  if (selected.start.orbit.shape.in_common() != family_of(settings).shape(settings).in_common())
    throw UserError(
        fmt::format("{}: label {} is an equilibrium: its branch point is left with IPS = {}, and periodic "
                    "orbits (IPS = {}) begin at a Hopf bifurcation (HB)",
                    selected.source, selected.label, equilibrium.number, periodic_orbit.number));

  if (doubling && !has_section(settings) && settings.segments.front().index.jump != no_function)
    throw UserError(fmt::format(
        "{}: an orbit without a section that ends in jump {} cannot be doubled, for the jump would stand inside of a "
        "segment; follow the whole period instead (GCGIND = [0]), or use a section (an event function)",
        selected.source, settings.segments.front().index.jump));

  const RunSettings before = once(settings);
  const BranchSetup known = problem_type(before).prepare(system, before, selected);
  const FirstPoint at = first_point(*known.follower, *known.defining, selected, before);
  known.follower->linearize_at(at.point);
  const Bifurcation bifurcation =
      doubling ? double_at(*known.follower, *known.defining, at.point) : branch_at(*known.follower, at.point);

  SelectedStart there = selected;
  there.start = {bifurcation.orbit, {}};
  const RunSettings after = doubling ? doubled(before) : before;
  const auto prepared = [&](const RunSettings& of) { return problem_type(of).prepare(system, of, there); };
  const StepSettings step = continuation_settings(settings).step;
  const double tolerance = newton_settings(settings).tolerance_states;
  const std::vector<OrbitVector> several =
      several_tangents(*prepared(patient(after)).follower, bifurcation, step, tolerance);
  BranchSetup setup = prepared(after);
  const std::size_t branches = several.size();
  const auto mode = static_cast<std::size_t>(settings.mode);
  if (branches > 0 && mode > branches)  // of a simple branch point MODE says nothing
    throw UserError(fmt::format("{}: MODE = {}, but {} found to leave label {}; allowed: {}", selected.source, mode,
                                branches == 1 ? "one branch was" : fmt::format("{} branches were", branches),
                                selected.label, up_to(branches)));
  PathPoint from = setup.follower->make_point(bifurcation.orbit);
  from.tangent = several.empty() ? bifurcation.direction : several[mode - 1];
  setup.follower->renormalise(from);
  StepSettings first = step;
  if (branches > 0) first.minimum = std::max(step.minimum, 0.1 * std::abs(step.initial));
  Departure departure = depart(*setup.follower, from, bifurcation.known, first, tolerance, displacements);
  if (departure.has_departed) {
    setup.start = {std::move(departure.first), std::move(departure.history), {}};
    if (branches > 1)
      setup.start.note = fmt::format(
          "{} branches were found to leave label {}, where several multipliers or eigenvalues come to one value (there "
          "may be more); this is number {} (MODE = {})",
          branches, selected.label, mode, up_to(branches));
    return setup;
  }
  if (!departure.any)
    throw ComputationError(fmt::format("no step onto the branch that bifurcates at label {} of {}: {}; try another DS",
                                       selected.label, selected.source, describe(departure.result.status)));
  throw ComputationError(fmt::format(
      "no step from label {} of {} leads away from the branch that the label lies on and to another one near it, for "
      "DS between {:.3g} and {:.3g}; compute that branch and its label again with a larger NTST or a smaller EPSS, "
      "or try another DS",
      selected.label, selected.source, 0.1 * step.initial, 10.0 * step.initial));
}

}  // namespace tchat
