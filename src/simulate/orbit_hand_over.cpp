#include "simulate/orbit_hand_over.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "base/levels.hpp"
#include "files/dat_file.hpp"
#include "model/events.hpp"
#include "model/parameter_vector.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;

/// Of each state over all segments; infinite for what is not compared.
VectorXd ranges(const std::vector<SimulatedSegment>& segments, const std::vector<Eigen::Index>& ignorable) {
  VectorXd low = segments.front().low, high = segments.front().high;
  for (const SimulatedSegment& segment : segments) {
    low = low.cwiseMin(segment.low);
    high = high.cwiseMax(segment.high);
  }
  VectorXd range = (high - low).cwiseMax(std::numeric_limits<double>::min());
  for (const Eigen::Index k : ignorable) range(k) = std::numeric_limits<double>::infinity();
  return range;
}

VectorXd sizes(const std::vector<SimulatedSegment>& segments, const std::vector<Eigen::Index>& ignorable) {
  VectorXd size = VectorXd::Constant(segments.front().low.size(), std::numeric_limits<double>::min());
  for (const SimulatedSegment& segment : segments)
    size = size.cwiseMax(segment.low.cwiseAbs()).cwiseMax(segment.high.cwiseAbs());
  for (const Eigen::Index k : ignorable) size(k) = std::numeric_limits<double>::infinity();
  return size;
}

}  // namespace

RecordedPeriod recorded_period(const std::vector<SimulatedSegment>& segments, std::optional<long> events,
                               const std::vector<Eigen::Index>& ignorable) {
  const auto whole = static_cast<std::size_t>(
      std::find_if(segments.begin(), segments.end(),
                   [](const SimulatedSegment& segment) { return segment.ended_by != SegmentEnd::event; }) -
      segments.begin());
  if (whole == 0) return {};
  const VectorXd range = ranges(segments, ignorable);
  std::size_t period = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t q = 1; q < whole; ++q) {
    if (segments[q].index != segments[0].index) continue;
    if (events && static_cast<long>(q) != *events) continue;
    const double distance = (segments[q].after - segments[0].after).cwiseQuotient(range).lpNorm<Eigen::Infinity>();
    if (!(distance < 0.5 * least)) continue;
    least = distance;
    period = q;
  }
  if (period == 0) return {};
  const auto begin = segments.begin() + 1;
  std::vector<SimulatedSegment> part(begin, begin + static_cast<std::ptrdiff_t>(period));
  VectorXd size = sizes(part, ignorable);
  return {std::move(part), std::move(size)};
}

namespace {

constexpr double no_bound = 1e300;
constexpr double surface = level::orbit;  // h below minus this, times its scale, is negative

/// The values of an event function along a segment.
struct EventValues {
  double least = no_bound, scale = 0.0;

  EventValues(const HybridSystem& system, int event, const Eigen::MatrixXd& states, const Eigen::VectorXd& par,
              const Eigen::VectorXd& sizes) {
    for (const auto& column : states.colwise()) {
      const Eigen::VectorXd x = column;
      const EventAt at = event_at(system, event, x.data(), par.data());
      scale = std::max(scale, at.scale(x.data(), sizes));
      if (!(at.h >= least)) least = at.h;  // NaN is kept
    }
  }
  bool is_negative() const { return !(least >= -surface * scale); }
};

/// Does the event change neither state nor field, as a Poincare section? What follows is seen where segment s ends by
/// it; elsewhere the index jump function is asked all along the segment, for what follows may depend on the state. An
/// event that is only monitored is none.
bool is_section(const HybridSystem& system, const FoundOrbit& orbit, std::size_t s, int event,
                const Eigen::MatrixXd& states, const Eigen::VectorXd& par) {
  const std::vector<IndexVector>& watched = orbit.modes[s].index_vectors;
  const auto v = std::find_if(watched.begin(), watched.end(), [&](const auto& w) { return w.event == event; });
  if (v == watched.end() || !is_identity_jump(system, *v)) return false;
  if (*v == orbit.signature[s]) return orbit.signature[(s + 1) % orbit.signature.size()].field == v->field;
  const auto columns = states.colwise();
  return std::all_of(columns.begin(), columns.end(), [&](const Eigen::VectorXd& x) {
    const auto following = system.successors(*v, x.data(), par.data());
    return following && !following->empty() && following->front().field == v->field;
  });
}

/// Events of segment s' mode whose contact would matter: no sections, and none that is negative somewhere, which would
/// make every point of the branch inadmissible.
std::vector<int> monitored_events(const HybridSystem& system, const FoundOrbit& orbit, std::size_t s,
                                  const Eigen::MatrixXd& states, const Eigen::VectorXd& par) {
  std::vector<int> events;
  for (const int event : orbit.modes[s].all_events()) {
    const EventValues values(system, event, states, par, orbit.sizes);
    if (values.is_negative() || is_section(system, orbit, s, event, states, par)) continue;
    events.push_back(event);
  }
  std::sort(events.begin(), events.end());
  return events;
}

/// The jump that contact with a monitored event brings, where all of them that change the state have the same one.
std::optional<int> jump_of_contact(const HybridSystem& system, const FoundOrbit& orbit,
                                   const std::vector<SegmentSettings>& segments) {
  std::set<int> jumps;
  for (std::size_t s = 0; s < segments.size(); ++s)
    for (const IndexVector& v : orbit.modes[s].index_vectors) {
      const std::vector<int>& monitored = segments[s].monitor;
      const bool is_monitored = std::find(monitored.begin(), monitored.end(), v.event) != monitored.end();
      if (is_monitored && !is_identity_jump(system, v)) jumps.insert(v.jump);
    }
  if (jumps.size() != 1) return std::nullopt;
  return *jumps.begin();
}

bool is_free(const std::vector<int>& free, int k) { return std::find(free.begin(), free.end(), k) != free.end(); }

/// Weights of parameters: those given; durations have none, unless some have been given one.
std::vector<IndexedValue> parameter_weights(const RunSettings& base, int segments) {
  const auto is_weighted = [&base](const IndexedValue& w) { return !is_parameter(base, w.index) && w.value != 0.0; };
  const bool durations_weighted =
      std::any_of(base.parameter_weights.begin(), base.parameter_weights.end(), is_weighted);
  std::vector<IndexedValue> weights;
  for (const IndexedValue& weight : base.parameter_weights)
    if (is_parameter(base, weight.index)) weights.push_back(weight);
  if (!durations_weighted)
    for (int s = 0; s < segments; ++s) weights.push_back({base.layout.duration(s), 0.0});
  return weights;
}

/// `base` for a start from data with this parameter free, and no bounds that exclude the start.
RunSettings with_free_parameter(const RunSettings& base, const Eigen::VectorXd& par, int parameter) {
  RunSettings settings = base;
  settings.start = {};
  settings.parameter_values.clear();
  leave_out_monitors(settings);
  settings.held.clear();
  settings.conserved.clear();
  settings.free_parameters = {parameter};
  const bool same_parameter = !base.free_parameters.empty() && base.free_parameters.front() == parameter;
  const double value = par(parameter - 1);
  if (!same_parameter || value < settings.parameter_min) settings.parameter_min = -no_bound;
  if (!same_parameter || value > settings.parameter_max) settings.parameter_max = no_bound;
  std::erase_if(settings.bounds, [&](const BoundedValue& bounded) {
    const int k = bounded.parameter;
    return !is_parameter(base, k) || par(k - 1) < bounded.least || par(k - 1) > bounded.most;
  });
  return settings;
}

}  // namespace

std::string unmonitored_events(const HybridSystem& system, const FoundOrbit& orbit, const OrbitSamples& samples,
                               const Eigen::VectorXd& par) {
  const Eigen::Index n = system.dimension();
  std::string text;
  for (std::size_t s = 0; s < orbit.signature.size(); ++s) {
    const Eigen::MatrixXd states = samples.states.middleRows(static_cast<Eigen::Index>(s) * n, n);
    for (const int event : orbit.modes[s].all_events())
      if (EventValues(system, event, states, par, orbit.sizes).is_negative() &&
          !is_section(system, orbit, s, event, states, par))
        text += fmt::format(
            "Event {} ({}) is negative on segment {}, so it is not monitored there: if field {} ({}) holds only where "
            "it "
            "is positive, its sign or what follows it is wrong.\n",
            event, system.function_name(FunctionKind::event, event), s + 1, orbit.signature[s].field,
            system.function_name(FunctionKind::field, orbit.signature[s].field));
  }
  return text;
}

std::string orbit_data_text(const HybridSystem& system, const FoundOrbit& orbit, const OrbitSamples& samples,
                            const Eigen::VectorXd& par) {
  std::string text =
      fmt::format("# Periodic orbit of {}, found by simulation and refined by shooting.\n# signature {}\n",
                  system.name(), to_string(orbit.signature));
  text += fmt::format("# period {}\n", orbit.map.period);
  text += parameter_lines(system, par);
  for (std::size_t s = 0; s < orbit.map.segments.size(); ++s)
    text +=
        fmt::format("# PAR({}) = {}\n", system.layout().duration(static_cast<int>(s)), orbit.map.segments[s].duration);
  text += fmt::format("# tau, then the {} states of each segment\n", system.dimension());
  for (std::size_t k = 0; k < samples.tau.size(); ++k) {
    text += fmt::format("{:.17g}", samples.tau[k]);
    for (const double value : samples.states.col(static_cast<Eigen::Index>(k))) text += fmt::format(" {:.17g}", value);
    text += '\n';
  }
  return text;
}

RunSettings default_orbit_settings(const RunSettings& given) {
  const RunSettings plain;
  RunSettings settings = given;
  const auto prefer = [&](auto member, auto value) {
    if (given.*member == plain.*member) settings.*member = value;
  };
  prefer(&RunSettings::tolerance_parameters, level::converged);
  prefer(&RunSettings::tolerance_states, level::converged);
  prefer(&RunSettings::tolerance_special, level::orbit);
  prefer(&RunSettings::derivative_order, 2);
  return settings;
}

RunSettings orbit_settings(const HybridSystem& system, const RunSettings& base, const FoundOrbit& orbit,
                           const OrbitSamples& samples, const Eigen::VectorXd& par, int parameter) {
  const int m = static_cast<int>(orbit.signature.size());
  const Eigen::Index n = system.dimension();
  RunSettings settings = with_free_parameter(base, par, parameter);
  settings.dimension = static_cast<int>(n);
  settings.mesh_intervals = samples.intervals;
  settings.problem_type = periodic_orbit.number;
  settings.branch_mode = periodic_orbit.branch_mode;
  for (int s = 0; s < m; ++s) settings.free_parameters.push_back(system.layout().duration(s));
  settings.parameter_weights = parameter_weights(base, m);
  std::erase_if(settings.user_values,
                [&](const UserValue& u) { return !is_free(settings.free_parameters, std::abs(u.parameter)); });

  settings.segments.clear();
  settings.test_functions.clear();
  for (int s = 0; s < m; ++s) {
    SegmentSettings segment;
    const auto k = static_cast<std::size_t>(s);
    segment.index = orbit.signature[k];
    segment.type = is_identity_jump(system, segment.index) ? 0 : 1;
    segment.monitor = monitored_events(system, orbit, k, samples.states.middleRows(s * n, n), par);
    for (std::size_t i = 0; i < segment.monitor.size(); ++i)
      settings.test_functions.push_back(static_cast<int>(settings.test_functions.size()) + 1);
    settings.segments.push_back(std::move(segment));
  }
  if (base.grazing_jump == RunSettings{}.grazing_jump)
    settings.grazing_jump = jump_of_contact(system, orbit, settings.segments).value_or(base.grazing_jump);
  return settings;
}

std::string equilibrium_data_text(const HybridSystem& system, const Eigen::VectorXd& x, const Eigen::VectorXd& par) {
  return fmt::format("# Equilibrium of {}, found by simulation.\n{}{:.17g}\n", system.name(),
                     parameter_lines(system, par), fmt::join(x.begin(), x.end(), " "));
}

RunSettings equilibrium_settings(const HybridSystem& system, const RunSettings& base, int field,
                                 const std::vector<int>& events, const Eigen::VectorXd& x, const Eigen::VectorXd& par,
                                 int parameter) {
  RunSettings settings = with_free_parameter(base, par, parameter);
  settings.dimension = system.dimension();
  settings.problem_type = equilibrium.number;
  settings.branch_mode = equilibrium.branch_mode;
  settings.test_functions.clear();
  settings.parameter_weights.clear();
  std::erase_if(settings.user_values, [&base](const UserValue& value) { return !is_parameter(base, value.parameter); });
  SegmentSettings segment;
  segment.index = {field, no_function, no_function};
  segment.type = 0;
  for (const int event : events)
    if (system.event(event, x.data(), par.data()) > 0.0) segment.monitor.push_back(event);
  settings.segments = {segment};
  return settings;
}

}  // namespace tchat
