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

#include <Eigen/Dense>
#include <cmath>
#include <complex>

#include "../hybrid/linear_oscillator.hpp"
#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

namespace tchat::test {

inline const HybridSystem& linosc() { return system_of<LinearOscillator>(); }

struct OscillatorConstants {
  double omega = 2.0, zeta = 0.05, r = 0.8;

  double period() const { return 2 * pi / omega; }
  std::complex<double> stiffness() const { return {1 - omega * omega, 2 * zeta * omega}; }

  /// E(t)
  Eigen::Matrix2d homogeneous(double t) const {
    const double wd = std::sqrt(1 - zeta * zeta);
    const double c = std::cos(wd * t), s = std::sin(wd * t);
    Eigen::Matrix2d e;
    e << c + zeta / wd * s, s / wd, -s / wd, c - zeta / wd * s;
    return std::exp(-zeta * t) * e;
  }
};

/// State at time t: (u, u') = E(t) u0 on top of the particular solution with phase theta0.
struct OscillatorOrbit {
  OscillatorConstants constants;
  double alpha = 0.0;
  double theta0 = 0.0;
  Eigen::Vector2d u0 = Eigen::Vector2d::Zero();

  Eigen::VectorXd state(double t) const {
    const double theta = theta0 + constants.omega * t;
    const std::complex<double> p = alpha * std::polar(1.0, theta) / constants.stiffness();
    const Eigen::Vector2d u = constants.homogeneous(t) * u0;
    Eigen::VectorXd x(4);
    x << u(0) + p.real(), u(1) - constants.omega * p.imag(), std::sin(theta), std::cos(theta);
    return x;
  }
  Piece piece(double from, double to) const {
    return {to - from, [copy = *this, from](double t) { return copy.state(from + t); }};
  }
  ParameterVector par() const { return parameters({alpha, constants.omega, constants.zeta, constants.r}); }
};

inline OscillatorOrbit nonimpacting_orbit(double omega, double alpha) {
  const OscillatorConstants constants{omega};
  return {constants, alpha, std::arg(constants.stiffness()), Eigen::Vector2d::Zero()};
}

inline OscillatorOrbit one_impact_orbit(double omega, double v) {
  const OscillatorConstants k{omega};
  const Eigen::Vector2d jump(0.0, (1 + k.r) * v);
  const Eigen::Vector2d u0 = (k.homogeneous(k.period()) - Eigen::Matrix2d::Identity()).partialPivLu().solve(jump);
  // alpha e^{i theta0} / D = P - i P' / omega
  const std::complex<double> z{1 - u0(0), (k.r * v + u0(1)) / omega};
  const std::complex<double> forcing = z * k.stiffness();
  return {k, std::abs(forcing), std::arg(forcing), u0};
}

/// Multipliers of the nonimpacting orbit: the homogeneous solution over T = 2 pi / omega, the limit cycle of y and the
/// structural 0.
inline std::vector<std::complex<double>> nonimpacting_multipliers(double omega) {
  const OscillatorConstants k{omega};
  const std::complex<double> mu =
      std::exp(-k.zeta * k.period()) * std::polar(1.0, std::sqrt(1 - k.zeta * k.zeta) * k.period());
  return {mu, std::conj(mu), std::exp(-2 * k.period()), 0.0};
}

/// Multipliers of the one-impact orbit. Perturbations (dx2, dtheta) on x1 = 1 after the impact become
/// E(T) ((0, dx2) - dP dtheta) + dP dtheta with dP = d(P, P')/dtheta just before the next one, which comes later by dx1
/// / -v; both components change by f = (x1', x2', omega) times that, and x2 then by the factor -r. Radial perturbations
/// of y decouple: exp(-2T).
inline std::vector<std::complex<double>> one_impact_multipliers(double omega, double v) {
  const OscillatorOrbit orbit = one_impact_orbit(omega, v);
  const OscillatorConstants& k = orbit.constants;
  const std::complex<double> p = orbit.alpha * std::polar(1.0, orbit.theta0) / k.stiffness();
  const Eigen::Vector2d dp(-p.imag(), -k.omega * p.real());
  const Eigen::Matrix2d e = k.homogeneous(k.period());
  Eigen::Matrix<double, 3, 2> before;  // (x1, x2, theta) by (x2, theta)
  before.topRows(2) << e.col(1), dp - e * dp;
  before.row(2) << 0.0, 1.0;
  const double acceleration = orbit.alpha * std::cos(orbit.theta0) - 2 * k.zeta * v - 1.0;
  const Eigen::RowVector2d delay = -before.row(0) / v;
  Eigen::Matrix2d map;
  map.row(0) = -k.r * (before.row(1) + acceleration * delay);
  map.row(1) = before.row(2) + k.omega * delay;
  const Eigen::Vector2cd nontrivial = map.eigenvalues();
  return {nontrivial(0), nontrivial(1), std::exp(-2 * k.period()), 0.0};
}

}  // namespace tchat::test
