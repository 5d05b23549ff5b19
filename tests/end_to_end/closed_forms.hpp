/// Periodic orbits of the linear oscillator q'' + 2 zeta q' + q = alpha cos(omega t) in closed form.
#pragma once

#include <array>

namespace test_support {

using State = std::array<double, 4>;  ///< x1, x2, y1, y2

/// alpha / sqrt((1 - omega^2)^2 + (2 zeta omega)^2)
double amplitude(double alpha, double omega, double zeta);

/// The orbit without impacts, from a maximum of x1 on: x1 = A cos(omega t). The forcing is y2 = cos(omega t + phi) with
/// alpha cos(phi) = (1 - omega^2) A, alpha sin(phi) = 2 zeta omega A.
class NonimpactingOrbit {
 public:
  NonimpactingOrbit(double alpha, double omega, double zeta);
  State at(double time) const;
  double period() const;
  /// sqrt of the time mean of |x|^2: the mean of x1^2 + x2^2 is A^2 (1 + omega^2) / 2, y1^2 + y2^2 = 1.
  double l2_norm() const;

 private:
  double omega_, amplitude_, phase_;
};

/// The orbit with one impact of velocity v in N periods of the forcing, from just after the impact on: forced
/// oscillation plus the free one (u, u'), which the period T = 2 pi N/omega and the impact must close: H(T) (u, u') =
/// (u, u' + (1 + r) v), H the flow of the free oscillator. x1(0) = 1, x2(0) = -r v.
class ImpactingOrbit {
 public:
  ImpactingOrbit(double velocity, double omega, double zeta, double r, int periods = 1);
  State at(double time) const;
  double period() const;
  double alpha() const { return alpha_; }

 private:
  double omega_, zeta_;
  int periods_;
  double free_position_ = 0.0, free_velocity_ = 0.0;      // u(0), u'(0)
  double forced_position_ = 0.0, forced_velocity_ = 0.0;  // of the forced oscillation at time 0
  double alpha_ = 0.0, phase_ = 0.0;                      // forcing alpha cos(omega t + phase)
};

}  // namespace test_support
