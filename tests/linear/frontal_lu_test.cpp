// Frontal matrices against dense linear algebra, on rings like those that the segments of an orbit are.
#include <catch2/catch.hpp>
#include <numeric>
#include <random>

#include "linear/frontal_lu.hpp"
#include "linear/sparse_lu.hpp"
#include "support/random_matrices.hpp"

using namespace tchat;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct GroupedMatrix {
  int size;
  std::vector<int> rows, columns, groups;
  std::vector<double> values;

  GroupedMatrix(int a_size, unsigned seed) : size(a_size), generator(seed) {}

  /// `count` rows of very different size.
  void add(int group, int count, const std::vector<int>& own_columns) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> decades(-3.0, 3.0);
    for (int i = 0; i < count; ++i) {
      const double scale = std::pow(10.0, decades(generator));
      for (const int column : own_columns)
        rows.push_back(static_cast<int>(groups.size())), columns.push_back(column),
            values.push_back(scale * normal(generator));
      groups.push_back(group);
    }
  }

  MatrixXd dense() const {
    MatrixXd a = MatrixXd::Zero(size, size);
    for (std::size_t k = 0; k < rows.size(); ++k) a(rows[k], columns[k]) += values[k];
    return a;
  }

 private:
  std::mt19937 generator;
};

std::vector<int> numbers(int first, int count) {
  std::vector<int> result(static_cast<std::size_t>(count));
  std::iota(result.begin(), result.end(), first);
  return result;
}

std::vector<int> together(std::vector<int> some, const std::vector<int>& others) {
  some.insert(some.end(), others.begin(), others.end());
  return some;
}

/// `groups` groups with n unknowns of their own and n that the group before has entries in as well, and border rows
/// that have entries everywhere as columns `border` that all rows have entries in.
struct Ring : GroupedMatrix {
  Ring(int group_count, int n, int border, unsigned seed, bool closed = true)
      : GroupedMatrix(2 * n * group_count + border, seed) {
    const std::vector<int> common = numbers(2 * n * group_count, border);
    for (int g = 0; g < group_count; ++g) {
      std::vector<int> own = numbers(2 * n * g, 2 * n);
      if (closed || g + 1 < group_count) own = together(own, numbers(2 * n * ((g + 1) % group_count), n));
      add(g, 2 * n, together(own, common));
    }
    add(FrontalLu::border_row, border, numbers(0, size));
  }
};

/// Returns of `per_return` groups, of which each has n unknowns for its start and n + 1 for its end and its duration, n
/// + 1 rows for these, and n rows that couple its end to the next start or, component by component, the last end of a
/// return to the starts of all returns. The last unknown of n is one on which no other depends.
struct Torus : GroupedMatrix {
  Torus(int returns, int per_return, int n, int border, unsigned seed)
      : GroupedMatrix(returns * per_return * (2 * n + 1) + border, seed) {
    const int width = 2 * n + 1;
    const std::vector<int> common = numbers(size - border, border);
    const auto without_last = [&](int first) { return numbers(first, n - 1); };
    for (int g = 0; g < returns * per_return; ++g) {
      const int start = g * width, end = start + n, duration = end + n;
      const std::vector<int> others = together({duration}, common);
      add(g, n, together(together(without_last(start), without_last(end)), others));
      add(g, 1, {start + n - 1, end + n - 1});
      for (int a = 0; a < n; ++a) {
        std::vector<int> coupled = a + 1 < n ? without_last(end) : std::vector<int>{end + n - 1};
        if (g % per_return + 1 < per_return)
          coupled.push_back(start + width + a);
        else
          for (int l = 0; l < returns; ++l) coupled.push_back(l * per_return * width + a);
        add(g, 1, a + 1 < n ? together(coupled, common) : coupled);
      }
    }
    add(FrontalLu::border_row, border, numbers(0, size));
  }
};

MatrixXd with_unit_rows(MatrixXd a) {
  for (Eigen::Index i = 0; i < a.rows(); ++i) a.row(i) /= a.row(i).cwiseAbs().sum();
  return a;
}

VectorXd random_vector(int n, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  return VectorXd::NullaryExpr(n, [&] { return normal(generator); });
}

/// Solutions and the determinant against dense linear algebra; the sign of the determinant.
int sign_of_judged(const GroupedMatrix& a, FrontalLu& lu, unsigned seed) {
  const MatrixXd dense = a.dense();
  // Rounding; pivots grow little. The rows' sizes are divided out, and so are they here.
  const double rounding = 1e-13 * test::condition_number(with_unit_rows(dense));
  const VectorXd x = random_vector(a.size, seed);
  VectorXd b = dense * x, found(a.size);
  lu.solve(b.data(), found.data());
  CHECK((found - x).norm() < rounding * x.norm());
  b = dense.transpose() * x;
  lu.solve_transposed(b.data(), found.data());
  const VectorXd sizes = dense.cwiseAbs().rowwise().sum();
  CHECK(sizes.cwiseProduct(found - x).norm() < rounding * sizes.cwiseProduct(x).norm());

  const auto [sign, log_size] = lu.determinant();
  const auto [expected, expected_log_size] = test::sign_and_log2_of_determinant(dense);
  CHECK(sign == expected);
  CHECK(log_size == Approx(expected_log_size).margin(1e-8));
  return sign;
}

}  // namespace

TEST_CASE("frontal matrices: solutions with the matrix and its transpose, determinants") {
  struct Sizes {
    int groups, n, border;
    bool closed;
  };
  for (const Sizes& s : {Sizes{1, 2, 1, true}, Sizes{2, 1, 1, true}, Sizes{3, 4, 2, true}, Sizes{7, 3, 1, false},
                         Sizes{8, 4, 0, false}, Sizes{13, 2, 3, true}, Sizes{40, 1, 1, true}}) {
    CAPTURE(s.groups, s.n, s.border, s.closed);
    int negative = 0;
    for (unsigned seed = 0; seed < 12; ++seed) {
      const Ring a(s.groups, s.n, s.border, seed, s.closed);
      std::optional<FrontalLu> lu = FrontalLu::make(a.size, a.rows, a.columns, a.groups);
      REQUIRE(lu);
      REQUIRE(lu->factorize(a.values));
      const int sign = sign_of_judged(a, *lu, 100 + seed);
      negative += sign < 0 ? 1 : 0;
    }
    CHECK(negative > 0);
    CHECK(negative < 12);
  }
}

TEST_CASE("frontal matrices: long rows that couple all returns of a torus") {
  struct Sizes {
    int returns, per_return, n, border;
  };
  for (const Sizes& s : {Sizes{41, 1, 3, 1}, Sizes{25, 2, 2, 3}, Sizes{31, 3, 2, 2}, Sizes{60, 1, 4, 2}}) {
    CAPTURE(s.returns, s.per_return, s.n, s.border);
    int negative = 0;
    std::optional<FrontalLu> lu;
    for (unsigned seed = 0; seed < 8; ++seed) {
      const Torus a(s.returns, s.per_return, s.n, s.border, seed);
      REQUIRE(static_cast<int>(a.groups.size()) == a.size);
      if (!lu) lu = FrontalLu::make(a.size, a.rows, a.columns, a.groups);
      REQUIRE(lu);
      REQUIRE(lu->factorize(a.values));
      negative += sign_of_judged(a, *lu, 100 + seed) < 0 ? 1 : 0;
    }
    CHECK(negative > 0);
    CHECK(negative < 8);
  }
}

TEST_CASE("frontal matrices: one object serves many matrices of a pattern") {
  const Ring one(6, 2, 1, 1), other(6, 2, 1, 2);
  std::optional<FrontalLu> lu = FrontalLu::make(one.size, one.rows, one.columns, one.groups);
  REQUIRE(lu);
  const VectorXd x = random_vector(one.size, 3);
  for (const Ring* a : {&one, &other, &one}) {
    REQUIRE(lu->factorize(a->values));
    const VectorXd b = a->dense() * x;
    VectorXd found(a->size);
    lu->solve(b.data(), found.data());
    CHECK((found - x).norm() < 1e-9 * x.norm());
  }
}

TEST_CASE("frontal matrices: entries at one place are summed, in border rows as elsewhere") {
  const Ring whole(6, 2, 2, 7);
  Ring parts = whole;
  for (std::size_t k = 0; k < whole.values.size(); k += 3) {
    parts.rows.push_back(whole.rows[k]), parts.columns.push_back(whole.columns[k]);
    parts.values.push_back(0.75 * whole.values[k]);
    parts.values[k] -= parts.values.back();
  }
  REQUIRE(parts.dense().isApprox(whole.dense(), 1e-15));
  std::optional<FrontalLu> lu = FrontalLu::make(parts.size, parts.rows, parts.columns, parts.groups);
  REQUIRE(lu);
  REQUIRE(lu->factorize(parts.values));
  const VectorXd x = random_vector(parts.size, 8), b = whole.dense() * x;
  VectorXd found(parts.size);
  lu->solve(b.data(), found.data());
  const double rounding = 1e-13 * test::condition_number(with_unit_rows(whole.dense()));
  CHECK((found - x).norm() < rounding * x.norm());
}

TEST_CASE("frontal matrices: not for groups that all touch one another, nor for rows without groups") {
  Ring a(30, 2, 1, 1);
  std::mt19937 generator(4);
  std::uniform_int_distribution<int> any(0, a.size - 1);
  for (int k = 0; k < 4 * a.size; ++k) a.rows.push_back(any(generator)), a.columns.push_back(any(generator));
  CHECK_FALSE(FrontalLu::make(a.size, a.rows, a.columns, a.groups));
  CHECK_FALSE(FrontalLu::make(3, std::vector<int>{0, 1, 2}, std::vector<int>{0, 1, 2},
                              std::vector<int>(3, FrontalLu::border_row)));
}

TEST_CASE("frontal matrices: columns of a group that depend on one another are UMFPACK's, the matrix is not singular") {
  // Group 3's own columns are equal but for rounding and for the border rows, which do not serve as pivots there.
  const double difference = GENERATE(0.0, 1e-12);
  Ring a(12, 2, 1, 5);
  const int column = 2 * 2 * 3 + 2;
  for (std::size_t k = 0; k < a.rows.size(); ++k)
    if (a.columns[k] == column && a.groups[static_cast<std::size_t>(a.rows[k])] != FrontalLu::border_row)
      a.values[k] = a.values[k + 1] * (1.0 + difference * a.rows[k]);
  REQUIRE(a.columns[1] == a.columns[0] + 1);
  std::optional<FrontalLu> frontal = FrontalLu::make(a.size, a.rows, a.columns, a.groups);
  REQUIRE(frontal);
  CHECK_FALSE(frontal->factorize(a.values));
  const MatrixXd dense = a.dense();
  const double condition = test::condition_number(with_unit_rows(dense));
  REQUIRE(condition < 1e8);
  SparseLu lu(a.size, a.rows, a.columns, a.groups);
  REQUIRE(lu.factorize(a.values));
  const VectorXd x = random_vector(a.size, 6), b = dense * x;
  VectorXd found(a.size);
  lu.solve(b.data(), found.data());
  CHECK((found - x).norm() < 1e-13 * condition * x.norm());
  CHECK(lu.determinant().sign == (test::determinant(dense) > 0.0 ? 1 : -1));
}

TEST_CASE("frontal matrices: a column that hardly any row but the border's has entries in is UMFPACK's") {
  Ring a(8, 3, 1, 9);
  const Ring good = a;
  const double size = GENERATE(1e-12, 1e-16, 1e-20);
  for (std::size_t k = 0; k < a.rows.size(); ++k)
    if (a.columns[k] == 2 * 3 * 2 + 4 && a.groups[static_cast<std::size_t>(a.rows[k])] != FrontalLu::border_row)
      a.values[k] *= size;
  std::optional<FrontalLu> frontal = FrontalLu::make(a.size, a.rows, a.columns, a.groups);
  REQUIRE(frontal);
  CHECK_FALSE(frontal->factorize(a.values));
  SparseLu lu(a.size, a.rows, a.columns, a.groups);
  // One object, by fronts, by UMFPACK, by fronts again.
  for (const Ring* ring : {&good, static_cast<const Ring*>(&a), &good}) {
    REQUIRE(lu.factorize(ring->values));
    const MatrixXd dense = ring->dense();
    const VectorXd x = random_vector(ring->size, 6);
    VectorXd b = dense * x, found(ring->size);
    lu.solve(b.data(), found.data());
    const double rounding = 1e-12 * test::condition_number(with_unit_rows(ring == &a ? good.dense() : dense));
    CHECK((found - x).norm() < rounding * x.norm());
    b = dense.transpose() * x;
    lu.solve_transposed(b.data(), found.data());
    CHECK((dense.transpose() * found - b).norm() < 1e-12 * dense.norm() * found.norm());
    SparseLu by_umfpack(ring->size, ring->rows, ring->columns);
    REQUIRE(by_umfpack.factorize(ring->values));
    CHECK(lu.determinant().sign == by_umfpack.determinant().sign);
    CHECK(lu.singular_distance() == Approx(by_umfpack.singular_distance()).epsilon(1e-6));
  }
}

TEST_CASE("frontal matrices: through SparseLu as through UMFPACK") {
  const Ring a(11, 3, 2, 7);
  SparseLu by_fronts(a.size, a.rows, a.columns, a.groups), by_umfpack(a.size, a.rows, a.columns);
  REQUIRE(by_fronts.factorize(a.values));
  REQUIRE(by_umfpack.factorize(a.values));
  CHECK(by_fronts.determinant().sign == by_umfpack.determinant().sign);
  CHECK(by_fronts.determinant().log2_size == Approx(by_umfpack.determinant().log2_size).margin(1e-9));
  CHECK(by_fronts.singular_distance() == Approx(by_umfpack.singular_distance()).epsilon(1e-6));
  std::vector<double> bad = a.values;
  bad[5] = NAN;
  CHECK_FALSE(by_fronts.factorize(bad));
  CHECK(by_fronts.determinant().sign == 0);
  bad = a.values;
  for (std::size_t k = 0; k < bad.size(); ++k)
    if (a.rows[k] == 8) bad[k] = 0.0;
  CHECK_FALSE(by_fronts.factorize(bad));
}
