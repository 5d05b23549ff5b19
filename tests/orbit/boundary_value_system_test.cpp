// Conditions of a problem's own, on two segments with one duration that is free: derivatives of the conditions against
// finite differences, and the bordered Newton matrix against the residual.
#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "directional_derivative.hpp"
#include "model/derivative_check.hpp"
#include "orbit/bordered_problem.hpp"
#include "orbit/boundary_value_system.hpp"
#include "support/test_system.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

/// Every condition couples several ends, durations and parameters, none of them linearly.
struct Coupled {
  static constexpr int dimension = 2, parameters = 3, fields = 2;
  template <class T>
  void field(int i, const T* x, const T* par, T* f) const {
    f[0] = x[1] * par[0];
    f[1] = (i == 1 ? sin(x[0]) : x[0] * x[1]) - par[1];
  }
  static constexpr int boundary_conditions = 4;
  template <class T>
  void boundary(const Ends<T>& x, const T* par, T* b) const {
    b[0] = x.start(1)[0] * x.end(2)[1] - par[0];
    b[1] = x.end(1)[0] * x.end(1)[0] - x.start(2)[1] * x.duration(1);
    b[2] = exp(x.start(2)[0]) + x.duration(1) * x.duration(2) * par[2];
    b[3] = x.start(1)[1] - cos(x.end(2)[0]) * par[1];
  }
  static constexpr int integral_conditions = 3;  // more than states
  template <class T>
  void integrand(int s, const T* x, const T* par, const T* durations, T* q) const {
    q[0] = x[0] * x[1] - par[2] / (durations[0] + 2.0 * durations[1]);
    q[1] = s == 1 ? x[0] * x[0] * par[1] : x[1];
    q[2] = sin(x[0] + par[0]);
  }
};

/// x' = 1 with the integral of x^2.
struct Quadratic {
  static constexpr int dimension = 1, parameters = 0, fields = 1, boundary_conditions = 1, integral_conditions = 1;
  template <class T>
  void field(int, const T*, const T*, T* f) const {
    f[0] = 1.0;
  }
  template <class T>
  void boundary(const Ends<T>& x, const T*, T* b) const {
    b[0] = x.start(1)[0];
  }
  template <class T>
  void integrand(int, const T* x, const T*, T* q) const {
    q[0] = x[0] * x[0];
  }
};

/// The same without derivatives of its own.
const HybridSystem& undifferentiated() {
  static const tchat_problem table = [] {
    tchat_problem plain = *ProblemTable<Coupled>::get("coupled");
    plain.derivative_order = 0;
    plain.boundary_first = nullptr;
    return plain;
  }();
  static const HybridSystem system(table);
  return system;
}

Orbit any_orbit(const OrbitShape& shape) {
  Orbit x{shape, uniform_mesh(shape.intervals), Eigen::MatrixXd(shape.dimension, shape.columns()),
          ParameterVector(ParameterLayout())};
  for (std::size_t j = 1; j + 1 < x.mesh.size(); ++j) x.mesh[j] = std::pow(x.mesh[j], 1.3);
  for (Eigen::Index k = 0; k < x.states.cols(); ++k)
    for (Eigen::Index i = 0; i < x.states.rows(); ++i)
      x.states(i, k) = std::sin(0.3 + 0.9 * static_cast<double>(i) + 0.11 * static_cast<double>(k));
  x.par.head(3) << 0.7, 0.4, 1.2;
  x.duration(0) = 0.9, x.duration(1) = 1.3;
  return x;
}

/// n m + d + q = 4 + 1 + 3 = 4 + 3 + 1.
BoundaryValueSystem make_system(const HybridSystem& system) {
  return {system, {{1, 0, 0}, {2, 0, 0}}, {1, 3, 2}, {true, false}};
}

std::vector<double> all_of(const OrbitResidual& r) {
  std::vector<double> all = r.collocation;
  all.insert(all.end(), r.coupling.begin(), r.coupling.end());
  all.insert(all.end(), r.integral.begin(), r.integral.end());
  return all;
}

}  // namespace

TEST_CASE("derivatives of boundary conditions are those of differences, automatic ones and missing ones") {
  const Eigen::VectorXd par = any_orbit({2, 2, 1, 2}).par;
  const BoundaryCheck check = check_boundary(system_of<Coupled>(), 2, par, 1);
  CHECK(check.faults.empty());
  CHECK(check.error < 1e-9);  // of the differences, of sixth order
  // On one segment they ask for an end that is not there.
  const BoundaryCheck short_orbit = check_boundary(system_of<Coupled>(), 1, par, 1);
  REQUIRE_FALSE(short_orbit.faults.empty());
  CHECK(short_orbit.faults.front().find("GCNOSEG") != std::string::npos);
}

TEST_CASE("Newton's step of a boundary value problem with integrals: the residual falls quadratically") {
  const bool automatic = GENERATE(true, false);
  CAPTURE(automatic);
  const HybridSystem& hybrid = automatic ? system_of<Coupled>() : undifferentiated();
  const BoundaryValueSystem system = make_system(hybrid);
  const OrbitShape shape{2, 2, GENERATE(1, 6), 3};
  BorderedProblem problem(system, shape, nullptr);
  CondensedSystem& condensed = problem.condensed();
  // The solution of J dx = -F for the residual that a known displacement makes, to first order, is its opposite.
  const Orbit x = any_orbit(shape);
  const OrbitVector row = random_vector(condensed, 3);
  OrbitVector v = random_vector(condensed, 4);
  v.durations(1) = 0.0;  // kept
  OrbitResidual here = condensed.make_residual(), there = here;
  problem.evaluate(x, here);
  REQUIRE(here.integral.size() == 3);
  const auto miss_after = [&](double h) {
    Orbit moved = x;
    advance(moved, h, v, system.free_parameters());
    REQUIRE(problem.linearize(moved, row, there) == Linearization::ready);
    OrbitResidual difference = there;
    for (std::size_t i = 0; i < there.collocation.size(); ++i) difference.collocation[i] -= here.collocation[i];
    for (std::size_t i = 0; i < there.coupling.size(); ++i) difference.coupling[i] -= here.coupling[i];
    for (std::size_t i = 0; i < there.integral.size(); ++i) difference.integral[i] -= here.integral[i];
    OrbitVector back = condensed.make_vector();
    problem.solve(difference, row, -h * dot(row, v), back);
    advance(moved, 1.0, back, system.free_parameters());
    problem.evaluate(moved, there);
    double largest = 0.0;
    const std::vector<double> reached = all_of(there), wanted = all_of(here);
    for (std::size_t i = 0; i < reached.size(); ++i) largest = std::max(largest, std::abs(reached[i] - wanted[i]));
    CHECK(moved.duration(1) == x.duration(1));
    return largest;
  };
  const double coarse = miss_after(2e-3), fine = miss_after(1e-3);
  CAPTURE(coarse, fine);
  CHECK(fine < 1e-3);
  CHECK(coarse / fine > 3.3);  // 4 for a right matrix, 2 for a wrong one
}

TEST_CASE("integral conditions: exact for polynomials, in time and not in tau") {
  const BoundaryValueSystem system(system_of<Quadratic>(), {{1, 0, 0}}, {}, {true});
  Orbit x{{1, 1, 3, 2}, {0.0, 0.2, 0.5, 1.0}, Eigen::MatrixXd(1, 7), ParameterVector(ParameterLayout())};
  x.duration(0) = 3.0;
  const std::vector<double> tau = x.node_times();
  for (Eigen::Index k = 0; k < 7; ++k) x.states(0, k) = 3.0 * tau[static_cast<std::size_t>(k)];  // x = t
  double value = 0.0;
  system.integral_values(x, x, CollocationRule(2), &value);
  CHECK(value == Approx(9.0).epsilon(1e-14));  // of t^2 from 0 to 3
}
