#include "orbit/admissibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "base/levels.hpp"
#include "linear/array_kernel.hpp"
#include "linear/memory.hpp"
#include "model/events.hpp"

namespace tchat {

Crossing crossing_at_end(const DefiningSystem& defining, const Orbit& x, int s) {
  if (!defining.has_event(s)) return {-1.0, 1.0};
  const int n = defining.dimension();
  StackVector f(n);
  StackVector gradient(n);
  const int field = defining.signature()[static_cast<std::size_t>(s)].field;
  defining.system().value(FunctionKind::field, field, x.end(s), x.par.data(), f.data());
  defining.section_gradient(s, x.end(s), x.par.data(), gradient.data());
  return {gradient.dot(f), gradient.norm() * f.norm()};
}

Crossing crossing_of_event(const HybridSystem& system, int event, int field, const double* x, const double* par) {
  StackVector f(system.dimension());
  StackVector gradient(system.dimension());
  double h = 0.0;
  system.first(FunctionKind::event, event, x, par, {}, &h, gradient.data(), nullptr);
  system.value(FunctionKind::field, field, x, par, f.data());
  return {gradient.dot(f), gradient.norm() * f.norm()};
}

namespace {

/// Between nodes h counts as negative beyond this share of its size, which rounding and a located point do not reach.
constexpr double surely_negative = level::located;

}  // namespace

std::vector<Violation> inadmissibilities(const HybridSystem& system, const Signature& signature,
                                         const std::vector<std::vector<int>>& monitored, const Orbit& x,
                                         const std::vector<EventCourse>& courses, const CollocationRule& rule,
                                         double error, double leaving) {
  std::vector<Violation> result;
  const int m = x.shape.segments;
  const double* par = x.par.data();
  const double error_of_states = error * (1.0 + array_functions().range(x.states.data(), x.states.size()).largest);
  const double period = std::abs(x.period());
  auto course_of_event = courses.begin();
  for (int s = 0; s < m; ++s) {
    const auto index = static_cast<std::size_t>(s);
    const IndexVector& v = signature[index];
    if (x.duration(s) < -orbit_accuracy * period)
      result.push_back({Violation::negative_duration, s + 1, 0, 0.0, x.duration(s)});

    for (const int event : monitored[index]) {
      Violation worst{Violation::event_crossed, x.shape.stored_nodes() == 1 ? 0 : s + 1, event, 0.0, 0.0};
      const EventCourse& course = *course_of_event++;
      const double scale = scale_of(system, x, course);
      const bool leaves_out_start = course.at_nodes(0) < 0.0 && is_pinned_start(system, signature, x, s, event, scale);
      const int last = x.shape.nodes_of(s) - (event == v.event ? 2 : 1);
      for (int k = leaves_out_start ? 1 : 0; k <= last; ++k)
        if (const double h = course.at_nodes(k); h < worst.value) worst.value = h, worst.tau = x.tau(s, k);
      for (const EventMinimum& dip : polished_minima(system, signature, rule, x, course, -surely_negative * scale)) {
        const double uncertainty =
            2.0 * error_of_states * event_at(system, event, dip.state.data(), par).gradient.lpNorm<1>();
        if (dip.value < std::min(worst.value, -std::max(surely_negative * scale, uncertainty)))
          worst.value = dip.value, worst.tau = dip.tau;
      }
      if (worst.value < -orbit_accuracy * scale) result.push_back(worst);
    }

    add_sliding_violations(result, system, signature, monitored[index], x, s, leaving);

    if (v.event == no_function) continue;
    const Crossing end = crossing_of_event(system, v.event, v.field, x.end(s), par);
    if (end.rate > leaving * end.sizes)
      result.push_back({Violation::leaving_terminal_surface, s + 1, v.event, 1.0, end.rate});
  }
  for (int s = 0; s < m && x.shape.stored_nodes() > 1; ++s)
    if (!follows_rules(system, signature, x, s))
      result.push_back({Violation::against_rules, s + 1, signature[static_cast<std::size_t>(s)].event, 1.0, 0.0});
  return result;
}

std::vector<Violation> inadmissibilities(const HybridSystem& system, const Signature& signature,
                                         const std::vector<std::vector<int>>& monitored, const Orbit& x,
                                         const CollocationRule& rule, double error, double leaving) {
  return inadmissibilities(system, signature, monitored, x, event_courses(system, signature, monitored, rule, x), rule,
                           error, leaving);
}

namespace {

/// Not where the rules, at x, have the same field and event with another jump. Other fields and events are the user's
/// choice, and an event without a jump cuts the orbit.
bool may_follow(const HybridSystem& system, const IndexVector& from, const IndexVector& to, const double* x,
                const double* par) {
  std::array<std::int32_t, 3 * 64> listed;
  const int count = system.successors(from, x, par, listed);
  if (count > 64) return true;
  bool has_other_jump = false;
  for (int v = 0; v < count; ++v) {
    const IndexVector next{listed[3 * v], listed[3 * v + 1], listed[3 * v + 2]};
    if (next == to) return true;
    has_other_jump = has_other_jump || (next.field == to.field && next.event == to.event);
  }
  return !has_other_jump || is_identity_jump(system, to);
}

/// Does the problem say what follows the end of segment s, where that is not at grazing?
bool has_rule(const HybridSystem& system, const Signature& signature, const Orbit& x, int s) {
  const IndexVector& from = signature[static_cast<std::size_t>(s)];
  const IndexVector& to = signature[(static_cast<std::size_t>(s) + 1) % signature.size()];
  const bool is_last = s + 1 == x.shape.segments && system.boundary_conditions() > 0;
  if (!system.has_successors() || is_last || from.event == no_function || to.event == no_function) return false;
  if (lasts_no_time(x, s) || lasts_no_time(x, (s + 1) % x.shape.segments)) return false;
  const Crossing end = crossing_of_event(system, from.event, from.field, x.end(s), x.par.data());
  return std::abs(end.transversality()) > tangent_contact;
}

}  // namespace

bool follows_rules_there(const HybridSystem& system, const Signature& signature, const Orbit& x, int s) {
  return !has_rule(system, signature, x, s) ||
         may_follow(system, signature[static_cast<std::size_t>(s)],
                    signature[(static_cast<std::size_t>(s) + 1) % signature.size()], x.end(s), x.par.data());
}

bool is_at_border_of_chatter(const HybridSystem& system, const Signature& signature, const Orbit& x) {
  for (int s = 0; s < x.shape.segments; ++s) {
    const tchat_chatter* const mode = system.chatter_with_limit(signature[static_cast<std::size_t>(s)].jump);
    if (mode != nullptr && std::abs(system.event(mode->margin, x.end(s), x.par.data())) <= level::visible) return true;
  }
  return false;
}

bool follows_rules(const HybridSystem& system, const Signature& signature, const Orbit& x, int s) {
  if (follows_rules_there(system, signature, x, s)) return true;
  const IndexVector& from = signature[static_cast<std::size_t>(s)];
  const IndexVector& to = signature[(static_cast<std::size_t>(s) + 1) % signature.size()];
  const double* par = x.par.data();
  Eigen::VectorXd beside = Eigen::Map<const Eigen::VectorXd>(x.end(s), x.shape.dimension);
  for (double& state : beside)
    for (const double sign : {1.0, -1.0}) {
      const double own = state;
      state += sign * level::located * x.states.row((&state - beside.data())).cwiseAbs().maxCoeff();
      const bool may = may_follow(system, from, to, beside.data(), par);
      state = own;
      if (may) return true;
    }
  return false;
}

std::string describe(const Violation& violation, const HybridSystem& system) {
  switch (violation.kind) {
    case Violation::negative_duration:
      return fmt::format("segment {}: negative duration {:.4g}", violation.segment, violation.value);
    case Violation::event_crossed:
      if (violation.segment == 0)
        return fmt::format("h{} ({}) = {:.4g} at the equilibrium", violation.event,
                           system.function_name(FunctionKind::event, violation.event), violation.value);
      return fmt::format("segment {}: h{} ({}) = {:.4g} at tau = {:.4g}", violation.segment, violation.event,
                         system.function_name(FunctionKind::event, violation.event), violation.value, violation.tau);
    case Violation::off_surface:
      return fmt::format("segment {} slides beside its surface: h{} ({}) = {:.4g} at its start", violation.segment,
                         violation.event, system.function_name(FunctionKind::event, violation.event), violation.value);
    case Violation::side_leads_away:
      return fmt::format(
          "segment {} slides where field {} ({}) leads away from the surface, |h_x f| = {:.4g} at its start",
          violation.segment, violation.event, system.function_name(FunctionKind::field, violation.event),
          violation.value);
    case Violation::crosses_where_it_slides:
      return fmt::format(
          "segment {} begins on a surface that its field {} ({}) leads back to, |h_x f| = {:.4g}: the orbit slides "
          "there",
          violation.segment, violation.event, system.function_name(FunctionKind::field, violation.event),
          violation.value);
    case Violation::against_rules:
      return fmt::format(
          "segment {}: after event {} ({}) the problem's rules lead to another segment than the next one",
          violation.segment, violation.event, system.function_name(FunctionKind::event, violation.event));
    default:
      return fmt::format("segment {}: h_x f = {:.4g} > 0 at its end, h{} ({}) is crossed from below", violation.segment,
                         violation.value, violation.event, system.function_name(FunctionKind::event, violation.event));
  }
}

namespace {

/// Whether an orbit meets the surface at a start, or has another reason to change the field there.
constexpr double meets_surface = level::located;

}  // namespace

void add_sliding_violations(std::vector<Violation>& violations, const HybridSystem& system, const Signature& signature,
                            const std::vector<int>& monitored, const Orbit& x, int s, double leaving) {
  const std::size_t m = signature.size();
  const IndexVector& v = signature[static_cast<std::size_t>(s)];
  const int before = signature[(static_cast<std::size_t>(s) + m - 1) % m].field;
  const double* start = x.start(s);
  const double* par = x.par.data();
  for (const tchat_sliding& mode : system.sliding_modes()) {
    const bool on_surface = is_on_surface(system, mode, start, par, meets_surface);
    if (v.field == mode.field) {
      if (!on_surface)
        violations.push_back(
            {Violation::off_surface, s + 1, mode.surface, 0.0, system.event(mode.surface, start, par)});
      for (const int side : {mode.minus, mode.plus}) {
        const int event = ends_with(mode, side);
        if (v.event == event || std::find(monitored.begin(), monitored.end(), event) != monitored.end()) continue;
        const SideRate rate = side_rate(system, mode, side, start, par);
        if (rate.away > leaving * rate.sizes)
          violations.push_back({Violation::side_leads_away, s + 1, side, 0.0, rate.away});
      }
    } else if (is_side(mode, v.field) && before == other_side(mode, v.field) && on_surface) {
      const SideRate rate = side_rate(system, mode, v.field, start, par);
      if (-rate.away > leaving * rate.sizes)
        violations.push_back({Violation::crosses_where_it_slides, s + 1, v.field, 0.0, -rate.away});
    }
  }
}

}  // namespace tchat
