#include "run/unwatched_events.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "model/relevant_events.hpp"
#include "settings/family.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

std::set<int> watched(const RunSettings& settings) {
  std::set<int> events;
  for (const SegmentSettings& segment : settings.segments) {
    events.insert(segment.index.event);
    events.insert(segment.monitor.begin(), segment.monitor.end());
  }
  return events;
}

using SegmentsByEvent = std::map<int, std::set<int>>;  // segments from 1

/// GCHGRZIND with what is missing besides what is there.
std::string monitor_lists(const RunSettings& settings, const SegmentsByEvent& missing) {
  std::string text;
  for (std::size_t s = 0; s < settings.segments.size(); ++s) {
    std::set<int> events(settings.segments[s].monitor.begin(), settings.segments[s].monitor.end());
    for (const auto& [event, segments] : missing)
      if (segments.contains(static_cast<int>(s) + 1)) events.insert(event);
    text += fmt::format("{}[{}]", s == 0 ? "" : ", ", fmt::join(events, ", "));
  }
  return fmt::format("GCHGRZIND=[{}]", text);
}

/// Is the event's function negative somewhere on segment s, in any return of a torus? Then monitoring it would make
/// every orbit inadmissible.
bool is_negative(const HybridSystem& system, int event, const Orbit& x, int s, int segments_per_return) {
  constexpr double rounding = 1e-6;
  double least = 0.0;
  double scale = 1.0;
  for (; s < x.shape.segments; s += segments_per_return)
    for (int k = 0; k < x.shape.nodes_of(s); ++k) {
      const double h = system.event(event, x.node(s, k), x.par.data());
      if (!(h >= least)) least = h;
      scale = std::max(scale, std::abs(h));
    }
  return !(least >= -rounding * scale);
}

SegmentsByEvent missing_events(const HybridSystem& system, const RunSettings& settings, const Orbit& start) {
  SegmentsByEvent missing;
  if (!system.has_successors() || !signature_rules(settings).ends_in_events) return missing;
  const std::set<int> seen = watched(settings);
  const Signature signature = settings.signature();
  const std::size_t m = signature.size();
  for (std::size_t s = 0; s < m; ++s) {
    const double* x = start.start(static_cast<int>(s));
    const IndexVector& before = signature[(s + m - 1) % m];
    const bool is_start = before.event == no_function;  // no event precedes an orbit without a section
    const auto following = system.successors(is_start ? IndexVector{0, 0, 0} : before, x, start.par.data());
    const int field = signature[s].field;
    if (!following ||
        std::none_of(following->begin(), following->end(), [field](const IndexVector& v) { return v.field == field; }))
      continue;
    for (const int event : relevant_events(system, *following, field, x, start.par.data()))
      if (!seen.contains(event) && !is_negative(system, event, start, static_cast<int>(s), static_cast<int>(m)))
        missing[event].insert(static_cast<int>(s) + 1);
  }
  return missing;
}

}  // namespace

std::string unwatched_events(const HybridSystem& system, const RunSettings& settings, const Orbit& start) {
  const SegmentsByEvent missing = missing_events(system, settings, start);
  if (missing.empty()) return "";
  std::string list;
  for (const auto& [event, segments] : missing)
    list += fmt::format("{}event {} ({}) on segment {}", list.empty() ? "" : ", ", event,
                        system.function_name(FunctionKind::event, event), fmt::join(segments, ", "));
  return fmt::format(
      "{} may come next by the problem's successors, but is not monitored: orbits that it would end count as "
      "admissible; {} monitors it (GCIPSI numbers the events of these lists)",
      list, monitor_lists(settings, missing));
}

void watch_possible_events(const HybridSystem& system, RunSettings& settings, const Orbit& start) {
  for (const auto& [event, segments] : missing_events(system, settings, start))
    for (const int s : segments) settings.segments[static_cast<std::size_t>(s) - 1].monitor.push_back(event);
}

}  // namespace tchat
