#include "simulate/start_notice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "model/event_at.hpp"
#include "model/identity_jump.hpp"
#include "model/relevant_events.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;
using Kind = StartNotice::Kind;

constexpr double rounding = 1e-6;  // of the state at a label or in a .dat, relative

/// h at x; 0 where it cannot be told from zero.
double clear_value(const HybridSystem& system, int event, const VectorXd& x, const VectorXd& par) {
  const EventAt at = event_at(system, event, x.data(), par.data());
  return std::abs(at.h) <= rounding * at.scale(x.data()) ? 0.0 : at.h;
}

/// Those of the first mode that change something: by their jump or, where the problem says what follows, the field.
std::vector<int> events_that_matter(const HybridSimulation& simulation) {
  const HybridSystem& system = simulation.system();
  const Mode& mode = simulation.mode();
  if (!simulation.is_cyclic())
    return relevant_events(system, mode.index_vectors, mode.field(), simulation.state().data(),
                           simulation.parameters().data());
  std::vector<int> events;
  for (const IndexVector& v : mode.index_vectors)
    if (!is_identity_jump(system, v)) events.push_back(v.event);
  return events;
}

/// What the start does, as a predicate of "the start".
std::string position_text(const HybridSystem& system, const StartNotice& notice) {
  const std::string event = event_name(system, notice.event);
  switch (notice.kind) {
    case Kind::behind:
      return fmt::format("is behind {}", event);
    case Kind::field_changes:
      return fmt::format("lies on {}, whose function falls", event);
    case Kind::after_event:
      return fmt::format("is taken as the state after {}, whose function falls", event);
    default:
      return fmt::format("is taken as the state before {}, whose function falls", event);
  }
}

std::string cure_of(Kind kind) {
  switch (kind) {
    case Kind::behind:
      return "  If that is a wall the motion is outside the model; start where the function is positive, with "
             "--state, -d or -s;\n  if the field changes there, begin in the field that holds, with --mode "
             "FIELD,EVENT,JUMP, or let the problem say what follows (0,0,0) there.\n";
    case Kind::field_changes:
      return "  The field changes there: start a little before it, or let the problem say what "
             "follows (0,0,0) at such a state.\n";
    case Kind::after_event:
      return "  The jump sends such a state to the same surface, falling again. With --before-event the event happens "
             "at t = 0.\n";
    default:
      return "  The jump takes the state off the surface, and the event happens at t = 0. With --after-event it does "
             "not happen.\n";
  }
}

}  // namespace

std::string event_name(const HybridSystem& system, int event) {
  const std::string name = system.function_name(FunctionKind::event, event);
  return name == fmt::format("event {}", event) ? name : fmt::format("event {} ({})", event, name);
}

std::vector<StartNotice> start_notices(const HybridSimulation& simulation) {
  const HybridSystem& system = simulation.system();
  const VectorXd& x = simulation.state();
  std::vector<StartNotice> notices;
  const std::vector<SurfaceStart>& on_surface = simulation.surface_starts();
  for (const SurfaceStart& start : on_surface) {
    const bool is_impact = !start.is_after && reverses_flow(system, start.index, x, simulation.parameters());
    if (start.is_undecided && !is_impact)
      notices.push_back({start.is_after ? Kind::after_event : Kind::before_event, start.index.event, start.h});
  }
  for (const int event : events_that_matter(simulation)) {
    const bool is_decided = std::any_of(on_surface.begin(), on_surface.end(),
                                        [event](const SurfaceStart& start) { return start.index.event == event; });
    if (is_decided) continue;
    const IndexVector& v = simulation.mode().ended_by(event);
    const double h = clear_value(system, event, x, simulation.parameters());
    const bool is_left = simulation.leaves_downwards(v) && !simulation.is_cyclic() &&
                         !keeps_field(system, v, v.field, x.data(), simulation.parameters().data());
    if (h < 0.0 || is_left) notices.push_back({is_left ? Kind::field_changes : Kind::behind, event, h});
  }
  return notices;
}

std::string notice_text(const HybridSystem& system, const StartNotice& notice) {
  const bool waits = notice.kind == Kind::behind || notice.kind == Kind::field_changes;
  return fmt::format("tchat: the start {}: its function is {:.6g} there{}.\n{}", position_text(system, notice),
                     notice.h, waits ? ", and nothing happens until it has risen above zero" : "",
                     cure_of(notice.kind));
}

std::string notice_summary(const HybridSystem& system, const std::vector<StartNotice>& notices, std::size_t starts) {
  std::map<std::pair<Kind, int>, std::vector<double>> values;
  for (const StartNotice& notice : notices) values[{notice.kind, notice.event}].push_back(notice.h);
  std::string text;
  for (const auto& [key, h] : values) {
    const auto [least, largest] = std::minmax_element(h.begin(), h.end());
    text +=
        fmt::format("tchat: {} of {} starts: the start {}; its function is {:.6g} to {:.6g} there.\n{}", h.size(),
                    starts, position_text(system, {key.first, key.second, 0.0}), *least, *largest, cure_of(key.first));
  }
  return text;
}

std::string side_without_effect(const HybridSimulation& simulation, const StartSide& side) {
  if (side.given == StartSide::Given::nothing) return "";
  const bool is_after = side.given == StartSide::Given::after;
  const char* const option = is_after ? "--after-event" : "--before-event";
  const std::vector<SurfaceStart>& starts = simulation.surface_starts();
  if (starts.empty())
    return fmt::format(
        "tchat: {} changes nothing: at the start no event function of the first index vectors is zero (within {:g} of "
        "its terms) and falls.\n",
        option, start_tolerance);
  for (const SurfaceStart& start : starts)
    if (is_after && !start.is_after)
      return fmt::format(
          "tchat: --after-event changes nothing for {}: its jump sends the motion back, so that its function rises "
          "after the event, and at the start it falls.\n",
          event_name(simulation.system(), start.index.event));
  return "";
}

}  // namespace tchat
