// Sums over arrays against Eigen's in long double, for each set of instructions, and equal bits between them.
#include <Eigen/Core>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "linear_algebra/array_kernel.hpp"

using namespace tchat;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using LongVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

namespace {

// Of sums of a few hundred products of numbers below 1: terms times the unit of rounding, generously.
constexpr double rounding = 1e-13;

LongVector exact(const VectorXd& v) { return v.cast<long double>(); }

double error(double value, long double wanted) { return std::abs(static_cast<double>(value - wanted)); }

/// Whatever a set of instructions makes of these arrays.
std::vector<double> results(const ArrayFunctions& f, const VectorXd& a, const VectorXd& b, const VectorXd& c) {
  const long count = a.size();
  VectorXd sum = c;
  f.add(0.3, a.data(), sum.data(), count);
  VectorXd combined(count);
  const std::array<const double*, 3> arrays{a.data(), b.data(), c.data()};
  const std::array<double, 3> weights{0.7, -1.3, 0.1};
  f.combine(arrays.data(), weights.data(), 3, combined.data(), count);
  std::vector<double> all{f.dot(a.data(), b.data(), count), f.dot_difference(a.data(), b.data(), c.data(), count),
                          f.range(a.data(), count).largest};
  all.insert(all.end(), sum.begin(), sum.end());
  all.insert(all.end(), combined.begin(), combined.end());
  return all;
}

}  // namespace

TEST_CASE("array kernel: sums of any length") {
  for (const VectorSet set : available_vector_sets()) {
    const ArrayFunctions& f = array_functions(set);
    for (const long count : {0L, 1L, 3L, 4L, 7L, 8L, 15L, 16L, 17L, 33L, 200L, 803L}) {
      CAPTURE(static_cast<int>(set), count);
      const VectorXd a = VectorXd::Random(count), b = VectorXd::Random(count), c = VectorXd::Random(count);
      const std::vector<double> found = results(f, a, b, c);
      CHECK(error(found[0], exact(a).dot(exact(b))) < rounding);
      CHECK(error(found[1], exact(a).dot(exact(b) - exact(c))) < rounding);
      CHECK(found[2] == (count > 0 ? a.cwiseAbs().maxCoeff() : 0.0));
      for (long i = 0; i < count; ++i) {
        CHECK(error(found[static_cast<std::size_t>(3 + i)], c(i) + 0.3L * a(i)) < rounding);
        CHECK(error(found[static_cast<std::size_t>(3 + count + i)], 0.7L * a(i) - 1.3L * b(i) + 0.1L * c(i)) <
              rounding);
      }
      CHECK(found == results(array_functions(VectorSet::baseline), a, b, c));
    }
  }
}

TEST_CASE("array kernel: a number that is not finite is found wherever it stands") {
  for (const VectorSet set : available_vector_sets())
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()})
      for (const long count : {1L, 5L, 8L, 23L})
        for (long at = 0; at < count; ++at) {
          VectorXd a = VectorXd::Constant(count, -2.0);
          CHECK(array_functions(set).range(a.data(), count).finite);
          a(at) = bad;
          CHECK_FALSE(array_functions(set).range(a.data(), count).finite);
        }
}

TEST_CASE("array kernel: the mass matrix of nodes of any dimension") {
  for (const VectorSet set : available_vector_sets())
    for (const int n : {1, 2, 3, 4, 5, 8, 11}) {
      constexpr int nodes = 5;
      CAPTURE(static_cast<int>(set), n);
      const MatrixXd half = MatrixXd::Random(nodes, nodes), mass = half + half.transpose();
      const MatrixXd v = MatrixXd::Random(n, nodes), before = MatrixXd::Random(n, nodes);
      const VectorXd weights = VectorXd::Random(n);
      MatrixXd y = before;
      array_functions(set).add_mass(0.02, mass.data(), nodes, weights.data(), n, v.data(), y.data());
      const MatrixXd wanted = before + 0.02 * weights.asDiagonal() * v * mass;
      CHECK((y - wanted).cwiseAbs().maxCoeff() < rounding);
      MatrixXd same = before;
      array_functions(VectorSet::baseline).add_mass(0.02, mass.data(), nodes, weights.data(), n, v.data(), same.data());
      CHECK(y == same);
    }
}
