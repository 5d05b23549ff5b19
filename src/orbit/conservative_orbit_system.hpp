/// Problem type 180 where a function H of the state is conserved: families of periodic orbits without a free parameter.
///
/// Along trajectories H(x_s(t)) and H(g(x_s(1))) = H(x_s(1)) hold for any start, so that one of the conditions of
/// PeriodicOrbitSystem follows from the others: the orbits are a family, and with a free parameter the problem would be
/// singular. The unfolding parameter lambda takes that parameter's place (Munoz-Almaraz, Freire, Galan, Doedel,
/// Vanderbauwhede, Physica D 181, 2003, 1-38), in the jump that closes the ring,
///
///     x_1(0) + lambda H_x(x_1(0), p) = g_{k_m}(x_m(1), p).
///
/// Unknowns: n m functions, m durations, lambda, and one parameter for each held monitor. Conditions: n m + m boundary
/// conditions, the held monitors, pseudo-arclength. For a solution, to first order H(x_1(0)) = H(g) - lambda
/// |H_x|^2, and H(x_1(0)) = H(g) where H is conserved: lambda = 0. The computed lambda measures the error; a large one
/// means that H is not conserved.
///
/// The derivative by x_1(0) leaves lambda H_xx out, which is zero at solutions: Newton's method still converges
/// quadratically.
#pragma once

#include "orbit/periodic_orbit_system.hpp"
#include "orbit/quantity.hpp"
#include "orbit/unfolded_system.hpp"

namespace tchat {

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
  /// H_x at x_1(0).
  void find_gradient(const Orbit& x) const;
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

}  // namespace tchat
