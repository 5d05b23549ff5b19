/// Closed forms of the linear impact oscillator (problems/linosc),
///
///     q'' + 2 zeta q' + q = alpha cos(theta),  theta' = omega,  q <= 1,  velocity -> -r velocity at q = 1.
///
/// With D = 1 - omega^2 + 2 i zeta omega the particular solution is P(theta) = alpha Re(e^{i theta} / D). Solutions of
/// q'' + 2 zeta q' + q = 0 are (q, q')(t) = E(t) (q, q')(0).
///
/// Nonimpacting orbit: q = P, amplitude alpha / |D|. It starts at its maximum, where theta = arg D.
///
/// One-impact orbit of period T = 2 pi / omega and impact velocity v. Between impacts q = P + u with a homogeneous
/// solution u. As P is T-periodic, q(0) = q(T) = 1, q'(0) = -r v, q'(T) = v say
///     (E(T) - Id) (u, u')(0) = (0, (1 + r) v)            hence u,
///     P(theta0) = 1 - u(0),   P'(theta0) = -r v - u'(0)   hence alpha and theta0.
/// v = 0 is the grazing orbit, v < 0 gives solutions of the boundary value problem that are no orbits.
#pragma once

#include <Eigen/Core>
#include <complex>

#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

namespace tchat::test {

const HybridSystem& linosc();

struct OscillatorConstants {
  double omega = 2.0, zeta = 0.05, r = 0.8;

  double period() const { return 2 * pi / omega; }
  std::complex<double> stiffness() const { return {1 - omega * omega, 2 * zeta * omega}; }
  /// E(t)
  Eigen::Matrix2d homogeneous(double t) const;
};

/// State at time t: (u, u') = E(t) u0 on top of the particular solution with phase theta0.
struct OscillatorOrbit {
  OscillatorConstants constants;
  double alpha = 0.0;
  double theta0 = 0.0;
  Eigen::Vector2d u0 = Eigen::Vector2d::Zero();

  Eigen::VectorXd state(double t) const;
  Piece piece(double from, double to) const;
  ParameterVector par() const { return parameters({alpha, constants.omega, constants.zeta, constants.r}); }
};

OscillatorOrbit nonimpacting_orbit(double omega, double alpha);
OscillatorOrbit one_impact_orbit(double omega, double v);

/// Multipliers of the nonimpacting orbit: the homogeneous solution over T = 2 pi / omega, the limit cycle of y and the
/// structural 0.
std::vector<std::complex<double>> nonimpacting_multipliers(double omega);

/// Multipliers of the one-impact orbit. Perturbations (dx2, dtheta) on x1 = 1 after the impact become
/// E(T) ((0, dx2) - dP dtheta) + dP dtheta with dP = d(P, P')/dtheta just before the next one, which comes later by dx1
/// / -v; both components change by f = (x1', x2', omega) times that, and x2 then by the factor -r. Radial perturbations
/// of y decouple: exp(-2T).
std::vector<std::complex<double>> one_impact_multipliers(double omega, double v);

}  // namespace tchat::test
