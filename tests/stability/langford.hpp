/// The class of problems/langford/langford.cpp, compiled into a test instead of registered as a plugin, and its closed
/// forms for f = 0: the orbit is a circle of radius r in the plane z = b, its multipliers are exp(2 pi lambda / d) with
/// the eigenvalues lambda of
///
///     d(r', z') / d(r, z) = (0, r; -2 r (1 + e b), a - b^2 - e r^2).
#pragma once

#include <tchat/problem.hpp>

#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

#pragma push_macro("TCHAT_PROBLEM")
#undef TCHAT_PROBLEM
#define TCHAT_PROBLEM(PROBLEM) static_assert(PROBLEM::dimension == 3);
#include "../../problems/langford/langford.cpp"
#pragma pop_macro("TCHAT_PROBLEM")

namespace tchat::test {

struct LangfordCircle {
  double a = 0.5, b = 0.7, c = 0.6, d = 3.5, e = 0.25;

  double radius_squared() const { return (c + a * b - b * b * b / 3) / (1 + e * b); }
  double period() const { return 2 * pi / d; }
  /// Trace of the linearisation in (r, z): zero at the torus bifurcation, d(ln |mu|^2) = its change times the period.
  double trace() const { return a - b * b - e * radius_squared(); }
  double determinant() const { return 2 * radius_squared() * (1 + e * b); }
  std::complex<double> multiplier() const {
    const std::complex<double> lambda{0.5 * trace(), std::sqrt(determinant() - 0.25 * trace() * trace())};
    return std::exp(lambda * period());
  }
  /// The a of the torus bifurcation: trace() is linear in a.
  LangfordCircle at_torus() const {
    LangfordCircle result = *this;
    result.a = 0.0;
    const double constant = result.trace();
    result.a = 1.0;
    result.a = -constant / (result.trace() - constant);
    return result;
  }
  Orbit orbit(int intervals, int collocation) const {
    const auto state = [copy = *this](double t) {
      const double r = std::sqrt(copy.radius_squared());
      Eigen::VectorXd u(3);
      u << -r * std::cos(copy.d * t), -r * std::sin(copy.d * t), copy.b;
      return u;
    };
    return sampled_orbit({{period(), state}}, 3, intervals, collocation, test::parameters({a, b, c, d, e, 0.0}));
  }
};

}  // namespace tchat::test
