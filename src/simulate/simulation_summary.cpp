#include "simulate/simulation_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "base/levels.hpp"
#include "base/limit_at_zero.hpp"
#include "model/events.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;
using Kind = StartNotice::Kind;

constexpr double rounding = level::located;  // of the state at a label or in a .dat, relative

/// h at x; 0 where it cannot be told from zero.
double clear_value(const HybridSystem& system, int event, const VectorXd& x, const VectorXd& par,
                   const VectorXd& sizes) {
  const EventAt at = event_at(system, event, x.data(), par.data());
  return std::abs(at.h) <= rounding * at.scale(x.data(), sizes) ? 0.0 : at.h;
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
    case Kind::released:
      return fmt::format("is in contact behind {}, which ends that, and goes on as after it", event);
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
    case Kind::released:
      return "";
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
  if (const int release = simulation.released(); release != 0)
    notices.push_back(
        {Kind::released, release, clear_value(system, release, x, simulation.parameters(), simulation.sizes())});
  for (const int event : events_that_matter(simulation)) {
    const bool is_decided = std::any_of(on_surface.begin(), on_surface.end(),
                                        [event](const SurfaceStart& start) { return start.index.event == event; });
    if (is_decided) continue;
    const IndexVector& v = simulation.mode().ended_by(event);
    const double h = clear_value(system, event, x, simulation.parameters(), simulation.sizes());
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

namespace {

/// "1 event", "3 events"
std::string counted(long n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

std::string index_text(const IndexVector& v) { return fmt::format("({},{},{})", v.field, v.event, v.jump); }

std::string multiplier_text(const std::complex<double>& mu) {
  if (mu.imag() == 0.0) return fmt::format("{:.10g}", mu.real());
  return fmt::format("{:.10g} {} {:.10g} i", mu.real(), mu.imag() < 0.0 ? '-' : '+', std::abs(mu.imag()));
}

std::string names_of(const HybridSystem& system, const std::vector<int>& events) {
  std::string names;
  for (const int event : events) names += (names.empty() ? "" : ", ") + event_name(system, event);
  return names;
}

std::string why_it_ended(const HybridSystem& system, const SimulationResult& result, const VectorXd& par) {
  const SimulatedSegment& last = result.last;
  if (result.accumulation) {
    const ChatteringDetector::Accumulation& limit = *result.accumulation;
    const IndexVector& v = last.index;
    const auto name = [&](FunctionKind kind, int index) { return system.function_name(kind, index); };
    const std::string cure =
        system.chatter_of_impact(v) != nullptr
            ? "has no limit that the problem's contact mode would see (page chatter, Mistakes).\n"
        : limit.pattern == 1
            ? fmt::format(
                  "needs a mode of its own: in formulas `contact resting on {} until lifts: {}, {} -> settled`\n"
                  "if it rests there (page chatter).\n",
                  name(FunctionKind::event, v.event), name(FunctionKind::field, v.field),
                  name(FunctionKind::jump, v.jump))
            : "(sticking, rolling) needs a mode of its own in the problem.\n";
    return fmt::format(
        "Events accumulate (chattering): the last {} are of pattern length {}, each duration about {:.2g} times that "
        "of one pattern before.\nThe limit is at t = {}{}, {:.3g} after the last event, at about x = {}. The "
        "simulation "
        "ends there:\nwhat follows {}",
        result.events > 20 ? 20 : result.events, limit.pattern, limit.ratio,
        known_digits(last.end_time() + limit.remaining, limit.uncertainty),
        limit.uncertainty > 0.0 ? fmt::format(" +- {:.1e}", limit.uncertainty) : "", limit.remaining,
        state_text(last.after), cure);
  }
  if (result.end == MotionEnd::escapes)
    return fmt::format("The motion escapes: at t = {:.6g} it is at x = {}, far beyond where it has been.\n",
                       last.end_time(), state_text(last.end));
  if (result.end == MotionEnd::dies_out)
    return fmt::format(
        "The motion dies out: the last events are 1e-12 times as fast as the first. It rests near x = {}.\n",
        state_text(last.after));
  switch (last.ended_by) {
    case SegmentEnd::event:
    case SegmentEnd::end_time:
      return "";
    case SegmentEnd::interrupted:
      return "Interrupted.\n";
    case SegmentEnd::no_event: {
      const std::string watched = names_of(system, last.mode.terminal_events());
      if (result.equilibrium) return fmt::format("The end: {}. Watched: {}.\n", last.message, watched);
      if (const std::string missed = names_of(system, missed_events(system, last, par)); !missed.empty())
        return fmt::format(
            "The end: {}. Watched: {}. The last state is x = {}.\nNegative there, and not positive when the segment "
            "begins: {}. An event can be met only after its function has been\npositive: start where it is (--state), "
            "or let a jump lead there; or a sign is wrong.\n",
            last.message, watched, state_text(last.end), missed);
      return fmt::format(
          "The end: {}. Watched: {}. The last state is x = {}.\nWait longer (--wait), start elsewhere (--state), watch "
          "other events (--mode, --signature), or end segments\nby an event that the motion meets, as a section.\n",
          last.message, watched, state_text(last.end));
    }
    default:
      return fmt::format("The end: {}.\n", last.message);
  }
}

}  // namespace

std::string problem_text(const HybridSystem& system, const VectorXd& par) {
  std::string text = system.name();
  for (int k = 1; k <= system.parameters(); ++k)
    text += fmt::format("{}{} = {}", k == 1 ? " with " : ", ", system.parameter_name(k), par(k - 1));
  return text;
}

std::string start_text(const HybridSystem& system, const SimulationStart& start, const Mode& mode) {
  std::string watched;
  for (const IndexVector& v : mode.index_vectors)
    watched += fmt::format("{}{}", watched.empty() ? "" : ", ", index_text(v));
  std::string text = fmt::format("{}\nStart: x = {} ({}), index vectors {}{}\n", problem_text(system, start.par),
                                 state_text(start.state), start.source, watched,
                                 start.rule.is_cyclic() ? ", then cyclically those of the signature" : "");
  VectorXd f(start.state.size());
  system.value(FunctionKind::field, mode.field(), start.state.data(), start.par.data(), f.data());
  if (f.isZero(0.0))
    text += "  The field is zero there, so nothing will move; give another start with --state, -d or -s.\n";
  return text;
}

namespace {

/// Does the orbit that the motion has settled on have the limit of such impacts? Then it was of the way there.
bool has_limit_of(const HybridSystem& system, const Turn& turn, const IndexVector& impact) {
  const tchat_chatter& mode = *system.chatter_of_impact(impact);
  return std::any_of(turn.segments.begin(), turn.segments.end(),
                     [&](const auto& segment) { return segment.index.jump == mode.limit; });
}

}  // namespace

std::string course_text(const HybridSystem& system, const SimulationResult& result, const VectorXd& par,
                        double contact) {
  std::string text = fmt::format("{} up to t = {:.12g}", counted(result.events, "event"), result.last.end_time());
  if (result.dropped > 0) text += fmt::format(", the first {} dropped as transient", result.dropped);
  text += "\n" + why_it_ended(system, result, par);
  for (const auto& [index, series] : result.broken_series)
    if (system.chatter_of_impact(index) != nullptr && !has_limit_of(system, result.turn, index))
      text += fmt::format(
          "Chatter is not complete: {} series of events of jump {} ({}) at falling intervals, up to {} in a "
          "row,\nended in a longer one, before any limit.\n",
          series.count, index.jump, system.function_name(FunctionKind::jump, index.jump), series.longest);
  if (result.contacts > 0)
    text += fmt::format("{} (least values of an event function within {:g} of its range)\n",
                        counted(result.contacts, "near-grazing contact"), contact);
  if (result.simultaneous > 0)
    text += fmt::format("{} several events came together; the first in the order of the index vectors went first\n",
                        counted(result.simultaneous, "time"));
  if (result.beyond > 0)
    text += fmt::format("{} beyond a wall (`beyond` in the list of events): states outside the model\n",
                        counted(result.beyond, "start"));
  if (result.violations > 0) {
    const SimulatedSegment& segment = *result.first_violation;
    for (const SegmentMark& mark : segment.marks) {
      if (mark.kind != SegmentMark::Kind::violation) continue;
      text += fmt::format(
          "{} a monitored event function fell below zero, first {} at t = {:.10g} in segment {}:\nthis signature "
          "has no such orbit there. {} what follows.\n",
          counted(result.violations, "time"), event_name(system, mark.event), mark.time, segment.number,
          system.has_successors() ? "Without a signature to follow the index jump function (successors) chooses"
                                  : "An index jump function (successors) would choose");
      break;
    }
  }
  return text;
}

std::string rest_text(const VectorXd& equilibrium) {
  return fmt::format(
      "The trajectory converges to the equilibrium x = {}, where the derivative of the field has no eigenvalue with a "
      "positive real part.\n",
      state_text(equilibrium));
}

std::string orbit_text(const HybridSystem& system, const FoundOrbit& orbit) {
  constexpr std::size_t most_shown = 12;  // states, and multipliers, of a large problem
  std::string text =
      fmt::format("Periodic orbit, signature {}, period {:.13g}\n", to_string(orbit.signature), orbit.map.period);
  for (std::size_t s = 0; s < orbit.signature.size(); ++s) {
    const IndexVector& v = orbit.signature[s];
    const MapSegment& segment = orbit.map.segments[s];
    text += fmt::format("  segment {}: {}, {} for {:.13g} until {}, h_x f = {:.10g}, then {}{}\n", s + 1, index_text(v),
                        system.function_name(FunctionKind::field, v.field), segment.duration,
                        system.function_name(FunctionKind::event, v.event), segment.event_velocity,
                        system.function_name(FunctionKind::jump, v.jump),
                        system.chatter_with_limit(v.jump) != nullptr ? " (infinitely many impacts)" : "");
  }
  text += "  start";
  // Of the largest state 13 digits are shown; what is smaller than the last of them is rounding.
  const double rounding = level::rounding_of_sums * orbit.start.cwiseAbs().maxCoeff();
  const Eigen::Index shown_states = std::min(orbit.start.size(), static_cast<Eigen::Index>(most_shown));
  for (Eigen::Index i = 0; i < shown_states; ++i)
    text += fmt::format("{} {} = {:.13g}", i > 0 ? "," : "", system.state_name(static_cast<int>(i) + 1),
                        std::abs(orbit.start(i)) > rounding ? orbit.start(i) : 0.0);
  if (orbit.start.size() > shown_states) text += fmt::format(", and {} more", orbit.start.size() - shown_states);
  text += "\n  multipliers";
  const std::size_t shown = std::min(orbit.multipliers.size(), most_shown);
  for (std::size_t i = 0; i < shown; ++i)
    text += fmt::format("{} {}", i > 0 ? "," : "", multiplier_text(orbit.multipliers[i]));
  if (orbit.multipliers.size() > shown) text += fmt::format(", and {} smaller ones", orbit.multipliers.size() - shown);
  text += ": " + stability_text(orbit.stability(), orbit.uncertainty) + "\n";
  for (Eigen::Index i = 0; i < orbit.advance.size(); ++i)
    if (orbit.advance(i) != 0.0)
      text += fmt::format(
          "  {}, which nothing depends on, advances by {:.13g} in each period ({:.6g} per unit of time)\n",
          system.state_name(static_cast<int>(i) + 1), orbit.advance(i), orbit.advance(i) / orbit.map.period);
  return text;
}

std::string stability_text(OrbitStability stability, double uncertainty) {
  switch (stability) {
    case OrbitStability::stable:
      return "stable";
    case OrbitStability::neutral:
      return fmt::format("neutral, the largest modulus is 1 within {:.1g}: the orbit is no attractor", uncertainty);
    default:
      return "not stable, so the orbit is no attractor: a simulation leaves it";
  }
}

std::string refined_text(const FoundOrbit& orbit, long events, const Eigen::VectorXd& size) {
  const std::string from = fmt::format("Newton's method from {} of the recorded motion", counted(events, "event"));
  if (!orbit.converged) return fmt::format("{} finds no periodic orbit: {}\n", from, orbit.message);
  return fmt::format("{}: {}, its start moved by {:.2g} of the states' size.\n", from,
                     counted(long{orbit.iterations}, "iteration"),
                     orbit.moved.cwiseQuotient(size).lpNorm<Eigen::Infinity>());
}

std::string not_refined_text(const FoundOrbit& orbit, long events) {
  return fmt::format("The motion repeats itself after {}, but shooting does not find the orbit: {}\n",
                     counted(events, "event"), orbit.message);
}

std::string nothing_recorded_text(const SimulationPlan& plan) {
  if (plan.events)
    return fmt::format(
        "Nothing to refine: the first event is not met again {} later; --events says how many a period has, and "
        "without it the nearest return is taken.\n",
        counted(*plan.events, "event"));
  return fmt::format("Nothing to refine: the first event is not met again within {} (--max-period).\n",
                     counted(long{plan.max_period}, "event"));
}

namespace {

/// Events that are watched in vain in nearly all segments, where the motion settles on nothing.
std::string missed_text(const HybridSystem& system, const SimulationResult& result) {
  constexpr double nearly_all = 0.9;
  std::string text;
  for (const auto& [event, missed] : result.missed)
    if (static_cast<double>(missed.count) >= nearly_all * static_cast<double>(result.events - result.dropped))
      text += fmt::format(
          "{} is not positive when segment {} begins and negative when it ends, and so in {} of {} segments: an event "
          "can be met only\nafter its function has been positive. A jump, or another sign, may be missing.\n",
          event_name(system, event), missed.first, missed.count, result.events - result.dropped);
  return text;
}

}  // namespace

std::string no_orbit_text(const HybridSystem& system, const SimulationResult& result, const SimulationPlan& plan,
                          const AttractorSearch& search) {
  switch (result.end) {
    case MotionEnd::accumulates:
    case MotionEnd::dies_out:
    case MotionEnd::escapes:
    case MotionEnd::no_event:
    case MotionEnd::failed:
      return "";
    default:
      if (!search.doubt().empty())
        return fmt::format("Undecided after {} events: {}. A longer simulation decides (--transient-events).\n",
                           result.events, search.doubt());
      if (const std::string why = search.unbounded(system); !why.empty())
        return fmt::format(
                   "No attractor yet after {} events: {}. A longer simulation (--transient-events) shows more.\n",
                   result.events, why) +
               missed_text(system, result);
      if (result.events == result.dropped)
        return "No event in this time, and periodic orbits are found by their events: simulate longer (--time), or "
               "end\n"
               "segments by an event that the motion meets, as a section.\n";
      if (const std::optional<int> period = search.repeats_after())
        return fmt::format(
            "The last events repeat, within {:g} of the orbit's range, after {}, but Newton's method finds no "
            "isolated\n"
            "periodic orbit there. It may be one of a family, as where the energy is conserved (--refine corrects the\n"
            "last period to the orbit nearest to it), or the motion may still drift (--transient-events).\n",
            plan.recognition, counted(long{*period}, "event"));
      return fmt::format(
                 "No periodic orbit recognised: the last events do not repeat, within {:g} of the orbit's range, after "
                 "1 to "
                 "{} events.\nIt may need longer (--transient-time, --events), have a longer period (--max-period), be "
                 "recognised with a\nlooser --recognition or a smaller --tolerance; or the motion is quasi-periodic "
                 "(--torus) "
                 "or chaotic (--lyapunov shows which).\n",
                 plan.recognition, plan.max_period) +
             missed_text(system, result);
  }
}

}  // namespace tchat
