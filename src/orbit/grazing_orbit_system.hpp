/// Problem type 150: periodic orbits in grazing contact, two free parameters (5.8-5.10).
///
/// The conditions of type 180 and, at the end of the grazing segment, h_x f = 0 besides h = 0.
/// Unknowns: n m functions, m durations, 2 parameters. Conditions: n m + m + 1 boundary conditions and
/// pseudo-arclength.
///
/// The segment ends at the contact x* with the identity jump. The return map of the smooth orbit is taken on the
/// section h_P = h_x f = 0 there, transversal where a* = h_{P,x} f > 0; the event's own surface is not.
#pragma once

#include "orbit/ring_system.hpp"
#include "orbit/surface_rate.hpp"

namespace tchat {

class GrazingOrbitSystem final : public RingSystem {
 public:
  /// `grazing_segment` counts from 0.
  GrazingOrbitSystem(const HybridSystem& system, Signature signature, std::vector<int> free_parameters,
                     int grazing_segment);

  int grazing_segment() const { return grazing_segment_; }
  int end_conditions(int s) const override { return s == grazing_segment_ ? 2 : 1; }
  void end_values(int s, const double* x, const double* par, double* values) const override;
  void end_derivatives(int s, const double* x, const double* par, double* values, double* dx,
                       double* dp) const override;
  std::string end_condition_name(int s, int r) const override;
  void section_gradient(int s, const double* x, const double* par, double* gradient) const override;

 private:
  const IndexVector& contact() const { return signature()[static_cast<std::size_t>(grazing_segment_)]; }

  int grazing_segment_;
  mutable SurfaceRate rate_;  // at the contact, kept because Newton's loop is not to allocate
};

}  // namespace tchat
