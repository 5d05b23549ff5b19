/// Problem type 180, ISW 1: a periodic orbit of a given signature with one free parameter (5.1-5.7).
///
///     x_s' = T_s f_{i_s}(x_s, p),   h_{j_s}(x_s(1), p) = 0,   x_{s+1}(0) = g_{k_s}(x_s(1), p)   (s cyclic)
///
/// Unknowns: n m functions, m durations, 1 parameter. Conditions: n m + m boundary conditions and pseudo-arclength.
/// The event surfaces fix the phase. Where a segment has event function 0 there is none, and its condition is replaced
/// by Doedel's integral phase condition against a reference orbit r, that of the last step,
///
///     integral_0^1 <x_s - r_s, r_s'> dtau / |r_s'| = 0,     |r_s'|^2 = integral_0^1 <r_s', r_s'> dtau,
///
/// the same count. It is divided by |r_s'| to be a distance of states. The return map of such an orbit is taken on the
/// plane through x_s(1) across the flow.
#pragma once

#include "orbit/ring_system.hpp"

namespace tchat {

class PeriodicOrbitSystem : public RingSystem {
 public:
  PeriodicOrbitSystem(const HybridSystem& system, Signature signature, std::vector<int> free_parameters);

  int end_conditions(int s) const override { return has_event(s) ? 1 : 0; }
  void end_values(int s, const double* x, const double* par, double* values) const override;
  void end_derivatives(int s, const double* x, const double* par, double* values, double* dx,
                       double* dp) const override;
  std::string end_condition_name(int s, int r) const override;

  int integral_conditions() const override { return static_cast<int>(without_event_.size()); }
  void integral_values(const Orbit& x, const Orbit& reference, const CollocationRule& rule,
                       double* values) const override;
  void integral_gradients(const Orbit& x, const Orbit& reference, const CollocationRule& rule, double* values,
                          std::span<OrbitVector> rows) const override;
  std::string integral_name(int r) const override;

  void section_gradient(int s, const double* x, const double* par, double* gradient) const override;

 private:
  std::vector<int> without_event_;  // segments, from 0
  mutable std::vector<double> difference_, slope_;
};

}  // namespace tchat
