#include "end_to_end/closed_forms.hpp"

#include <Eigen/LU>
#include <cmath>

namespace test_support {

namespace {

/// The flow over `time` of u'' + 2 zeta u' + u = 0 on (u, u').
Eigen::Matrix2d free_flow(double zeta, double time) {
  const double frequency = std::sqrt(1.0 - zeta * zeta);
  const double c = std::cos(frequency * time);
  const double s = std::sin(frequency * time) / frequency;
  Eigen::Matrix2d flow;
  flow << c + zeta * s, s, -s, c - zeta * s;
  return std::exp(-zeta * time) * flow;
}

}  // namespace

double amplitude(double alpha, double omega, double zeta) {
  return alpha / std::hypot(1.0 - omega * omega, 2.0 * zeta * omega);
}

NonimpactingOrbit::NonimpactingOrbit(double alpha, double omega, double zeta)
    : omega_(omega),
      amplitude_(amplitude(alpha, omega, zeta)),
      phase_(std::atan2(2.0 * zeta * omega, 1.0 - omega * omega)) {}

State NonimpactingOrbit::at(double time) const {
  const double angle = omega_ * time;
  return {amplitude_ * std::cos(angle), -amplitude_ * omega_ * std::sin(angle), std::sin(angle + phase_),
          std::cos(angle + phase_)};
}

double NonimpactingOrbit::period() const { return 2.0 * M_PI / omega_; }

double NonimpactingOrbit::l2_norm() const {
  return std::sqrt(amplitude_ * amplitude_ * (1.0 + omega_ * omega_) / 2.0 + 1.0);
}

ImpactingOrbit::ImpactingOrbit(double velocity, double omega, double zeta, double r, int periods)
    : omega_(omega), zeta_(zeta), periods_(periods) {
  const Eigen::Matrix2d closing = free_flow(zeta, period()) - Eigen::Matrix2d::Identity();
  const Eigen::Vector2d free = closing.partialPivLu().solve(Eigen::Vector2d(0.0, (1.0 + r) * velocity));
  free_position_ = free(0);
  free_velocity_ = free(1);
  forced_position_ = 1.0 - free(0);
  forced_velocity_ = -r * velocity - free(1);
  // Forced oscillation C cos(omega t) + D sin(omega t); its forcing by substitution.
  const double cosine = forced_position_;
  const double sine = forced_velocity_ / omega;
  const double in_phase = (1.0 - omega * omega) * cosine + 2.0 * zeta * omega * sine;
  const double in_quadrature = (1.0 - omega * omega) * sine - 2.0 * zeta * omega * cosine;
  alpha_ = std::hypot(in_phase, in_quadrature);
  phase_ = std::atan2(-in_quadrature, in_phase);
}

State ImpactingOrbit::at(double time) const {
  const Eigen::Vector2d free = free_flow(zeta_, time) * Eigen::Vector2d(free_position_, free_velocity_);
  const double c = std::cos(omega_ * time);
  const double s = std::sin(omega_ * time);
  return {free(0) + forced_position_ * c + forced_velocity_ / omega_ * s,
          free(1) - forced_position_ * omega_ * s + forced_velocity_ * c, std::sin(omega_ * time + phase_),
          std::cos(omega_ * time + phase_)};
}

double ImpactingOrbit::period() const { return 2.0 * M_PI * periods_ / omega_; }

}  // namespace test_support
