#include "continuation/branch_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/levels.hpp"
#include "continuation/newton_chord.hpp"
#include "continuation/orbit_trend.hpp"
#include "continuation/solution_measure.hpp"
#include "linear/dense_matrix.hpp"
#include "linear/memory.hpp"
#include "orbit/condensed_system.hpp"

namespace tchat {

namespace {

/// The largest z whose growth exp(z) an interval of `collocation` Gauss points has with a relative error below 1.
double resolved_growth(int collocation) {
  double constant = 1.0;  // (c!)^2 / ((2c)! (2c+1)!)
  for (int k = 1; k <= collocation; ++k) constant *= static_cast<double>(k) * k;
  for (int k = 1; k <= 2 * collocation + 1; ++k) constant /= k;
  for (int k = 1; k <= 2 * collocation; ++k) constant /= k;
  return std::pow(constant, -1.0 / (2 * collocation + 1));
}

/// What changes by a factor of exp(z) on a mesh interval.
enum class Rate {
  of_perturbations_and_flow,
  of_decaying_flow  ///< |f| before an event, whose time has the relative error of f
};

/// Per unit time at one state.
double rate_at(const Eigen::VectorXd& f, const Eigen::MatrixXd& fx, double time, Rate rate) {
  const double flow = f.dot(fx * f) / f.squaredNorm();  // d ln |f| / dt
  const double of_flow = std::isfinite(flow) ? flow : 0.0;
  if (rate == Rate::of_decaying_flow) return std::max(-of_flow, 0.0);
  const Eigen::VectorXd rates = eigenvalues(fx).real();
  // What decays beside what grows has its share in the multipliers, what decays alone has none.
  const double perturbations = rates.maxCoeff() * time > 1.0 ? rates.cwiseAbs().maxCoeff() : 0.0;
  return std::max(perturbations, std::abs(of_flow));
}

/// Of which intervals of a segment: `moving` are all but those on which the orbit rests at an equilibrium.
enum class Which { all, moving, last };

/// Does any state move by a visible share of its range on interval j of segment s?
bool moves(const Orbit& x, int s, int j, const Eigen::VectorXd& ranges) {
  constexpr double visible = 1e-3;
  const double* from = x.node(s, j * x.shape.collocation);
  const double* to = x.node(s, (j + 1) * x.shape.collocation);
  for (Eigen::Index k = 0; k < ranges.size(); ++k)
    if (std::abs(to[k] - from[k]) > visible * ranges(k)) return true;
  return false;
}

/// The largest z of the orbit's mesh intervals, 0 where none exceeds `least`, which is cheap to see.
double largest_growth(const DefiningSystem& system, const Orbit& x, Which which, Rate rate, double least) {
  const int n = x.shape.dimension;
  const int c = x.shape.collocation;
  StackVector f(n);
  StackMatrix fx(n, n);
  double largest = 0.0;
  const Eigen::VectorXd ranges = which == Which::moving ? state_ranges(x) : Eigen::VectorXd();
  for (int s = 0; s < x.shape.segments; ++s) {
    const int field = system.signature()[static_cast<std::size_t>(s)].field;
    const auto growth_at = [&](int mesh_point, double time) {
      system.system().first(FunctionKind::field, field, x.node(s, mesh_point * c), x.par.data(), {}, f.data(),
                            fx.data(), nullptr);
      return fx.allFinite() && fx.norm() * time > least ? rate_at(f, fx, time, rate) * time : 0.0;
    };
    const int intervals = x.shape.intervals_of(s);
    for (int j = which == Which::last ? intervals - 1 : 0; j < intervals; ++j) {
      if (which == Which::moving && !moves(x, s, j, ranges)) continue;
      const double time = (x.mesh_of(s)[j + 1] - x.mesh_of(s)[j]) * x.duration(s);
      const double left = growth_at(j, time);
      if (left > std::max(largest, least)) largest = std::max(largest, std::min(left, growth_at(j + 1, time)));
    }
  }
  return largest > least ? largest : 0.0;
}

}  // namespace

std::string unresolved_by_mesh(const DefiningSystem& system, const Orbit& x, const PointData& data, double bound) {
  if (!(bound > 0.0)) return "";
  const auto text = [&](const char* figure, double value) {
    return fmt::format("NTST = {} does not resolve the next orbit: {} {:.1e} exceeds ERRMAX = {:.3g}",
                       x.shape.intervals, figure, value, bound);
  };
  if (!(data.estimated_error <= bound)) return text("the estimated relative error", data.estimated_error);
  const FloquetMultipliers& multipliers = data.multipliers;
  if (!multipliers.is_flow_lost && !(multipliers.structural <= bound))
    return text(multipliers.has_trivial ? "the trivial multiplier's distance from 1" : "the structural multiplier",
                multipliers.structural);
  if (!multipliers.valid) return "";
  const double limit = resolved_growth(x.shape.collocation);
  const bool is_unstable = count_unstable(multipliers).outside > 0;
  const bool counts_all = is_unstable || multipliers.is_flow_lost;
  const Which which = is_unstable ? Which::all : counts_all ? Which::moving : Which::last;
  const Rate rate = counts_all ? Rate::of_perturbations_and_flow : Rate::of_decaying_flow;
  const double growth = largest_growth(system, x, which, rate, limit);
  if (growth == 0.0) return "";
  return fmt::format(
      "NTST = {} does not resolve the next orbit: perturbations or the flow change by a factor of exp({:.3g}) "
      "on one mesh interval, where NCOL = {} resolves exp({:.2g})",
      x.shape.intervals, growth, x.shape.collocation, limit);
}

std::string lost_multiplier(const OrbitCondition* condition, const PointData& data) {
  const std::optional<int> kept = condition != nullptr ? condition->kept_multiplier() : std::nullopt;
  const FloquetMultipliers& multipliers = data.multipliers;
  if (!kept || !multipliers.determined() || multiplier_accuracy(multipliers) > structural_bound) return "";
  if (touching_segment(data.transversalities) >= 0) return "";
  const double distance = multiplier_distance(multipliers, *kept);
  if (distance <= agreeing_multiplier) return "";
  return fmt::format("no multiplier is {:+d} any more (the nearest is {:.3g} away from it)", *kept, distance);
}

std::string undetermined_duration(const DefiningSystem& system, const Orbit& x) {
  StackVector f(x.shape.dimension), sizes(x.shape.dimension);
  sizes = x.states.cwiseAbs().rowwise().maxCoeff();
  sizes = sizes.cwiseMax(level::same * sizes.maxCoeff());
  const double period = x.period();
  for (int s = 0; s < x.shape.segments; ++s) {
    if (lasts_no_time(x, s, period)) continue;
    system.system().value(FunctionKind::field, system.signature()[static_cast<std::size_t>(s)].field, x.end(s),
                          x.par.data(), f.data());
    const double moved = f.cwiseQuotient(sizes).cwiseAbs().maxCoeff() * std::abs(x.duration(s));
    if (moved < level::negligible)
      return fmt::format(
          "segment {} ends at rest to within rounding (|f| T is {:.1e} of the states), so that its duration {:.6g} is "
          "not determined",
          s + 1, moved, x.duration(s));
  }
  return "";
}

std::string passed_infinity(const PathPoint& from, const PathPoint& to, double ds) {
  const Orbit& x = from.orbit;
  const Orbit& y = to.orbit;
  const auto passes = [ds](double before, double rate, double after) {
    return before * after < 0.0 && before * rate * ds > 0.0;
  };
  const auto text = [](const std::string& what, double before, double after) {
    return fmt::format("{} passes infinity (from {:.6g} to {:.6g})", what, before, after);
  };
  if (passes(x.period(), from.tangent.durations.sum(), y.period())) return text("the period", x.period(), y.period());
  const double period = x.period();
  for (int s = 0; s < x.shape.segments; ++s)
    if (!lasts_no_time(x, s, period) && passes(x.duration(s), from.tangent.durations(s), y.duration(s)))
      return text(fmt::format("the duration of segment {}", s + 1), x.duration(s), y.duration(s));
  return "";
}

std::string passed_zero(const Orbit& from, const Orbit& to) {
  const double before = from.period();
  const double after = to.period();
  const bool is_negative = after < -no_duration * std::abs(before) && before > -no_duration * std::abs(after);
  return is_negative ? fmt::format("the period passes zero (from {:.6g} to {:.6g})", before, after) : "";
}

std::string passed_zero_segment(const Orbit& from, const Orbit& to) {
  const double before = -no_contact * from.period(), after = -no_contact * to.period();
  for (int s = 0; s < from.shape.segments; ++s)
    if (from.duration(s) >= before && to.duration(s) < after)
      return fmt::format("the duration of segment {} passes zero (from {:.6g} to {:.6g})", s + 1,
                         contact_lasts_no_time(from, s) ? 0.0 : from.duration(s), to.duration(s));
  return "";
}

namespace {

/// A bound as far away is none.
constexpr double no_bound = 1e300;

class BoundTest final : public TestFunction {
 public:
  BoundTest(BranchBounds bounds, std::string keyword, double bound)
      : bounds_(std::move(bounds)), keyword_(std::move(keyword)), bound_(bound) {}

  /// Both bounds of a quantity have the keyword BOUNDS, so the value distinguishes them.
  std::string name() const override {
    return bounds_.least_keyword == bounds_.most_keyword ? fmt::format("{} - {:g}", bounds_.quantity, bound_)
                                                         : fmt::format("{} - {}", bounds_.quantity, keyword_);
  }
  TestValue evaluate(const TestedPoint& point) const override {
    const double here = bounds_.value(point.orbit, point.condensed.rule());
    return TestValue::of(here - bound_, orbit_accuracy * std::max(std::abs(bound_), std::abs(here)));
  }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::end, {}, true, fmt::format("{} = {:.10g}, the bound {}", bounds_.quantity, bound_, keyword_)};
  }

 private:
  BranchBounds bounds_;
  std::string keyword_;
  double bound_;
};

}  // namespace

double BranchBounds::value(const Orbit& orbit, const CollocationRule& rule) const {
  if (parameter != solution_measure) return orbit.par(parameter - 1);
  if (units.size() == 0) return tchat::solution_measure(orbit, rule, weights, measure);
  Orbit shown = orbit;
  shown.states = units.asDiagonal() * orbit.states;
  return tchat::solution_measure(shown, rule, weights, measure);
}

bool BranchBounds::is_finite() const { return least > -no_bound || most < no_bound; }

std::string BranchBounds::keywords() const {
  return least_keyword == most_keyword ? least_keyword : least_keyword + ", " + most_keyword;
}

std::vector<std::unique_ptr<TestFunction>> bound_tests(const std::vector<BranchBounds>& bounds) {
  std::vector<std::unique_ptr<TestFunction>> tests;
  const auto add = [&](const BranchBounds& range, const std::string& keyword, double bound) {
    if (std::abs(bound) < no_bound) tests.push_back(std::make_unique<BoundTest>(range, keyword, bound));
  };
  for (const BranchBounds& range : bounds) {
    add(range, range.least_keyword, range.least);
    add(range, range.most_keyword, range.most);
  }
  return tests;
}

namespace {

/// A branch has left its first point when it has gone so many times its distance from it.
constexpr double left_behind = 2.0;
/// Shares of the step by which the first point may lie outside of it: interpolation between meshes moves it that much.
constexpr double margin = 1e-3;
/// How far beside the step the first point may lie, as a share of the step, for a trial to be worth while.
constexpr double beside = 2.0;
/// Cosine of the angle between the branch's two directions at its first point: the same but for what bends between
/// points that differ by Newton's tolerance.
constexpr double one_direction = 0.99;
/// So many of Newton's tolerances are no difference.
constexpr double same = 10.0;
/// Measures of one orbit with different phases differ by the error of their quadrature.
constexpr double same_measures = level::located;
/// A step along the tangent, to see how measures change.
constexpr double probe = level::visible;

/// Is `ratio` on [0, 1] but for the margin?
bool is_on_step(double ratio) { return ratio >= -margin && ratio <= 1.0 + margin; }

}  // namespace

void ClosedBranch::begin(const PathPoint& first, double direction) {
  first_ = first;
  moved_ = first.orbit;
  travelled_ = 0.0;
  if (phase_is_fixed_) return;
  measure_sizes_ = Eigen::VectorXd();
  measure_sizes_ = sizes_of_measures(first.orbit, measures(first.orbit));
  first_measures_ = measures(first.orbit);
  Orbit beyond = first.orbit;
  advance(beyond, std::copysign(probe, direction), first.tangent, system_.free_parameters());
  first_direction_ = measures(beyond) - first_measures_;
}

std::optional<ClosedBranch::Return> ClosedBranch::on_step(const PathPoint& here, const PathPoint& next, double ds) {
  const std::optional<double> length = phase_is_fixed_ ? place(here, ds) : place_of_measures(here, next, ds);
  if (!length) return std::nullopt;
  Return way{here, *length};
  follower_.change_mesh(way.from, first_.orbit.shape, first_.orbit.mesh);
  if (reach(way, next, ds)) return way;
  follower_.linearize_at(next);
  return std::nullopt;
}

/// Where the plane across the tangent through the first point cuts a step; nothing where it does not, or far away.
std::optional<double> ClosedBranch::place(const PathPoint& here, double ds) {
  if (here.orbit.mesh != moved_.mesh) {
    const Orbit& first = first_.orbit;
    const CollocationRule& rule = follower_.condensed().rule();
    transfer_.set(first.shape, first.mesh, here.orbit.shape, here.orbit.mesh, rule);
    transfer_(first.states, moved_.states);
    moved_.shape = here.orbit.shape;
    moved_.mesh = here.orbit.mesh;
  }
  const double length = dot_difference(here.dual, moved_, here.orbit, system_.free_parameters());
  if (!is_on_step(length / ds)) return std::nullopt;
  const double distance = follower_.distance(here.orbit, moved_);
  if (!(travelled_ > left_behind * distance) || distance > beside * std::abs(ds)) return std::nullopt;
  return length;
}

/// The same by the measures, on the line from those at the start of the step to those at its end.
std::optional<double> ClosedBranch::place_of_measures(const PathPoint& here, const PathPoint& next, double ds) const {
  const Eigen::VectorXd start = measures(here.orbit);
  const Eigen::VectorXd across = measures(next.orbit) - start;
  const Eigen::VectorXd to_first = first_measures_ - start;
  const double share = to_first.dot(across) / across.squaredNorm();
  const bool ahead = to_first.dot(first_direction_) > same_measures * first_direction_.norm();
  if (!ahead || !is_on_step(share) || across.dot(first_direction_) <= 0.0 || to_first.norm() > beside * across.norm())
    return std::nullopt;
  return share * ds;
}

/// Steps from `way.from` to the first point: true, and the length of the step, when that is where it leads.
bool ClosedBranch::reach(Return& way, const PathPoint& next, double ds) {
  constexpr int most_trials = 8;
  constexpr double settled = level::converged;  // share of the step
  PathPoint trial = way.from;
  if (phase_is_fixed_) {
    way.length = dot_difference(way.from.dual, first_.orbit, way.from.orbit, system_.free_parameters());
    return follower_.step(way.from, way.length, trial).converged() && is_first(trial);
  }
  const Eigen::VectorXd across = measures(next.orbit) - measures(way.from.orbit);
  for (int k = 0; k < most_trials; ++k) {
    if (!follower_.step(way.from, way.length, trial).converged()) return false;
    const double rest = (first_measures_ - measures(trial.orbit)).dot(across) / across.squaredNorm();
    if (std::abs(rest) <= settled) break;
    way.length += rest * ds;
  }
  return is_first(trial);
}

/// On the mesh of the first point.
bool ClosedBranch::is_first(const PathPoint& point) const {
  const NewtonSettings& newton = follower_.newton_settings();
  const Orbit& a = first_.orbit;
  const Orbit& b = point.orbit;
  const auto equal = [&](double one, double other, double size) {
    return std::abs(one - other) <= same * newton.tolerance_parameters * size;
  };
  for (const int k : system_.free_parameters())
    if (!equal(a.par(k - 1), b.par(k - 1), system_.system().parameter_size(k, a.par(k - 1)))) return false;
  const double time = time_size(system_, a);
  for (int s = 0; s < a.shape.segments; ++s)
    if (!equal(a.duration(s), b.duration(s), time + std::abs(a.duration(s)))) return false;
  if (!phase_is_fixed_) return (measures(b) - first_measures_).cwiseAbs().maxCoeff() <= same_measures;
  const double size = 1.0 + a.states.cwiseAbs().maxCoeff();
  return (a.states - b.states).cwiseAbs().maxCoeff() <= same * newton.tolerance_states * size &&
         dot(first_.dual, point.tangent) > one_direction;
}

/// Of states, in units of their sizes, 1 and more.
Eigen::VectorXd ClosedBranch::sizes_of_measures(const Orbit& x, const Eigen::VectorXd& measured) const {
  Eigen::VectorXd sizes = 1.0 + measured.array().abs();
  const Eigen::Index free = system_.free_count(), segments = x.shape.segments;
  for (Eigen::Index g = 0; g < free; ++g) sizes(g) = parameter_size(system_, x, static_cast<int>(g));
  sizes.segment(free, segments) = measured.segment(free, segments).array().abs() + time_size(system_, x);
  return sizes;
}

/// Free parameters, durations, means and root mean squares of the states, each relative to its size at the first point.
Eigen::VectorXd ClosedBranch::measures(const Orbit& x) const {
  const int n = x.shape.dimension;
  const Eigen::VectorXd weights = Eigen::VectorXd::Ones(n);
  std::vector<double> list;
  for (const int k : system_.free_parameters()) list.push_back(x.par(k - 1));
  for (int s = 0; s < x.shape.segments; ++s) list.push_back(x.duration(s));
  for (int k = n + 1; k <= 3 * n; ++k) list.push_back(solution_measure(x, follower_.condensed().rule(), weights, k));
  Eigen::VectorXd result = Eigen::VectorXd::Map(list.data(), static_cast<Eigen::Index>(list.size()));
  if (measure_sizes_.size() > 0) result = result.cwiseQuotient(measure_sizes_);
  return result;
}

}  // namespace tchat
