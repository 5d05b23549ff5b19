#include "bvp/admissibility.hpp"

#include <fmt/format.h>

#include <cmath>

namespace tchat {

namespace {

constexpr double tolerance = 1e-9;
/// How close to parallel two gradients of a pinned start must be, and how close to zero h there.
constexpr double structural_tolerance = 1e-6;

using Vector = Eigen::VectorXd;

Vector event_gradient(const HybridSystem& system, int event, const double* x, const double* par) {
  Vector gradient(system.dimension());
  double h = 0.0;
  system.first(FunctionKind::event, event, x, par, {}, &h, gradient.data(), nullptr);
  return gradient;
}

/// Does the jump from segment `before` land on the surface h_event = 0 by structure?
bool start_is_pinned(const HybridSystem& system, const IndexVector& before, int event, const double* end_before,
                     const double* start, const double* par) {
  const double h = system.event(event, start, par);
  if (std::abs(h) > structural_tolerance) return false;
  const int n = system.dimension();
  Vector g(n);
  Eigen::MatrixXd gx(n, n);
  system.first(FunctionKind::jump, before.jump, end_before, par, {}, g.data(), gx.data(), nullptr);
  const Vector composed = gx.transpose() * event_gradient(system, event, start, par);
  const Vector terminal = event_gradient(system, before.event, end_before, par);
  const double sizes = composed.norm() * terminal.norm();
  return sizes > 0.0 && std::abs(std::abs(composed.dot(terminal)) / sizes - 1.0) < structural_tolerance;
}

}  // namespace

std::vector<Violation> inadmissibilities(const HybridSystem& system, const Signature& signature,
                                         const std::vector<std::vector<int>>& monitored, const Orbit& x) {
  std::vector<Violation> result;
  const int m = x.shape.segments;
  const int last = x.shape.nodes() - 1;
  const double* par = x.par.data();
  for (int s = 0; s < m; ++s) {
    const auto index = static_cast<std::size_t>(s);
    const IndexVector& v = signature[index];
    const int before = (s + m - 1) % m;
    if (x.duration(s) < -tolerance * (1.0 + std::abs(x.period())))
      result.push_back({Violation::negative_duration, s + 1, 0, 0.0, x.duration(s)});

    for (const int event : monitored[index]) {
      Violation worst{Violation::event_crossed, s + 1, event, 0.0, 0.0};
      const int first =
          start_is_pinned(system, signature[static_cast<std::size_t>(before)], event, x.end(before), x.start(s), par)
              ? 1
              : 0;
      for (int k = first; k <= (event == v.event ? last - 1 : last); ++k) {
        const double h = system.event(event, x.node(s, k), par);
        if (h < worst.value) worst.value = h, worst.tau = x.tau(k);
      }
      if (worst.value < -tolerance * (1.0 + x.states.cwiseAbs().maxCoeff())) result.push_back(worst);
    }

    Vector f(x.shape.dimension);
    system.value(FunctionKind::field, v.field, x.end(s), par, f.data());
    const Vector gradient = event_gradient(system, v.event, x.end(s), par);
    const double slope = gradient.dot(f);
    if (slope > tolerance * (1.0 + gradient.norm() * f.norm()))
      result.push_back({Violation::leaving_terminal_surface, s + 1, v.event, 1.0, slope});
  }
  return result;
}

std::string describe(const Violation& violation, const HybridSystem& system) {
  switch (violation.kind) {
    case Violation::negative_duration:
      return fmt::format("segment {}: negative duration {:.4g}", violation.segment, violation.value);
    case Violation::event_crossed:
      return fmt::format("segment {}: h{} ({}) = {:.4g} at tau = {:.4g}", violation.segment, violation.event,
                         system.function_name(FunctionKind::event, violation.event), violation.value, violation.tau);
    default:
      return fmt::format("segment {}: h_x f = {:.4g} > 0 at its end, h{} ({}) is crossed from below", violation.segment,
                         violation.value, violation.event, system.function_name(FunctionKind::event, violation.event));
  }
}

}  // namespace tchat
