#include "bvp/admissibility.hpp"

#include <fmt/format.h>

#include <cmath>

#include "bvp/sliding_violations.hpp"
#include "bvp/transversality.hpp"
#include "hybrid/event_at.hpp"

namespace tchat {

namespace {

/// How close to parallel two gradients of a pinned start must be, and how close to zero h there (of its size).
constexpr double structural_tolerance = 1e-6;

using Vector = Eigen::VectorXd;

}  // namespace

bool is_pinned_start(const HybridSystem& system, const Signature& signature, const Orbit& x, int s, int event) {
  const int before = (s + x.shape.segments - 1) % x.shape.segments;
  const IndexVector& v = signature[static_cast<std::size_t>(before)];
  const double* par = x.par.data();
  if (v.event == no_function) return false;
  if (std::abs(system.event(event, x.start(s), par)) > structural_tolerance * event_scale(system, x, event))
    return false;
  const int n = system.dimension();
  Vector g(n);
  Eigen::MatrixXd gx(n, n);
  system.first(FunctionKind::jump, v.jump, x.end(before), par, {}, g.data(), gx.data(), nullptr);
  const Vector composed = gx.transpose() * event_at(system, event, x.start(s), par).gradient;
  const Vector terminal = event_at(system, v.event, x.end(before), par).gradient;
  const double sizes = composed.norm() * terminal.norm();
  return sizes > 0.0 && std::abs(std::abs(composed.dot(terminal)) / sizes - 1.0) < structural_tolerance;
}

std::vector<Violation> inadmissibilities(const HybridSystem& system, const Signature& signature,
                                         const std::vector<std::vector<int>>& monitored, const Orbit& x,
                                         double leaving) {
  std::vector<Violation> result;
  const int m = x.shape.segments;
  const int last = x.shape.nodes() - 1;
  const double* par = x.par.data();
  for (int s = 0; s < m; ++s) {
    const auto index = static_cast<std::size_t>(s);
    const IndexVector& v = signature[index];
    if (x.duration(s) < -orbit_accuracy * std::abs(x.period()))
      result.push_back({Violation::negative_duration, s + 1, 0, 0.0, x.duration(s)});

    for (const int event : monitored[index]) {
      Violation worst{Violation::event_crossed, x.shape.is_point() ? 0 : s + 1, event, 0.0, 0.0};
      const int first = is_pinned_start(system, signature, x, s, event) ? 1 : 0;
      for (int k = first; k <= (event == v.event ? last - 1 : last); ++k) {
        const double h = system.event(event, x.node(s, k), par);
        if (h < worst.value) worst.value = h, worst.tau = x.tau(k);
      }
      if (worst.value < -orbit_accuracy * event_scale(system, x, event)) result.push_back(worst);
    }

    add_sliding_violations(result, system, signature, monitored[index], x, s, leaving);

    if (v.event == no_function) continue;
    const EventAt end = event_at(system, v.event, v.field, x.end(s), par);
    if (end.rate() > leaving * end.sizes())
      result.push_back({Violation::leaving_terminal_surface, s + 1, v.event, 1.0, end.rate()});
  }
  return result;
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
    default:
      return fmt::format("segment {}: h_x f = {:.4g} > 0 at its end, h{} ({}) is crossed from below", violation.segment,
                         violation.value, violation.event, system.function_name(FunctionKind::event, violation.event));
  }
}

}  // namespace tchat
