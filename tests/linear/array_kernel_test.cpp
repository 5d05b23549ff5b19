// Sums over arrays against Eigen's in long double, for each set of instructions, and equal bits between them.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "linear/array_kernel.hpp"
#include "support/upper_halves.hpp"

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

  VectorXd moved = c;
  std::array<ArrayRange, 2> ranges{};
  f.add_and_measure(0.3, a.data(), moved.data(), count, &ranges[0], &ranges[1]);
  all.insert(all.end(), moved.begin(), moved.end());
  for (const ArrayRange& range : ranges) all.insert(all.end(), {range.largest, range.finite ? 1.0 : 0.0});
  f.measure_difference(a.data(), b.data(), 0.3, c.data(), count, &ranges[0], &ranges[1]);
  for (const ArrayRange& range : ranges) all.insert(all.end(), {range.largest, range.finite ? 1.0 : 0.0});
  std::array<double, GrowingDot::stride> products{};
  f.add_products(a.data(), c.data(), count / GrowingDot::stride * GrowingDot::stride, products.data());
  all.insert(all.end(), products.begin(), products.end());
  std::array<double, 2> both{};
  f.dot_both(a.data(), b.data(), c.data(), count, both.data());
  all.insert(all.end(), both.begin(), both.end());
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
      const double* const moved = &found[static_cast<std::size_t>(3 + 2 * count)];
      const VectorXd wanted = c + 0.3 * a;
      CHECK(std::equal(wanted.begin(), wanted.end(), moved));
      const ArrayRange of_wanted = f.range(wanted.data(), count);
      const VectorXd difference = a - (b + 0.3 * c);
      const double of_difference = f.range(difference.data(), count).largest;
      const std::vector<double> ranges{found[2], 1.0, of_wanted.largest, 1.0, of_difference, 1.0, found[2], 1.0};
      CHECK(std::equal(ranges.begin(), ranges.end(), moved + count));
      CHECK(found[found.size() - 2] == found[0]);
      CHECK(found.back() == f.dot(a.data(), c.data(), count));
      CHECK(found == results(array_functions(VectorSet::baseline), a, b, c));
    }
  }
}

TEST_CASE("array kernel: a sum that grows is that of whole arrays to the last bit") {
  for (const long count : {0L, 5L, 16L, 33L, 100L, 803L}) {
    const VectorXd a = VectorXd::Random(count), b = VectorXd::Random(count);
    for (const long piece : {1L, 7L, 16L, 41L, 1000L}) {
      CAPTURE(count, piece);
      GrowingDot sum(a.data(), b.data());
      for (long known = 0; known < count;) {
        known = std::min(known + piece, count);
        sum.grow_to(known);
      }
      CHECK(sum.value(count) == array_functions().dot(a.data(), b.data(), count));
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
          VectorXd y = VectorXd::Zero(count);
          ArrayRange of_a{}, of_y{};
          array_functions(set).add_and_measure(1.0, a.data(), y.data(), count, &of_a, &of_y);
          CHECK_FALSE(of_a.finite);
          CHECK_FALSE(of_y.finite);
          const VectorXd fine = VectorXd::Zero(count);
          array_functions(set).measure_difference(a.data(), fine.data(), 1.0, fine.data(), count, &of_y, &of_a);
          CHECK_FALSE(of_a.finite);
          CHECK_FALSE(of_y.finite);
          for (const bool is_c : {false, true}) {
            const double* const b = is_c ? fine.data() : a.data();
            const double* const c = is_c ? a.data() : fine.data();
            array_functions(set).measure_difference(fine.data(), b, 1.0, c, count, &of_y, &of_a);
            CHECK(of_a.finite);
            CHECK_FALSE(of_y.finite);
          }
        }
}

TEST_CASE("array kernel: several pairs of arrays at a time") {
  constexpr std::size_t row = 2 + 2 * most_pairs;
  for (const VectorSet set : available_vector_sets())
    for (const long count : {1L, 3L, 4L, 8L, 17L, 803L})
      for (int pairs = 1; pairs <= most_pairs; ++pairs) {
        CAPTURE(static_cast<int>(set), count, pairs);
        const MatrixXd arrays = MatrixXd::Random(count, static_cast<Eigen::Index>(row));
        const VectorXd a = VectorXd::Random(count), weights = VectorXd::Random(static_cast<Eigen::Index>(row) * pairs);
        const VectorXd weights_of_y = VectorXd::Random(2 + 2 * pairs);
        std::array<const double*, row> all{};
        std::array<const double*, most_pairs> places{}, directions{};
        for (std::size_t k = 0; k < row; ++k) all[k] = arrays.col(static_cast<Eigen::Index>(k)).data();
        for (std::size_t k = 0; k < places.size(); ++k) places[k] = all[2 * k + 2], directions[k] = all[2 * k + 3];
        const auto found = [&](const ArrayFunctions& f) {
          std::vector<double> list(static_cast<std::size_t>(2 * pairs));
          f.project(a.data(), all[0], places.data(), directions.data(), pairs, list.data(), list.data() + pairs, count);
          std::array<ArrayRange, 2 + most_pairs> ranges{};
          VectorXd y(count), combined(count);
          f.ranges_of_sums(all.data(), weights.data(), pairs, ranges.data(), weights_of_y.data(), y.data(), count);
          f.combine(all.data(), weights_of_y.data(), 2 + 2 * pairs, combined.data(), count);
          CHECK(y == combined);
          CHECK((y - arrays.leftCols(2 + 2 * pairs) * weights_of_y).cwiseAbs().maxCoeff() < rounding);
          for (int k = 0; k < 2 + pairs; ++k) {
            CHECK(ranges[static_cast<std::size_t>(k)].finite);
            list.push_back(ranges[static_cast<std::size_t>(k)].largest);
          }
          return list;
        };
        const std::vector<double> list = found(array_functions(set));
        std::vector<double> wanted;
        for (int k = 0; k < pairs; ++k) wanted.push_back(a.dot(arrays.col(2 * k + 2) - arrays.col(0)));
        for (int k = 0; k < pairs; ++k) wanted.push_back(a.dot(arrays.col(2 * k + 3)));
        for (int k = 0; k < 2; ++k) wanted.push_back(arrays.col(k).cwiseAbs().maxCoeff());
        for (int k = 0; k < pairs; ++k) {
          const auto used = weights.segment(k * static_cast<Eigen::Index>(row), 4 + 2 * k);
          wanted.push_back((arrays.leftCols(4 + 2 * k) * used).cwiseAbs().maxCoeff());
        }
        REQUIRE(list.size() == wanted.size());
        for (std::size_t k = 0; k < list.size(); ++k) CHECK(std::abs(list[k] - wanted[k]) < rounding);
        CHECK(list == found(array_functions(VectorSet::baseline)));
      }
}

TEST_CASE("array kernel: a number that is not finite is found in the sums that it is part of") {
  constexpr int row = 2 + 2 * most_pairs;
  const std::vector<double> weights(static_cast<std::size_t>(row * most_pairs), 0.5);
  for (const VectorSet set : available_vector_sets())
    for (int bad = 0; bad < row; ++bad)
      for (const long at : {0L, 9L}) {
        MatrixXd arrays = MatrixXd::Constant(10, row, 1.0);
        arrays(at, bad) = std::numeric_limits<double>::quiet_NaN();
        std::array<const double*, row> all{};
        for (int k = 0; k < row; ++k) all[static_cast<std::size_t>(k)] = arrays.col(k).data();
        std::array<ArrayRange, 2 + most_pairs> ranges{};
        std::array<double, 10> y{};
        array_functions(set).ranges_of_sums(all.data(), weights.data(), most_pairs, ranges.data(), weights.data(),
                                            y.data(), 10);
        CAPTURE(bad, at);
        CHECK(ranges[0].finite == (bad != 0));
        CHECK(ranges[1].finite == (bad != 1));
        for (int k = 0; k < most_pairs; ++k)
          CHECK(ranges[static_cast<std::size_t>(2 + k)].finite == (bad >= 4 + 2 * k));
      }
}

TEST_CASE("array kernel: polynomials on intervals, and the transpose of their interpolation") {
  for (const VectorSet set : available_vector_sets())
    for (const int n : {1, 2, 3, 4, 5, 6, 7, 9})
      for (const auto& [c, at] : {std::pair{2, 2}, {4, 4}, {4, 5}, {4, 2}, {7, 7}}) {
        CAPTURE(static_cast<int>(set), n, c, at);
        constexpr int intervals = 3;
        const int stride = n + 2;
        const MatrixXd value = MatrixXd::Random(at, c + 1), nodes = MatrixXd::Random(n, intervals * c + 1);
        const MatrixXd weights = MatrixXd::Random(stride, intervals * at);
        const IntervalBasis basis{value.data(), at, c, n, intervals};
        MatrixXd points = weights;
        array_functions(set).interpolate(basis, nodes.data(), points.data(), stride);
        MatrixXd sums = nodes;
        array_functions(set).add_interpolated(basis, weights.data(), stride, sums.data());
        MatrixXd wanted_points = weights, wanted_sums = nodes;
        for (int j = 0; j < intervals; ++j) {
          wanted_points.block(0, j * at, n, at) = nodes.middleCols(j * c, c + 1) * value.transpose();
          wanted_sums.middleCols(j * c, c + 1) += weights.block(0, j * at, n, at) * value;
        }
        CHECK((points - wanted_points).cwiseAbs().maxCoeff() < rounding);
        CHECK((sums - wanted_sums).cwiseAbs().maxCoeff() < rounding);

        MatrixXd same_points = weights, same_sums = nodes;
        const ArrayFunctions& baseline = array_functions(VectorSet::baseline);
        baseline.interpolate(basis, nodes.data(), same_points.data(), stride);
        baseline.add_interpolated(basis, weights.data(), stride, same_sums.data());
        CHECK(points == same_points);
        CHECK(sums == same_sums);
      }
}

TEST_CASE("array kernel: combinations of nodes that follow each other") {
  constexpr int c = 4;
  const std::vector<int> first{0, 0, 8, 4, 3};
  const auto count = static_cast<int>(first.size());
  for (const VectorSet set : available_vector_sets())
    for (const int n : {1, 2, 3, 4, 5, 6, 7, 9}) {
      CAPTURE(static_cast<int>(set), n);
      const MatrixXd weights = MatrixXd::Random(c + 1, count), nodes = MatrixXd::Random(n, 13);
      const NodeCombinations combinations{weights.data(), first.data(), count, c, n};
      MatrixXd values(n, count), wanted(n, count), same(n, count);
      array_functions(set).combine_nodes(combinations, nodes.data(), values.data());
      for (int k = 0; k < count; ++k)
        wanted.col(k) = nodes.middleCols(first[static_cast<std::size_t>(k)], c + 1) * weights.col(k);
      CHECK((values - wanted).cwiseAbs().maxCoeff() < rounding);
      array_functions(VectorSet::baseline).combine_nodes(combinations, nodes.data(), same.data());
      CHECK(values == same);
    }
}

TEST_CASE("array kernel: the mass matrices of intervals with nodes of any dimension") {
  for (const VectorSet set : available_vector_sets())
    for (const int nodes : {3, 5, 8})
      for (const int n : {1, 2, 3, 4, 5, 8, 11}) {
        constexpr int intervals = 3;
        CAPTURE(static_cast<int>(set), n, nodes);
        const MatrixXd half = MatrixXd::Random(nodes, nodes), mass = half + half.transpose();
        const int count = intervals * (nodes - 1) + 1;
        const MatrixXd v = MatrixXd::Random(n, count), before = MatrixXd::Random(n, count);
        const VectorXd weights = VectorXd::Random(n);
        const std::array<double, intervals + 1> mesh{0.0, 0.02, 0.5, 1.0};
        const MassIntervals on{mesh.data(), intervals, mass.data(), nodes, weights.data(), n};
        MatrixXd y = before, wanted = before;
        array_functions(set).add_mass(on, v.data(), y.data());
        for (std::size_t j = 0; j < intervals; ++j) {
          const int first = static_cast<int>(j) * (nodes - 1);
          wanted.middleCols(first, nodes) +=
              (mesh[j + 1] - mesh[j]) * weights.asDiagonal() * v.middleCols(first, nodes) * mass;
        }
        CHECK((y - wanted).cwiseAbs().maxCoeff() < rounding);
        const double product = array_functions(set).mass_product(on, v.data());
        CHECK(product == Approx((wanted - before).cwiseProduct(v).sum()).margin(rounding));
        MatrixXd same = before;
        array_functions(VectorSet::baseline).add_mass(on, v.data(), same.data());
        CHECK(y == same);
        CHECK(array_functions(VectorSet::baseline).mass_product(on, v.data()) == product);
      }
}

#ifdef NDEBUG  // an optimised build: below -O2, as sanitized copies are compiled, no compiler sees to it
TEST_CASE("array kernel: no function leaves anything in the upper halves of registers", "[slow]") {
  constexpr int n = 5, c = 4, intervals = 3;
  constexpr std::size_t row = 2 + 2 * most_pairs;
  const std::vector<double> numbers(200, 0.5);
  const double* const a = numbers.data();
  std::vector<double> result(200, 0.25);
  double* const y = result.data();
  std::array<const double*, row> arrays{};
  arrays.fill(a);
  std::array<ArrayRange, row> ranges{};
  const IntervalBasis basis{a, c, c, n, intervals};
  const std::array<int, 3> first{0, 0, c};
  const NodeCombinations combinations{a, first.data(), 3, c, n};
  for (const VectorSet set : available_vector_sets()) {
    const ArrayFunctions& f = array_functions(set);
    const auto check = [&](const char* name, const auto& call) {
      CAPTURE(name, static_cast<int>(set));
      CHECK(leaves_upper_halves_clear(call));
    };
    for (const long count : {0L, 1L, 37L}) {
      check("dot", [&] { f.dot(a, a, count); });
      check("dot_both", [&] { f.dot_both(a, a, a, count, y); });
      check("dot_difference", [&] { f.dot_difference(a, a, a, count); });
      check("range", [&] { f.range(a, count); });
      check("add", [&] { f.add(2.0, a, y, count); });
      check("add_products", [&] { f.add_products(a, a, count / GrowingDot::stride * GrowingDot::stride, y); });
      check("add_and_measure", [&] { f.add_and_measure(0.5, a, y, count, &ranges[0], &ranges[1]); });
      check("measure_difference", [&] { f.measure_difference(a, a, 0.5, a, count, &ranges[0], &ranges[1]); });
      check("combine", [&] { f.combine(arrays.data(), a, 3, y, count); });
      for (int pairs = 1; pairs <= most_pairs; ++pairs) {
        check("project", [&] { f.project(a, a, arrays.data(), arrays.data(), pairs, y, y + 20, count); });
        check("ranges_of_sums", [&] { f.ranges_of_sums(arrays.data(), a, pairs, ranges.data(), a, y, count); });
      }
    }
    const MassIntervals on{a, intervals, a, c + 1, a, n};
    check("add_mass", [&] { f.add_mass(on, a, y); });
    check("mass_product", [&] { f.mass_product(on, a); });
    check("interpolate", [&] { f.interpolate(basis, a, y, n); });
    check("combine_nodes", [&] { f.combine_nodes(combinations, a, y); });
    check("add_interpolated", [&] { f.add_interpolated(basis, a, n, y); });
  }
}
#endif
