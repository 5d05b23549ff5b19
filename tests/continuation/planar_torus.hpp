/// The torus of problems/torus in closed form, as a problem of the tests: its orbits, and what solves for them.
#pragma once

#include <cmath>

#include "../../problems/torus/torus.cpp"
#include "continuation/path_follower.hpp"
#include "orbit/torus_system.hpp"
#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

namespace tchat::test {

inline const double golden = 0.5 * (1.0 + std::sqrt(5.0));
inline constexpr int omega = 1, wall = 3;  // PAR

inline double radius(double psi, double w) { return (1.0 + w * w) / (1.0 + w * w - std::cos(psi) - w * std::sin(psi)); }

/// The state at the time t after the crossing of the section at the phase psi of the forcing.
inline Eigen::Vector4d state_at(double psi, double t, double w) {
  const double now = psi + w * t;
  const double angle = pi + golden * t;
  return {radius(now, w) * std::cos(angle), radius(now, w) * std::sin(angle), std::sin(now), std::cos(now)};
}

struct Torus {
  Torus(int orbits, const OrbitShape& one_return, std::vector<int> free = {omega, ParameterLayout().rotation()})
      : system(system_of<PlanarTorus>(), {{1, 1, 1}}, orbits, std::move(free)),
        shape{4, orbits, one_return.intervals, one_return.collocation},
        follower(system, shape, WeightedNorm::unit(shape), {12, 12, 1e-12, 1e-12}, omega) {}

  /// The closed form, moved off by waves of this size.
  Orbit start(double w, double off) const {
    Orbit x{shape, uniform_mesh(shape.intervals), Eigen::MatrixXd(4, shape.columns()),
            ParameterVector(ParameterLayout())};
    x.par(0) = w, x.par(1) = golden, x.par(2) = 5.0;
    x.par.rotation() = w / golden - std::floor(w / golden);
    for (int i = 0; i < shape.segments; ++i) {
      x.duration(i) = 2.0 * pi / golden;
      for (int k = 0; k < shape.nodes(); ++k) {
        x.states.col(i * shape.nodes() + k) = state_at(2.0 * pi * i / shape.segments, x.tau(k) * x.duration(i), w);
        x.states.col(i * shape.nodes() + k) *= 1.0 + off * std::sin(1.0 + i + 0.3 * k);
      }
    }
    return x;
  }
  PathPoint solved(double w, double off = 1e-3) {
    PathPoint point = follower.make_point(start(w, off));
    result = follower.start_at_fixed_parameter(point);
    return point;
  }
  /// Largest distance of the curve on the section from the closed form, at phases that are none of the N too.
  double error(const Orbit& x, double w) const {
    double largest = 0.0;
    for (int k = 0; k < 200; ++k) {
      const Eigen::Vector4d u = section_curve(system, x) * interpolation_weights(shape.segments, k / 200.0).transpose();
      largest = std::max(largest, (u - state_at(std::atan2(u(2), u(3)), 0.0, w)).cwiseAbs().maxCoeff());
    }
    return largest;
  }

  TorusSystem system;
  OrbitShape shape;
  PathFollower follower;
  NewtonResult result;
};

}  // namespace tchat::test
