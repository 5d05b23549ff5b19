/// Defining systems of periodic orbits: in one parameter, with a conserved function, and in grazing contact.
#pragma once

#include "orbit/quantity.hpp"
#include "orbit/ring_system.hpp"

namespace tchat {

// Problem type 180, ISW 1: a periodic orbit of a given signature with one free parameter (5.1-5.7).
//
//     x_s' = T_s f_{i_s}(x_s, p),   h_{j_s}(x_s(1), p) = 0,   x_{s+1}(0) = g_{k_s}(x_s(1), p)   (s cyclic)
//
// Unknowns: n m functions, m durations, 1 parameter. Conditions: n m + m boundary conditions and pseudo-arclength.
// The event surfaces fix the phase. Where a segment has event function 0 there is none, and its condition is replaced
// by Doedel's integral phase condition against a reference orbit r, that of the last step,
//
//     integral_0^1 <x_s - r_s, r_s'> dtau / |r_s'| = 0,     |r_s'|^2 = integral_0^1 <r_s', r_s'> dtau,
//
// the same count. It is divided by |r_s'| to be a distance of states. The return map of such an orbit is taken on the
// plane through x_s(1) across the flow.

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

// Problem type 180 where a function H of the state is conserved: families of periodic orbits without a free parameter.
//
// Along trajectories H(x_s(t)) and H(g(x_s(1))) = H(x_s(1)) hold for any start, so that one of the conditions of
// PeriodicOrbitSystem follows from the others: the orbits are a family, and with a free parameter the problem would be
// singular. The unfolding parameter lambda takes that parameter's place (Munoz-Almaraz, Freire, Galan, Doedel,
// Vanderbauwhede, Physica D 181, 2003, 1-38), in the jump that closes the ring,
//
//     x_1(0) + lambda e = g_{k_m}(x_m(1), p),   e = H_x / |H_x| at x_1(0).
//
// The direction has the length 1, so that lambda is as large as what is left of the states, whatever the unit of H.
//
// Unknowns: n m functions, m durations, lambda, and one parameter for each held monitor. Conditions: n m + m boundary
// conditions, the held monitors, pseudo-arclength. For a solution, to first order H(x_1(0)) = H(g) - lambda
// |H_x|, and H(x_1(0)) = H(g) where H is conserved: lambda = 0. The computed lambda measures the error; a large one
// means that H is not conserved.
//
// The derivative by x_1(0) leaves lambda e_x out, which is zero at solutions: Newton's method still converges
// quadratically.

class ConservativeOrbitSystem final : public PeriodicOrbitSystem {
 public:
  /// `free_parameters` without the unfolding parameter, which becomes the last of them. `name`: of H, for messages.
  ConservativeOrbitSystem(const HybridSystem& system, const Signature& signature, std::vector<int> free_parameters,
                          Quantity conserved, std::string name);

  int conserved_quantities() const override { return 1; }
  std::optional<double> unfolding(const Orbit& x) const override { return x.par(layout().unfolding(segments()) - 1); }
  /// Where lambda is not zero, H changes along the orbit. Where lambda is zero, another function may be the conserved
  /// one: H and H_x f are looked at at three nodes of each segment, H at each jump.
  std::string why_no_solution(const Orbit& x) const override;

 protected:
  void target_pattern(int s, int row, CouplingPattern& pattern) const override;
  void target_value(int s, const Orbit& x, double* target) const override;
  double* target_derivatives(int s, const Orbit& x, double* entries) const override;

 private:
  bool closes(int s) const { return s == segments() - 1; }
  /// e.
  void find_direction(const Orbit& x) const;
  std::string why_not_closed(const Orbit& x) const;
  std::string why_not_constant(const Orbit& x) const;
  std::string why_not_constant_on(int s, const Orbit& x) const;
  std::string why_not_kept_by_jump(int s, const Orbit& x) const;
  std::string segment_name(int s) const;
  std::string jump_name(int s) const;
  double value(const double* x, const Orbit& orbit) const { return conserved_.value(x, orbit.par.data()); }

  QuantityFunction conserved_;
  std::string name_;
  mutable std::vector<double> gradient_, unused_, flow_, after_;
};

// Problem type 150: periodic orbits in grazing contact, two free parameters (5.8-5.10).
//
// The conditions of type 180 and, at the end of the grazing segment, h_x f = 0 besides h = 0.
// Unknowns: n m functions, m durations, 2 parameters. Conditions: n m + m + 1 boundary conditions and
// pseudo-arclength.
//
// The segment ends at the contact x* with the identity jump. The return map of the smooth orbit is taken on the
// section h_P = h_x f = 0 there, transversal where a* = h_{P,x} f > 0; the event's own surface is not.

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
