#include "bvp/admissibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bvp/sliding_violations.hpp"
#include "bvp/transversality.hpp"
#include "hybrid/event_at.hpp"

namespace tchat {

namespace {

/// How close to parallel two gradients of a pinned start must be, and how close to zero h there (of its size).
constexpr double structural_tolerance = 1e-6;

/// Between nodes h counts as negative beyond this share of its size, which rounding and a located point do not reach.
constexpr double surely_negative = 1e-6;

using Vector = Eigen::VectorXd;

/// An event function along a segment, at the nodes and between them.
class EventProfile {
 public:
  EventProfile(const HybridSystem& system, int event, const Orbit& x, int s)
      : system_(system), event_(event), x_(x), s_(s), values_(x.shape.nodes()), times_(x.shape.nodes()) {
    for (int k = 0; k < x.shape.nodes(); ++k) {
      values_(k) = system.event(event, x.node(s, k), x.par.data());
      times_(k) = x.tau(k);
    }
  }

  /// The least value at the nodes first..last, if negative, with its tau.
  void take_nodes(int first, int last, Violation& worst) const {
    for (int k = first; k <= last; ++k)
      if (values_(k) < worst.value) worst.value = values_(k), worst.tau = times_(k);
  }

  /// Between these nodes: where the parabola through a pair of nodes and a neighbour of it falls below zero, h is
  /// looked at on the collocation polynomial. It is known there to `error`, that of the states.
  void take_between(int first, int last, const CollocationRule& rule, double error, double scale,
                    Violation& worst) const {
    for (int k = first; k < last; ++k)
      if (std::min(values_(k), values_(k + 1)) < sag(k)) look_between(k, rule, error, scale, worst);
  }

 private:
  /// By how much a parabola through nodes k, k + 1 and one beside them is at most below their chord.
  double sag(int k) const {
    const double gap = times_(k + 1) - times_(k);
    double curvature = 0.0;  // half the second derivative
    for (const int beside : {k - 1, k}) {
      if (beside < 0 || beside + 2 >= values_.size()) continue;
      const double left = (values_(beside + 1) - values_(beside)) / (times_(beside + 1) - times_(beside));
      const double right = (values_(beside + 2) - values_(beside + 1)) / (times_(beside + 2) - times_(beside + 1));
      curvature = std::max(curvature, (right - left) / (times_(beside + 2) - times_(beside)));
    }
    return curvature * gap * gap / 4.0;
  }

  void look_between(int k, const CollocationRule& rule, double error, double scale, Violation& worst) const {
    constexpr int parts = 8;
    const int c = rule.points();
    const int interval = k / c;
    Vector basis(c + 1);
    for (int part = 1; part < parts; ++part) {
      const double share = static_cast<double>(part) / parts;
      rule.basis((k - interval * c + share) / c, basis.data(), nullptr);
      const Vector state = x_.states.middleCols(s_ * x_.shape.nodes() + interval * c, c + 1) * basis;
      const EventAt at = event_at(system_, event_, state.data(), x_.par.data());
      if (!(at.h < std::min(worst.value, -surely_negative * scale))) continue;
      if (at.h > -2.0 * error * at.gradient.lpNorm<1>()) continue;
      worst.value = at.h;
      worst.tau = times_(k) + share * (times_(k + 1) - times_(k));
    }
  }

  const HybridSystem& system_;
  int event_;
  const Orbit& x_;
  int s_;
  Vector values_;
  Vector times_;
};

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
                                         const CollocationRule& rule, double error, double leaving) {
  std::vector<Violation> result;
  const int m = x.shape.segments;
  const int end_node = x.shape.nodes() - 1;
  const double* par = x.par.data();
  const double error_of_states = error * (1.0 + x.states.cwiseAbs().maxCoeff());
  for (int s = 0; s < m; ++s) {
    const auto index = static_cast<std::size_t>(s);
    const IndexVector& v = signature[index];
    if (x.duration(s) < -orbit_accuracy * std::abs(x.period()))
      result.push_back({Violation::negative_duration, s + 1, 0, 0.0, x.duration(s)});

    for (const int event : monitored[index]) {
      Violation worst{Violation::event_crossed, x.shape.is_point() ? 0 : s + 1, event, 0.0, 0.0};
      const int first = is_pinned_start(system, signature, x, s, event) ? 1 : 0;
      const int last = event == v.event ? end_node - 1 : end_node;
      const double scale = event_scale(system, x, event);
      const EventProfile profile(system, event, x, s);
      profile.take_nodes(first, last, worst);
      if (!x.shape.is_point()) profile.take_between(first, last, rule, error_of_states, scale, worst);
      if (worst.value < -orbit_accuracy * scale) result.push_back(worst);
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
