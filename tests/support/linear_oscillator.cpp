#include "support/linear_oscillator.hpp"

#include <Eigen/LU>
#include <cmath>

#include "../model/linear_oscillator.hpp"

namespace tchat::test {

const HybridSystem& linosc() { return system_of<LinearOscillator>(); }

Eigen::Matrix2d OscillatorConstants::homogeneous(double t) const {
  const double wd = std::sqrt(1 - zeta * zeta);
  const double c = std::cos(wd * t), s = std::sin(wd * t);
  Eigen::Matrix2d e;
  e << c + zeta / wd * s, s / wd, -s / wd, c - zeta / wd * s;
  return std::exp(-zeta * t) * e;
}

Eigen::VectorXd OscillatorOrbit::state(double t) const {
  const double theta = theta0 + constants.omega * t;
  const std::complex<double> p = alpha * std::polar(1.0, theta) / constants.stiffness();
  const Eigen::Vector2d u = constants.homogeneous(t) * u0;
  Eigen::VectorXd x(4);
  x << u(0) + p.real(), u(1) - constants.omega * p.imag(), std::sin(theta), std::cos(theta);
  return x;
}

Piece OscillatorOrbit::piece(double from, double to) const {
  return {to - from, [copy = *this, from](double t) { return copy.state(from + t); }};
}

OscillatorOrbit nonimpacting_orbit(double omega, double alpha) {
  const OscillatorConstants constants{omega};
  return {constants, alpha, std::arg(constants.stiffness()), Eigen::Vector2d::Zero()};
}

OscillatorOrbit one_impact_orbit(double omega, double v) {
  const OscillatorConstants k{omega};
  const Eigen::Vector2d jump(0.0, (1 + k.r) * v);
  const Eigen::Vector2d u0 = (k.homogeneous(k.period()) - Eigen::Matrix2d::Identity()).partialPivLu().solve(jump);
  // alpha e^{i theta0} / D = P - i P' / omega
  const std::complex<double> z{1 - u0(0), (k.r * v + u0(1)) / omega};
  const std::complex<double> forcing = z * k.stiffness();
  return {k, std::abs(forcing), std::arg(forcing), u0};
}

std::vector<std::complex<double>> nonimpacting_multipliers(double omega) {
  const OscillatorConstants k{omega};
  const std::complex<double> mu =
      std::exp(-k.zeta * k.period()) * std::polar(1.0, std::sqrt(1 - k.zeta * k.zeta) * k.period());
  return {mu, std::conj(mu), std::exp(-2 * k.period()), 0.0};
}

std::vector<std::complex<double>> one_impact_multipliers(double omega, double v) {
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
  const double half = 0.5 * map.trace();
  const std::complex<double> root = std::sqrt(std::complex<double>(half * half - map.determinant()));
  return {half + root, half - root, std::exp(-2 * k.period()), 0.0};
}

}  // namespace tchat::test
