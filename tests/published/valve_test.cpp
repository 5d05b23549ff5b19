// A pressure relief valve, as problems/valve/Makefile runs it, against impacts one by one with 19 digits.
//
// At rest pressure = lift + delta and q = lift sqrt(pressure). With g = beta lift / (2 sqrt(pressure)) the
// characteristic polynomial is z^3 + (kappa + g) z^2 + (kappa g + 1) z + g + beta sqrt(pressure): oscillations begin
// where (kappa + g) (kappa g + 1) = g + beta sqrt(pressure).
#include <catch2/catch.hpp>
#include <cmath>

#include "published/makefile_run.hpp"
#include "published/newton.hpp"
#include "support/valve_flight.hpp"

using namespace test_support;

namespace {

/// The zero of a function that changes sign once.
template <class IsBelow>
double border(double low, double high, IsBelow is_below) {
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (is_below(middle) ? low : high) = middle;
  }
  return low;
}

double flow_at_hopf() {
  const double kappa = 1.25, beta = 20.0, delta = 10.0;
  const double lift = border(1.0, 5.0, [&](double y) {
    const double root = std::sqrt(y + delta), g = beta * y / (2.0 * root);
    return (kappa + g) * (kappa * g + 1.0) < g + beta * root;
  });
  return lift * std::sqrt(lift + delta);
}

/// From after an impact to after the next one: speed, pressure.
Eigen::Vector2d impact_map(const Eigen::Vector2d& z, double q) {
  ValveFlight flight(q, 0.8);
  flight.speed = z(0);
  flight.pressure = z(1);
  flight.fly();
  flight.hit();
  return {static_cast<double>(flight.speed), static_cast<double>(flight.pressure)};
}

/// Where the period of one impact doubles, from nearby: speed, pressure, q.
Eigen::VectorXd doubling(Eigen::VectorXd z) {
  return newton(std::move(z), 1e-6, [](const Eigen::VectorXd& at) {
    constexpr double step = 1e-3;
    const Eigen::Vector2d x = at.head(2);
    Eigen::Matrix2d map;
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector2d d = step * Eigen::Vector2d::Unit(k);
      const auto difference = [&](double n) {
        return Eigen::Vector2d(impact_map(x + n * d, at(2)) - impact_map(x - n * d, at(2)));
      };
      map.col(k) = (8.0 * difference(1.0) - difference(2.0)) / (12.0 * step);
    }
    Eigen::VectorXd defect(3);
    defect << impact_map(x, at(2)) - x, (map + Eigen::Matrix2d::Identity()).determinant();
    return defect;
  });
}

}  // namespace

TEST_CASE("make -j2 in problems/valve: from rest over impacts to infinitely many of them") {
  const MakefileRun chain("valve", "branches");
  chain.check_verified();
  check_near(chain.only("rest", "HB").parameter(1), flow_at_hopf());

  const SolutionEntry doubled = chain.solution("impacting", "PD");
  Eigen::VectorXd start(3);  // the second segment begins after the impact
  start << doubled.states.front()[4], doubled.states.front()[5], doubled.parameter(1);
  check_near(doubled.parameter(1), doubling(start)(2), 1e-8);

  const auto last_at_rest = [](double r, double low, double high) {
    return border(low, high, [r](double q) { return ValveFlight::rests(q, r); });
  };
  check_near(chain.only("chatter", "GR").parameter(1), last_at_rest(0.5, 0.3, 0.6), 1e-8);
  check_near(chain.solution("border", "UZ", 1).parameter(1), last_at_rest(0.7, 0.05, 0.4), 1e-8);
  check_near(chain.solution("border", "UZ", 2).parameter(1), last_at_rest(0.3, 0.5, 0.9), 1e-8);
}
