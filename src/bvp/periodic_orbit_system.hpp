/// Problem type 180, ISW 1: a periodic orbit of a given signature with one free parameter (5.1-5.7).
///
///     x_s' = T_s f_{i_s}(x_s, p),   h_{j_s}(x_s(1), p) = 0,   x_{s+1}(0) = g_{k_s}(x_s(1), p)   (s cyclic)
///
/// Unknowns: n m functions, m durations, 1 parameter. Conditions: n m + m boundary conditions and pseudo-arclength.
/// No phase condition: the event surfaces fix the phase.
#pragma once

#include "bvp/ring_system.hpp"

namespace tchat {

class PeriodicOrbitSystem final : public RingSystem {
 public:
  using RingSystem::RingSystem;

  int end_conditions(int) const override { return 1; }
  void end_values(int s, const double* x, const double* par, double* values) const override;
  void end_derivatives(int s, const double* x, const double* par, double* values, double* dx,
                       double* dp) const override;
  std::string end_condition_name(int s, int r) const override;
};

}  // namespace tchat
