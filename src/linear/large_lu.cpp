#include "linear/large_lu.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <vector>

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Matrix = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

std::size_t entry_at(Eigen::Index k) { return static_cast<std::size_t>(k); }

bool has_pivots(const Eigen::PartialPivLU<MatrixXd>& lu) {
  const auto pivots = lu.matrixLU().diagonal().array();
  return (pivots != 0.0).all() && pivots.isFinite().all();
}

}  // namespace

struct LargeLu::Parts {
  /// Rows and columns J with A_JR; or the rest, without.
  struct Part {
    std::vector<int> rows, columns;
    Eigen::PartialPivLU<MatrixXd> lu;
    MatrixXd beside;
  };

  explicit Parts(int size) : names(entry_at(size)), row_sets(entry_at(size)), right(size), solution(size) {
    std::mt19937_64 generator;
    for (std::uint64_t& name : names) name = generator();
  }

  void choose(const Matrix& a);
  bool factorize(Part& part, const Matrix& a);
  const Part& rest() const { return parts.back(); }

  std::vector<std::uint64_t> names;     // of rows
  std::vector<std::uint64_t> row_sets;  // of each column: the sum of the names of the rows where it has entries
  std::vector<Part> parts;              // the rest is the last one
  VectorXd right, solution;
};

/// Sets are compared by 64 bits of random names: one that is no part, but taken for one, would be singular.
void LargeLu::Parts::choose(const Matrix& a) {
  std::vector<std::uint64_t> sets(row_sets.size(), 0);
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    for (Eigen::Index j = 0; j < a.cols(); ++j) sets[entry_at(j)] += a(i, j) != 0.0 ? names[entry_at(i)] : 0;
  if (!parts.empty() && sets == row_sets) return;
  row_sets = std::move(sets);
  std::map<std::uint64_t, std::vector<int>> alike;
  for (std::size_t j = 0; j < row_sets.size(); ++j) alike[row_sets[j]].push_back(static_cast<int>(j));
  parts.clear();
  Part others;
  std::vector<bool> taken(names.size(), false);
  for (const auto& [set, columns] : alike) {
    std::vector<int> rows;
    for (int i = 0; i < a.rows(); ++i)
      if (a(i, columns.front()) != 0.0) rows.push_back(i);
    const bool is_own = rows.size() == columns.size() && rows.size() < names.size() &&
                        std::none_of(rows.begin(), rows.end(), [&](int row) { return taken[entry_at(row)]; });
    if (!is_own) {
      others.columns.insert(others.columns.end(), columns.begin(), columns.end());
      continue;
    }
    for (const int row : rows) taken[entry_at(row)] = true;
    parts.push_back({std::move(rows), columns, {}, {}});
  }
  std::sort(others.columns.begin(), others.columns.end());
  for (int i = 0; i < a.rows(); ++i)
    if (!taken[entry_at(i)]) others.rows.push_back(i);
  parts.push_back(std::move(others));
}

bool LargeLu::Parts::factorize(Part& part, const Matrix& a) {
  part.lu.compute(a(part.rows, part.columns));
  if (&part != &rest()) part.beside = a(part.rows, rest().columns);
  return has_pivots(part.lu) && part.beside.allFinite();
}

LargeLu::LargeLu(int size) : parts_(std::make_unique<Parts>(size)) {}
LargeLu::~LargeLu() = default;
LargeLu::LargeLu(LargeLu&&) noexcept = default;
LargeLu& LargeLu::operator=(LargeLu&&) noexcept = default;

bool LargeLu::factorize(const double* entries) {
  Parts& p = *parts_;
  const Matrix a(entries, p.right.size(), p.right.size());
  p.choose(a);
  return std::all_of(p.parts.begin(), p.parts.end(), [&](Parts::Part& part) { return p.factorize(part, a); });
}

void LargeLu::solve(double* b) {
  Parts& p = *parts_;
  Eigen::Map<VectorXd> x(b, p.right.size());
  p.right = x;
  const VectorXd rest_right = p.right(p.rest().rows);
  const VectorXd rest = p.rest().lu.solve(rest_right);
  p.solution(p.rest().columns) = rest;
  for (const Parts::Part& part : p.parts)
    if (&part != &p.rest()) {
      const VectorXd right = p.right(part.rows) - part.beside * rest;
      p.solution(part.columns) = part.lu.solve(right).eval();
    }
  x = p.solution;
}

void LargeLu::solve_transposed(double* b) {
  Parts& p = *parts_;
  Eigen::Map<VectorXd> x(b, p.right.size());
  p.right = x;
  VectorXd left = p.right(p.rest().columns);
  for (const Parts::Part& part : p.parts) {
    if (&part == &p.rest()) continue;
    const VectorXd right = p.right(part.columns);
    const VectorXd weights = part.lu.transpose().solve(right);
    left -= part.beside.transpose() * weights;
    x(part.rows) = weights;
  }
  x(p.rest().rows) = p.rest().lu.transpose().solve(left).eval();
}

std::pair<int, double> LargeLu::determinant() const {
  std::vector<int> rows, columns;
  double log2_size = 0.0;
  int sign = 1;
  for (const Parts::Part& part : parts_->parts) {
    rows.insert(rows.end(), part.rows.begin(), part.rows.end());
    columns.insert(columns.end(), part.columns.begin(), part.columns.end());
    if (part.lu.permutationP().determinant() < 0) sign = -sign;
    for (const double pivot : part.lu.matrixLU().diagonal()) {
      if (pivot < 0.0) sign = -sign;
      log2_size += std::log2(std::abs(pivot));
    }
  }
  return {sign * permutation_parity(std::move(rows)) * permutation_parity(std::move(columns)), log2_size};
}

}  // namespace tchat
