#include "run/torus_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "linear/dense_matrix.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"
#include "orbit/torus_system.hpp"
#include "plugin/problem_setup.hpp"
#include "run/solver_settings.hpp"
#include "settings/point_type.hpp"
#include "settings/settings_type.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/floquet_multipliers.hpp"
#include "stability/torus_contact.hpp"

namespace tchat {

namespace {

using Complex = std::complex<double>;

/// Of a torus that is born, unless NHARM says otherwise.
constexpr int first_harmonics = 7;
constexpr int fewest_harmonics = 3;
/// A multiplier farther from the unit circle is none of a torus bifurcation by the accuracy of a label.
constexpr double on_unit_circle = 1e-3;

int most_harmonics(const RunSettings& one_return) {
  return (max_torus_segments / std::max(segment_count(one_return), 1) - 1) / 2;
}

void check_signature(const RunSettings& settings, const std::string& source) {
  for (std::size_t s = 0; s < settings.segments.size(); ++s)
    if (settings.segments[s].index.event == no_function)
      throw UserError(
          fmt::format("{}: segment {} has no event (GCHIND = 0); a torus is computed as a closed curve on a "
                      "section, so give the signature of one return to a section",
                      source, s + 1));
  if (most_harmonics(settings) < fewest_harmonics)
    throw UserError(
        fmt::format("{}: a return of {} segments leaves no room for {} orbits of it: at most {} segments in "
                    "all; take a shorter return",
                    source, segment_count(settings), 2 * fewest_harmonics + 1, max_torus_segments));
}

/// The nearest fraction of small numbers, in words; "" where rho is near none.
std::string near_fraction(double rho) {
  constexpr int largest = 12;
  constexpr double nearness = 0.02;  // of 1 / q
  for (int q = 1; q <= largest; ++q) {
    const auto p = static_cast<int>(std::lround(rho * q));
    if (std::abs(rho * q - p) < nearness) return fmt::format("{}/{}", p, q);
  }
  return "";
}

/// A label of another signature: no stored orbit ends on the event that this one names.
void check_events(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected) {
  constexpr double far_off = 1e-3;
  const Orbit& x = selected.start.orbit;
  if (selected.parameters_changed) return;
  const int m = segment_count(settings);
  for (int s = 0; s < m; ++s) {
    const int event = settings.segments[static_cast<std::size_t>(s)].index.event;
    double nearest = std::numeric_limits<double>::infinity(), h = 0.0;
    for (int i = s; i < x.shape.segments; i += m) {
      const EventAt at = event_at(system, event, x.end(i), x.par.data());
      const double distance = std::abs(at.h) / std::max(at.scale(x.end(i)), std::numeric_limits<double>::min());
      if (!(distance < nearest)) continue;
      nearest = distance;
      h = at.h;
    }
    if (nearest > far_off && std::isfinite(nearest))
      throw UserError(
          fmt::format("{}: the signature is another one than that of label {}: segment {} is to end in event {} ({}), "
                      "and none of the label's does, h = {:.3g} at least; give the signature of its run (-c r.NAME)",
                      selected.source, selected.label, s + 1, event, system.function_name(FunctionKind::event, event),
                      std::abs(h)));
  }
}

int harmonics_wanted(const RunSettings& settings, int otherwise) {
  const int wanted = settings.harmonics > 0 ? settings.harmonics : otherwise;
  return std::clamp(wanted, fewest_harmonics, most_harmonics(settings));
}

RunSettings on_periodic_orbit(RunSettings settings) {
  settings.problem_type = periodic_orbit.number;
  settings.branch_mode = periodic_orbit.branch_mode;
  std::erase_if(settings.free_parameters, [&](int k) { return k == settings.layout.rotation(); });
  return settings;
}

RunSettings on_torus(RunSettings settings) {
  settings.branch_mode = invariant_torus.branch_mode;
  settings.step = std::abs(settings.step);
  return settings;
}

/// The multiplier e^(i theta), 0 < theta < pi, at the label.
Complex critical_multiplier(const Eigen::MatrixXd& map, const SelectedStart& selected) {
  Complex nearest = 0.0;
  std::string list;
  for (const Complex& mu : eigenvalues(map)) {
    list += fmt::format(
        "{}{:.5g}{}", list.empty() ? "" : ", ", mu.real(),
        mu.imag() == 0.0 ? "" : fmt::format(" {} {:.5g} i", mu.imag() < 0.0 ? "-" : "+", std::abs(mu.imag())));
    if (mu.imag() > 0.0 && std::abs(std::abs(mu) - 1.0) < std::abs(std::abs(nearest) - 1.0)) nearest = mu;
  }
  if (nearest.imag() > 0.0 && std::abs(std::abs(nearest) - 1.0) < on_unit_circle) return nearest;
  throw UserError(
      fmt::format("{}: label {} is a torus bifurcation that is none: no complex pair of multipliers is on the "
                  "unit circle there ({}); a parameter or the problem is another one than that of the label",
                  selected.source, selected.label, list));
}

/// The perturbation of the orbit that begins as v, carried to its ends and inside.
OrbitVector carried(CondensedSystem& condensed, const Orbit& x, Eigen::VectorXd v) {
  const int n = x.shape.dimension;
  std::vector<double> ends;
  OrbitVector result = condensed.make_vector();
  result.set_zero();
  for (int s = 0; s < x.shape.segments; ++s) {
    const SegmentMap map = segment_map(condensed, x, s);
    const Eigen::VectorXd w = map.to_end * v;
    ends.insert(ends.end(), v.data(), v.data() + n);
    ends.insert(ends.end(), w.data(), w.data() + n);
    ends.push_back(map.to_duration.dot(v));
    v = map.to_next * v;
  }
  condensed.extend(ends.data(), result);
  return result;
}

/// The orbit N times over, and the direction of the torus.
struct Birth {
  Orbit still;
  OrbitVector direction;
};

Birth birth_at(PathFollower& along, const Orbit& x, int orbits, int globals, const SelectedStart& selected) {
  CondensedSystem& condensed = along.condensed();
  const Eigen::MatrixXd map = return_matrix(condensed, x, 0, x.shape.segments);
  const Complex mu = critical_multiplier(map, selected);
  const Eigen::VectorXcd v = eigenvector(map, mu);
  const OrbitVector real = carried(condensed, x, v.real());
  const OrbitVector imaginary = carried(condensed, x, v.imag());

  const int m = x.shape.segments;
  OrbitShape shape = x.shape;
  shape.segments = orbits * m;
  Birth birth{{shape, x.mesh, x.states.replicate(1, orbits), x.par}, OrbitVector(shape, globals)};
  birth.still.par.rotation() = std::arg(mu) / (2.0 * std::numbers::pi);
  for (int i = 0; i < orbits; ++i) {
    const Complex turned = std::polar(1.0, 2.0 * std::numbers::pi * i / orbits);
    birth.still.par.durations(m, i * m) = x.par.durations(m);
    birth.direction.states.middleCols(i * x.shape.columns(), x.shape.columns()) =
        turned.real() * real.states - turned.imag() * imaginary.states;
    birth.direction.durations.segment(i * m, m) = turned.real() * real.durations - turned.imag() * imaginary.durations;
  }
  return birth;
}

/// The torus of the largest amplitude, up to |DS|, that converges.
std::optional<FirstPoint> first_torus(PathFollower& follower, const Birth& birth, const OrbitVector& direction,
                                      const StepSettings& steps, NewtonStatus& trouble) {
  StepSize step(steps);
  do {
    Orbit orbit = birth.still;
    orbit.states += step.value() * direction.states;
    for (int s = 0; s < orbit.shape.segments; ++s) orbit.duration(s) += step.value() * direction.durations(s);
    PathPoint point = follower.make_point(std::move(orbit));
    const NewtonResult result = follower.start_along(point, direction);
    trouble = result.status;
    if (result.converged()) return FirstPoint{std::move(point), follower.newton().history(), {}, false};
  } while (step.failed());
  return std::nullopt;
}

}  // namespace

RunSettings settings_of_orbits(const RunSettings& one_return, int orbits) {
  RunSettings settings = one_return;
  const int m = segment_count(one_return);
  settings.segments.clear();
  settings.parameter_weights.clear();
  for (int i = 0; i < orbits; ++i)
    settings.segments.insert(settings.segments.end(), one_return.segments.begin(), one_return.segments.end());
  for (const IndexedValue& w : one_return.parameter_weights)
    for (int i = 0; i < (one_return.layout.is_duration(w.index, m) ? orbits : 1); ++i)
      settings.parameter_weights.push_back({w.index + i * m, w.value});
  return settings;
}

BranchSetup continue_torus(const ProblemType& type, const HybridSystem& system, const RunSettings& settings,
                           const SelectedStart& selected) {
  check_signature(settings, selected.source);
  check_events(system, settings, selected);
  const int stored = selected.start.orbit.shape.segments / segment_count(settings);
  const int orbits = 2 * harmonics_wanted(settings, (stored - 1) / 2) + 1;
  SelectedStart start = selected;
  if (orbits != stored) {
    const OrbitShape shape = selected.start.orbit.shape;
    start.start.orbit = resampled_torus(selected.start.orbit, stored, orbits,
                                        torus_winding(system, settings.signature(), selected.start.orbit).curve);
    if (selected.start.direction)
      start.start.direction = resampled_torus(*selected.start.direction, shape, stored, orbits);
    // Durations are found anew.
    start.known_parameters.durations(max_torus_segments) = start.start.orbit.par.durations(max_torus_segments);
  }
  BranchSetup setup = type.prepare(system, settings, start);
  setup.start = first_point(*setup.follower, *setup.defining, start, setup.settings);
  return setup;
}

BranchSetup begin_torus(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected) {
  check_signature(settings, selected.source);
  constexpr int torus = static_cast<int>(PointType::torus);
  if (std::find(selected.types.begin(), selected.types.end(), torus) == selected.types.end())
    throw UserError(fmt::format(
        "{}: ISW = -1 with IPS = {} begins the torus that is born at a torus bifurcation (TR) of a run with "
        "IPS = {}, but the run does not start from such a label; name one, for example IRS=TR1",
        selected.source, settings.problem_type, periodic_orbit.number));
  const RunSettings before = on_periodic_orbit(settings);
  const int principal = free_problem_parameters(before).front();
  const PeriodicOrbitSystem known(system, before.signature(), {principal});
  PathFollower along(known, selected.start.orbit.shape, weighted_norm(before, selected.start.orbit),
                     newton_settings(before), principal);
  const PathPoint at = first_point(along, known, selected, before).point;
  along.linearize_at(at);

  const RunSettings of_run = on_torus(settings);
  const int orbits = 2 * harmonics_wanted(settings, first_harmonics) + 1;
  const auto globals = static_cast<int>(free_problem_parameters(of_run).size());
  const Birth birth = birth_at(along, at.orbit, orbits, globals, selected);
  SelectedStart start = selected;
  start.start.orbit = birth.still;
  BranchSetup setup = problem_type(of_run).prepare(system, of_run, start);
  PathPoint from = setup.follower->make_point(birth.still);
  from.tangent = birth.direction;
  setup.follower->renormalise(from);
  NewtonStatus trouble = NewtonStatus::converged;
  std::optional<FirstPoint> first =
      first_torus(*setup.follower, birth, from.tangent, continuation_settings(of_run).step, trouble);
  if (!first)
    throw ComputationError(fmt::format(
        "no torus beside the torus bifurcation of label {} of {} (rho = {:.6g}) for an amplitude of {:.3g} "
        "or less: {}; "
        "try another DS, compute the label with a smaller EPSS, or keep rho and free a second parameter",
        selected.label, selected.source, birth.still.par.rotation(), std::abs(settings.step), describe(trouble)));
  setup.start = std::move(*first);
  return setup;
}

std::optional<int> fitting_harmonics(const RunSettings& one_return, const TorusSystem& system, const Orbit& x) {
  constexpr double too_many = 1e-3;  // of HARMTOL
  constexpr double fewer = 0.6;
  const double tolerance = one_return.harmonic_tolerance;
  if (!(tolerance > 0.0)) return std::nullopt;
  const int harmonics = (system.orbits() - 1) / 2;
  const int most = most_harmonics(one_return);
  if (last_harmonics(system, x) > tolerance) {
    const int next = std::min(harmonics + harmonics / 3 + 1, most);
    return next > harmonics ? std::optional(next) : std::nullopt;
  }
  const int next = std::max(static_cast<int>(fewer * harmonics), first_harmonics);
  if (next >= harmonics) return std::nullopt;
  const Eigen::VectorXd sizes = torus_harmonics(system, x);
  return sizes.tail(harmonics - next + 2).maxCoeff() < too_many * tolerance ? std::optional(next) : std::nullopt;
}

std::string rough_torus(const RunSettings& one_return, const TorusSystem& system, const Orbit& x) {
  const int harmonics = (system.orbits() - 1) / 2;
  const bool may_grow = one_return.harmonic_tolerance > 0.0 && harmonics < most_harmonics(one_return);
  const double last = last_harmonics(system, x);
  if (may_grow || last < level::visible) return "";
  const std::string fraction = near_fraction(TorusSystem::rotation(x));
  return fmt::format(
      "the last of {} harmonics are {:.1e} of the torus: it is about to lose its smoothness, or locks to a periodic "
      "orbit (rho = {:.8g}{}); {}look at the harmonics in the d-file, follow it with rho fixed at an irrational value "
      "and a "
      "second "
      "parameter free, or look for the periodic orbit by simulation",
      harmonics, last, TorusSystem::rotation(x), fraction.empty() ? "" : fmt::format(", near {}", fraction),
      harmonics < most_harmonics(one_return) ? "their number is fixed (HARMTOL = 0): give NHARM more; " : "");
}

BranchSetup with_harmonics(const BranchSetup& setup, const TorusSystem& system, const PathPoint& last, int harmonics) {
  const RunSettings& one_return = *setup.constants;
  const int orbits = 2 * harmonics + 1;
  SelectedStart start;
  start.start.orbit = resampled_torus(last.orbit, system.orbits(), orbits, system.winding().curve);
  start.problem_type = one_return.problem_type;
  BranchSetup next = setup.type->prepare(system.system(), one_return, start);
  PathPoint point = next.follower->make_point(start.start.orbit);
  const OrbitVector direction = resampled_torus(last.tangent, last.orbit.shape, system.orbits(), orbits);
  const NewtonResult result = next.follower->start_along(point, direction);
  if (!result.converged()) {
    next.follower.reset();
    next.start.note = fmt::format("no convergence of the torus on {} orbits instead of {} ({}): it goes on with these",
                                  orbits, system.orbits(), describe(result.status));
    return next;
  }
  if (next.follower->alignment(point, direction) < 0.0) next.follower->reverse(point);
  next.start = {std::move(point), next.follower->newton().history(),
                fmt::format("{} harmonics from here on", harmonics), setup.start.stored_direction};
  return next;
}

namespace {

/// Least values of the events, strong resonances where rho is free, the fold, user values.
TestList torus_tests(const TorusSystem& system, const RunSettings& settings,
                     const std::vector<MonitoredEvent>& events) {
  TestList tests;
  for (const MonitoredEvent& at : events)
    tests.push_back(std::make_unique<TorusContactTest>(system, at.segment, at.event, settings.stop_at_grazing));
  const std::vector<int>& free = system.free_parameters();
  if (std::find(free.begin(), free.end(), system.layout().rotation()) != free.end())
    for (const auto& [p, q] : {std::pair{0, 1}, {1, 1}, {1, 2}, {1, 3}, {2, 3}, {1, 4}, {3, 4}})
      tests.push_back(std::make_unique<StrongResonanceTest>(p, q));
  if (settings.detect_folds != 0)
    tests.push_back(std::make_unique<FoldTest>(settings.free_parameters.front(), free, system.layout(),
                                               system.segments(), settings.detect_folds < 0, PointType::fold,
                                               held_text(system.system(), settings)));
  add_user_values(tests, system.system(), settings);
  return tests;
}

/// A torus as its trigonometric polynomials: their number follows the last harmonics.
class TorusDiscretisation final : public Discretisation {
 public:
  TorusDiscretisation(const TorusSystem& system, RunSettings one_return)
      : system_(system), one_return_(std::move(one_return)) {}

  /// Rotation number, frequencies, harmonics.
  std::string remark(const Orbit& x) const override {
    const double frequency = 2.0 * std::numbers::pi / mean_return_time(system_, x);
    const double rho = TorusSystem::rotation(x);
    return fmt::format("torus: rho = {:.10g}, frequencies {:.10g} and {:.10g}, {} harmonics, the last {:.1e}", rho,
                       frequency, rho * frequency, (system_.orbits() - 1) / 2, last_harmonics(system_, x));
  }
  bool is_outgrown(const Orbit& x) const override { return fitting_harmonics(one_return_, system_, x).has_value(); }
  BranchSetup refined(const BranchSetup& setup, const PathPoint& last) const override {
    return with_harmonics(setup, system_, last, *fitting_harmonics(one_return_, system_, last.orbit));
  }
  std::string why_unresolved(const Orbit& x) const override { return rough_torus(one_return_, system_, x); }

 private:
  const TorusSystem& system_;
  RunSettings one_return_;
};

/// The inner product of pseudo-arclength, a mean over the orbits: steps mean the same for any number of them.
WeightedNorm mean_norm(const RunSettings& settings, const Orbit& start, int orbits) {
  Eigen::VectorXd states = state_weights(settings) / orbits;
  ParameterVector parameters(settings.layout);
  parameters.setOnes();
  parameters.durations(max_torus_segments) *= default_weight(std::abs(start.period()) / orbits);
  for (const IndexedValue& w : settings.parameter_weights) parameters(w.index - 1) = w.value;
  parameters.durations(max_torus_segments) /= orbits;
  return {std::move(states), std::move(parameters)};
}

}  // namespace

BranchSetup TorusProblem::set_up(const HybridSystem& system, const RunSettings& settings,
                                 const SelectedStart& start) const {
  return continue_torus(*this, system, settings, start);
}

BranchSetup TorusProblem::prepare(const HybridSystem& system, const RunSettings& one_return,
                                  const SelectedStart& start) const {
  const Orbit& x = start.start.orbit;
  const int orbits = x.shape.segments / segment_count(one_return);
  const std::vector<int> free = free_problem_parameters(one_return);
  check_memory(x.shape, static_cast<int>(free.size()));
  auto equations = std::make_unique<TorusSystem>(system, one_return.signature(), orbits, free,
                                                 torus_winding(system, one_return.signature(), x));
  BranchSetup setup{this, settings_of_orbits(one_return, orbits)};
  setup.constants = one_return;
  BranchCurve curve = make_curve_(*equations, x.shape, one_return);
  setup.make_tests = [tests = std::move(curve.tests), settings = setup.settings] { return tests(settings); };
  setup.discretisation = std::make_shared<TorusDiscretisation>(*equations, one_return);
  setup.follower = std::make_unique<PathFollower>(
      *equations, x.shape, mean_norm(setup.settings, x, orbits), newton_settings(one_return),
      one_return.free_parameters.front(), std::move(curve.condition), branch_monitors(*equations, setup.settings, x));
  setup.defining = std::move(equations);
  return setup;
}

BranchCurve free_torus(const TorusSystem& system, const OrbitShape&, const RunSettings&) {
  return {nullptr, [&system](const RunSettings& settings) {
            return torus_tests(system, settings, chosen_events(settings, system.segments_per_return()));
          }};
}

BranchCurve touching_torus(const TorusSystem& system, const OrbitShape& shape, const RunSettings& one_return) {
  const auto events = chosen_events(one_return, segment_count(one_return));
  if (events.empty())
    throw UserError(
        "IPS = 152 follows tori that touch a monitored event function, and GCHGRZIND lists none: name it on "
        "the segment where it is touched, as in GCHGRZIND=[[1]]");
  const auto tests = [&system](const RunSettings& settings) {
    auto others = chosen_events(settings, system.segments_per_return());
    if (!others.empty()) others.erase(others.begin());
    return torus_tests(system, settings, others);
  };
  return {std::make_unique<TorusContactCondition>(system, shape, events.front().segment, events.front().event), tests};
}

std::vector<MonitoredEvent> chosen_events(const RunSettings& settings, int segments_per_return) {
  std::vector<MonitoredEvent> all;
  for (int s = 0; s < segments_per_return; ++s)
    for (const int event : settings.segments[static_cast<std::size_t>(s)].monitor) all.push_back({s, event});
  if (settings.test_functions.empty()) return all;
  std::vector<MonitoredEvent> chosen;
  for (const int k : settings.test_functions)
    if (k >= 1 && static_cast<std::size_t>(k) <= all.size()) chosen.push_back(all[static_cast<std::size_t>(k) - 1]);
  return chosen;
}

}  // namespace tchat
