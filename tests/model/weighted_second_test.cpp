#include "model/function_values.hpp"

#include <Eigen/Core>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <stdexcept>

#include "hand_differentiated.hpp"
#include "model/parameter_vector.hpp"

using namespace tchat;
using Eigen::VectorXd;

namespace {

/// Any numbers without pattern.
double any(int k) { return std::sin(1.3 + 0.9 * k + 0.01 * k * k); }

ParameterVector parameters(const std::vector<double>& first) {
  ParameterVector par{ParameterLayout()};
  for (std::size_t k = 0; k < first.size(); ++k) par(static_cast<Eigen::Index>(k)) = first[k];
  return par;
}

void put(const VectorXd& from, double* to) { std::copy(from.begin(), from.end(), to); }

/// Directions and weights at `points` points, some states of which are negative.
WeightedSecond make(const HybridSystem& system, FunctionKind kind, const std::vector<int>& active, int points,
                    int directions) {
  WeightedSecond result(system, kind, active, points, directions);
  const int n = system.dimension(), r = system.rows(kind), q = static_cast<int>(active.size());
  int number = 0;
  for (int k = 0; k < directions; ++k)
    for (int g = 0; g < q; ++g) result.parameter_direction(k)[g] = any(++number);
  for (int i = 0; i < points; ++i) {
    for (int a = 0; a < n; ++a) result.point(i)[a] = any(++number) + (a == 2 ? 1.5 : 0.0);
    for (int k = 0; k < directions; ++k)
      for (int a = 0; a < n; ++a) result.direction(i, k)[a] = any(++number);
    for (int k = 0; k <= directions; ++k)
      for (int a = 0; a < r; ++a) result.weights(i, k)[a] = any(++number);
  }
  return result;
}

/// Relative to 1 + the size of what is expected.
double error(const double* found, const VectorXd& expected) {
  const Eigen::Map<const VectorXd> values(found, expected.size());
  return (values - expected).lpNorm<Eigen::Infinity>() / (1.0 + expected.lpNorm<Eigen::Infinity>());
}

using ExactFunctions = std::vector<Exact (*)(const Point7&)>;

/// From gradients and Hessians worked out by hand.
void check_nonlinear(const HybridSystem& system, FunctionKind kind, const ExactFunctions& exact,
                     const std::vector<int>& active, int directions, double tolerance) {
  constexpr int points = 3;
  const ParameterVector par = parameters({0.8, -1.1, 0.6, 1.7});
  WeightedSecond sums = make(system, kind, active, points, directions);
  sums.compute(1, points, par.data());
  const int q = static_cast<int>(active.size());
  for (int i = 0; i < points; ++i) {
    INFO(directions << " directions, point " << i);
    Point7 z;
    z << Eigen::Map<const Eigen::Vector3d>(sums.point(i)), par.head(4);
    VectorXd gradient = VectorXd::Zero(3 + q);
    std::vector<VectorXd> directional(static_cast<std::size_t>(directions), VectorXd(std::ssize(exact)));
    for (std::size_t a = 0; a < exact.size(); ++a) {
      const Exact f = exact[a](z);
      const auto add = [&](const Point7& by, double weight) {
        gradient.head(3) += weight * by.head(3);
        for (int g = 0; g < q; ++g) gradient(3 + g) += weight * by(2 + active[static_cast<std::size_t>(g)]);
      };
      add(f.gradient, sums.value_weights(i)[a]);
      for (int k = 0; k < directions; ++k) {
        Point7 along = Point7::Zero();
        along.head(3) = Eigen::Map<const Eigen::Vector3d>(sums.direction(i, k));
        for (int g = 0; g < q; ++g) along(2 + active[static_cast<std::size_t>(g)]) = sums.parameter_direction(k)[g];
        add(f.hessian * along, sums.weights(i, k)[a]);
        directional[static_cast<std::size_t>(k)](static_cast<Eigen::Index>(a)) = f.gradient.dot(along);
      }
    }
    CHECK(error(sums.gradient(i), gradient) < tolerance);
    for (int k = 0; k < directions; ++k)
      CHECK(error(sums.directional(i, k), directional[static_cast<std::size_t>(k)]) < tolerance);
  }
}

const tchat_problem& nonlinear_table() { return *ProblemTable<NonlinearProblem>::get("nonlinear"); }
const ExactFunctions exact_field = {exact_field_1, exact_field_2, exact_field_3};

/// More states than derivatives are carried at once.
struct LongChain {
  static constexpr int dimension = 19, parameters = 3, fields = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    for (int i = 0; i < 19; ++i) f[i] = x[i] * x[(i + 1) % 19] * p[0] + sin(x[i]) * p[1];
  }
};

struct Partly {
  static constexpr int dimension = 2, parameters = 1, fields = 2;
  template <class T>
  void field(int i, const T* x, const T* p, T* f) const {
    f[0] = x[0] * p[0];
    if (i == 1) f[1] = x[0] * x[1];
    if (i == 2 && x[0] > 0.0) throw std::domain_error("not there");
    if (i == 2) f[1] = x[1];
  }
};

struct Unset {
  static constexpr int dimension = 2, parameters = 1, fields = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = x[0] * p[0];
    if (x[1] < 0.0) f[1] = x[1] * x[1];
  }
};

}  // namespace

TEST_CASE("weighted second derivatives at many points agree with hand-written ones") {
  const HybridSystem system(nonlinear_table());
  REQUIRE(system.table().second_at_points != nullptr);
  constexpr double rounding = 1e-13;
  for (const int directions : {1, 2, 3}) {
    check_nonlinear(system, FunctionKind::field, exact_field, {1, 2}, directions, rounding);
    check_nonlinear(system, FunctionKind::field, exact_field, {4, 3, 1, 2}, directions, rounding);
    check_nonlinear(system, FunctionKind::field, exact_field, {}, directions, rounding);
    check_nonlinear(system, FunctionKind::event, {exact_event}, {3, 1}, directions, rounding);
    check_nonlinear(system, FunctionKind::jump, {exact_jump_1, exact_jump_2, exact_jump_3}, {2}, directions, rounding);
  }
}

TEST_CASE("weighted second derivatives where the table has none for many points, of lower order too") {
  // Differences of differences are that good.
  constexpr std::array tolerances = {1e-5, 1e-8, 1e-13};
  for (const int order : {2, 1, 0}) {
    INFO("order " << order);
    tchat_problem table = nonlinear_table();
    table.derivative_order = order;
    if (order == 2) table.second_at_points = nullptr;  // else it is not asked, though it is there
    const HybridSystem system(table);
    for (const int directions : {1, 2})
      check_nonlinear(system, FunctionKind::field, exact_field, {1, 4}, directions,
                      tolerances[static_cast<std::size_t>(order)]);
  }
}

TEST_CASE("weighted second derivatives of more states than are carried at once") {
  constexpr int n = 19, points = 2, directions = 2;
  const HybridSystem system(*ProblemTable<LongChain>::get("chain"));
  const ParameterVector par = parameters({0.7, -1.3, 0.4});
  WeightedSecond sums = make(system, FunctionKind::field, {2, 3, 1}, points, directions);
  sums.compute(1, points, par.data());
  for (int i = 0; i < points; ++i) {
    const double* const x = sums.point(i);
    VectorXd gradient = VectorXd::Zero(n + 3);
    for (int k = 0; k <= directions; ++k) {
      const double* const w = sums.weights(i, k);
      VectorXd d(n);
      for (int a = 0; a < n; ++a) {
        const int b = (a + 1) % n;
        const double s = std::sin(x[a]), c = std::cos(x[a]);
        if (k == directions) {
          gradient(a) += w[a] * (x[b] * par[0] + c * par[1]);
          gradient(b) += w[a] * x[a] * par[0];
          gradient(n) += w[a] * s;
          gradient(n + 2) += w[a] * x[a] * x[b];
          continue;
        }
        const double* const v = sums.direction(i, k);
        const double q0 = sums.parameter_direction(k)[2], q1 = sums.parameter_direction(k)[0];
        d(a) = par[0] * (x[b] * v[a] + x[a] * v[b]) + par[1] * c * v[a] + x[a] * x[b] * q0 + s * q1;
        gradient(a) += w[a] * (par[0] * v[b] - par[1] * s * v[a] + x[b] * q0 + c * q1);
        gradient(b) += w[a] * (par[0] * v[a] + x[a] * q0);
        gradient(n) += w[a] * c * v[a];
        gradient(n + 2) += w[a] * (x[b] * v[a] + x[a] * v[b]);
      }
      if (k < directions) CHECK(error(sums.directional(i, k), d) < 1e-13);
    }
    CHECK(error(sums.gradient(i), gradient) < 1e-13);
  }
}

TEST_CASE("weighted second derivatives: a point that cannot be evaluated leaves the others alone") {
  const ParameterVector par = parameters({2.0});
  const auto check = [&](const HybridSystem& system, int field, double good, double bad) {
    WeightedSecond sums = make(system, FunctionKind::field, {1}, 3, 1);
    for (int i = 0; i < 3; ++i) put(Eigen::Vector2d::Constant(i == 1 ? bad : good), sums.point(i));
    sums.compute(field, 3, par.data());
    for (int i = 0; i < 3; ++i) {
      INFO("point " << i);
      for (int c = 0; c < 3; ++c) CHECK(std::isnan(sums.gradient(i)[c]) == (i == 1));
      CHECK(std::isnan(sums.directional(i, 0)[1]) == (i == 1));
    }
  };
  check(HybridSystem(*ProblemTable<Partly>::get("partly")), 2, -1.0, 1.0);
  check(HybridSystem(*ProblemTable<Unset>::get("unset")), 1, -1.0, 1.0);
}

TEST_CASE("weighted second derivatives of the identity jump, which no problem sees") {
  const HybridSystem system(nonlinear_table());
  WeightedSecond sums = make(system, FunctionKind::jump, {1}, 1, 1);
  sums.compute(no_function, 1, parameters({1.0}).data());
  for (int a = 0; a < 3; ++a) {
    CHECK(sums.gradient(0)[a] == sums.value_weights(0)[a]);
    CHECK(sums.directional(0, 0)[a] == sums.direction(0, 0)[a]);
  }
  CHECK(sums.gradient(0)[3] == 0.0);
}
