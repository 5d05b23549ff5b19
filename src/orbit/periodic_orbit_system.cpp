#include "orbit/periodic_orbit_system.hpp"

#include <fmt/format.h>

#include <cmath>

#include "orbit/gauss_points.hpp"

namespace tchat {

namespace {

/// r' by tau at Gauss point g of interval j, times the length of the interval.
void slope_at(const Orbit& r, const CollocationRule& rule, int s, int j, int g, double* slope) {
  const double* node = r.node(s, j * r.shape.collocation);
  std::fill_n(slope, r.shape.dimension, 0.0);
  for (int i = 0; i <= rule.points(); ++i)
    for (int a = 0; a < r.shape.dimension; ++a) slope[a] += rule.slope(g, i) * *node++;
}

}  // namespace

PeriodicOrbitSystem::PeriodicOrbitSystem(const HybridSystem& system, Signature signature,
                                         std::vector<int> free_parameters)
    : RingSystem(system, std::move(signature), std::move(free_parameters)),
      difference_(static_cast<std::size_t>(dimension())),
      slope_(difference_.size()) {
  for (int s = 0; s < segments(); ++s)
    if (!has_event(s)) without_event_.push_back(s);
}

void PeriodicOrbitSystem::end_values(int s, const double* x, const double* par, double* values) const {
  if (has_event(s)) system().value(FunctionKind::event, signature()[static_cast<std::size_t>(s)].event, x, par, values);
}

void PeriodicOrbitSystem::end_derivatives(int s, const double* x, const double* par, double* values, double* dx,
                                          double* dp) const {
  if (has_event(s))
    system().first(FunctionKind::event, signature()[static_cast<std::size_t>(s)].event, x, par, free_parameters(),
                   values, dx, dp);
}

std::string PeriodicOrbitSystem::end_condition_name(int s, int) const {
  const int j = signature()[static_cast<std::size_t>(s)].event;
  return fmt::format("event {} ({}) at the end of segment {}", j, system().function_name(FunctionKind::event, j),
                     s + 1);
}

void PeriodicOrbitSystem::integral_values(const Orbit& x, const Orbit& reference, const CollocationRule& rule,
                                          double* values) const {
  const int n = dimension();
  for (const int s : without_event_) {
    double phase = 0.0;
    double speed = 0.0;
    for_each_gauss_point(x, rule, s, [&](int j, int g, double h, double weight) {
      interpolate(x, rule, s, j, g, difference_.data());
      interpolate(reference, rule, s, j, g, slope_.data());
      for (int a = 0; a < n; ++a) difference_[static_cast<std::size_t>(a)] -= slope_[static_cast<std::size_t>(a)];
      slope_at(reference, rule, s, j, g, slope_.data());
      for (std::size_t a = 0; a < slope_.size(); ++a) {
        phase += weight / h * difference_[a] * slope_[a];
        speed += weight / (h * h) * slope_[a] * slope_[a];
      }
    });
    *values++ = speed > 0.0 ? phase / std::sqrt(speed) : 0.0;
  }
}

void PeriodicOrbitSystem::integral_gradients(const Orbit& x, const Orbit& reference, const CollocationRule& rule,
                                             double* values, std::span<OrbitVector> rows) const {
  integral_values(x, reference, rule, values);
  for (std::size_t r = 0; r < without_event_.size(); ++r) {
    const int s = without_event_[r];
    OrbitVector& row = rows[r];
    row.set_zero();
    double speed = 0.0;
    for_each_gauss_point(x, rule, s, [&](int j, int g, double h, double weight) {
      slope_at(reference, rule, s, j, g, slope_.data());
      const int column = x.shape.first_node(s) + j * x.shape.collocation;
      for (int a = 0; a < dimension(); ++a) {
        const double slope = slope_[static_cast<std::size_t>(a)];
        speed += weight / (h * h) * slope * slope;
        for (int i = 0; i <= rule.points(); ++i) row.states(a, column + i) += weight / h * rule.value(g, i) * slope;
      }
    });
    if (speed > 0.0) row.scale(1.0 / std::sqrt(speed));
  }
}

std::string PeriodicOrbitSystem::integral_name(int r) const {
  return fmt::format("integral phase condition of segment {}", without_event_[static_cast<std::size_t>(r)] + 1);
}

void PeriodicOrbitSystem::section_gradient(int s, const double* x, const double* par, double* gradient) const {
  if (has_event(s)) return RingSystem::section_gradient(s, x, par, gradient);
  system().value(FunctionKind::field, signature()[static_cast<std::size_t>(s)].field, x, par, gradient);
}

}  // namespace tchat
