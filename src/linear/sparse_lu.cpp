#include "linear/sparse_lu.hpp"

#include <umfpack.h>

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "linear/frontal_lu.hpp"
#include "linear/partial_lu.hpp"

namespace tchat {

namespace {

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

/// D_r A D_c with rows and columns whose largest entries are about 1, and space for vectors.
struct Equilibrated {
  SparseMatrix matrix;
  Eigen::VectorXd row_scale;                // diagonal of D_r
  Eigen::VectorXd column_scale;             // diagonal of D_c
  Eigen::VectorXd row_size, next_row_size;  // while it is made
  Eigen::VectorXd v, left, right;

  /// Matrices of one pattern all. `units`: of the unknowns, from which the scales of columns start; none: all 1.
  void equilibrate(const SparseMatrix& of, std::span<const double> units);
  /// By power iteration.
  double largest_singular_value(int iterations);

 private:
  void take(const SparseMatrix& of);
};

/// Each sweep goes through the matrix once: a column is divided by the sizes of its rows, then by its own, and counts
/// for the rows of the next sweep at once.
void Equilibrated::equilibrate(const SparseMatrix& of, std::span<const double> units) {
  constexpr int sweeps = 4;
  take(of);
  row_scale.setOnes(of.rows());
  column_scale.setOnes(of.cols());
  if (!units.empty()) {
    column_scale = Eigen::Map<const Eigen::VectorXd>(units.data(), std::ssize(units));
    for (int c = 0; c < matrix.cols(); ++c)
      for (SparseMatrix::InnerIterator entry(matrix, c); entry; ++entry) entry.valueRef() *= column_scale(c);
  }
  row_size.setZero(of.rows());
  next_row_size.resize(of.rows());
  const int* const row = matrix.innerIndexPtr();
  double* const value = matrix.valuePtr();
  for (Eigen::Index k = 0; k < matrix.nonZeros(); ++k)
    row_size(row[k]) = std::max(row_size(row[k]), std::abs(value[k]));
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (double& size : row_size)
      if (!(size > 0.0)) size = 1.0;
    row_scale.array() /= row_size.array();
    next_row_size.setZero();
    for (int c = 0; c < matrix.cols(); ++c) {
      const int begin = matrix.outerIndexPtr()[c], end = matrix.outerIndexPtr()[c + 1];
      double column_size = 0.0;
      for (int k = begin; k < end; ++k) {
        value[k] /= row_size(row[k]);
        column_size = std::max(column_size, std::abs(value[k]));
      }
      if (column_size == 0.0) continue;
      column_scale(c) /= column_size;
      for (int k = begin; k < end; ++k) {
        value[k] /= column_size;
        next_row_size(row[k]) = std::max(next_row_size(row[k]), std::abs(value[k]));
      }
    }
    row_size.swap(next_row_size);
  }
}

/// Values alone where the pattern is that of the last time.
void Equilibrated::take(const SparseMatrix& of) {
  if (matrix.nonZeros() == of.nonZeros() && matrix.rows() == of.rows())
    std::copy_n(of.valuePtr(), of.nonZeros(), matrix.valuePtr());
  else
    matrix = of;
}

double Equilibrated::largest_singular_value(int iterations) {
  v.resize(matrix.cols());
  for (Eigen::Index i = 0; i < v.size(); ++i) v(i) = std::sin(1.0 + static_cast<double>(i));
  double largest = 0.0;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    v.normalize();
    left.noalias() = matrix * v;
    v.noalias() = matrix.transpose() * left;
    largest = std::sqrt(v.norm());
  }
  return largest;
}

void check(int status, const char* what) {
  if (status != UMFPACK_OK) throw std::invalid_argument(std::string("UMFPACK: ") + what);
}

SparseLu::Determinant determinant_of(const SmallLu& lu, int size) {
  SparseLu::Determinant result{lu.parity(), 0.0};
  for (int k = 0; k < size; ++k) {
    if (lu.pivot(k) < 0.0) result.sign = -result.sign;
    result.log2_size += std::log2(std::abs(lu.pivot(k))) + std::log2(lu.row_sum(k));
  }
  return std::isfinite(result.log2_size) ? result : SparseLu::Determinant{};
}

SparseLu::Determinant determinant_of(const FrontalLu& lu) {
  const auto [sign, log2_size] = lu.determinant();
  const SparseLu::Determinant result{sign, log2_size};
  return std::isfinite(result.log2_size) ? result : SparseLu::Determinant{};
}

}  // namespace

struct SparseLu::State {
  SparseMatrix matrix;
  std::vector<int> position;  // where entry k of the triplets goes in matrix.valuePtr()
  std::optional<SmallLu> small;
  bool small_is_factored = false;
  std::optional<FrontalLu> frontal;
  bool frontal_is_factored = false;
  std::vector<double> rest, change;  // of a solution by frontal matrices
  Equilibrated scaled;               // for singular_distance()
  void* symbolic = nullptr;
  void* numeric = nullptr;
  double control[UMFPACK_CONTROL];
  double info[UMFPACK_INFO];
  std::vector<int> integer_work;
  std::vector<double> real_work;

  State() { umfpack_di_defaults(control); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    umfpack_di_free_symbolic(&symbolic);
    umfpack_di_free_numeric(&numeric);
  }
  bool is_factored() const { return small ? small_is_factored : frontal_is_factored || numeric != nullptr; }
  bool factorize_small();
  void analyse();
  void solve_by_fronts(int system, const double* b, double* x);
  void solve_unrefined(int system, const double* b, double* x) {
    const bool transposed = system != UMFPACK_A;
    if (small) return transposed ? small->solve_transposed_unrefined(b, x) : small->solve_unrefined(b, x);
    if (frontal_is_factored) return transposed ? frontal->solve_transposed(b, x) : frontal->solve(b, x);
    solve(system, b, x);
  }
  void solve(int system, const double* b, double* x) {
    if (small) return system == UMFPACK_A ? small->solve(b, x) : small->solve_transposed(b, x);
    if (frontal_is_factored) return solve_by_fronts(system, b, x);
    umfpack_di_wsolve(system, matrix.outerIndexPtr(), matrix.innerIndexPtr(), matrix.valuePtr(), x, b, numeric, control,
                      info, integer_work.data(), real_work.data());
  }
};

bool SparseLu::State::factorize_small() {
  const auto rows = static_cast<int>(matrix.rows());
  std::fill_n(small->entries(), rows * rows, 0.0);
  for (int column = 0; column < rows; ++column)
    for (SparseMatrix::InnerIterator it(matrix, column); it; ++it)
      small->entries()[it.row() * rows + column] = it.value();
  return small_is_factored = small->factorize();
}

/// For UMFPACK.
void SparseLu::State::analyse() {
  const auto size = static_cast<int>(matrix.rows());
  check(umfpack_di_symbolic(size, size, matrix.outerIndexPtr(), matrix.innerIndexPtr(), nullptr, &symbolic, control,
                            info),
        "the pattern is structurally singular");
  integer_work.resize(static_cast<std::size_t>(size));
  real_work.resize(static_cast<std::size_t>(size) * 5);
}

/// Refined once, like solutions by SmallLu.
void SparseLu::State::solve_by_fronts(int system, const double* b, double* x) {
  const auto size = static_cast<int>(matrix.rows());
  const bool transposed = system != UMFPACK_A;
  const auto apply_inverse = [&](const double* right, double* solution) {
    transposed ? frontal->solve_transposed(right, solution) : frontal->solve(right, solution);
  };
  apply_inverse(b, x);
  std::copy_n(b, size, rest.begin());
  const int* row = matrix.innerIndexPtr();
  const double* value = matrix.valuePtr();
  for (int column = 0; column < size; ++column) {
    double sum = 0.0;
    for (int k = matrix.outerIndexPtr()[column]; k < matrix.outerIndexPtr()[column + 1]; ++k)
      if (transposed)
        sum += value[k] * x[row[k]];
      else
        rest[static_cast<std::size_t>(row[k])] -= value[k] * x[column];
    rest[static_cast<std::size_t>(column)] -= sum;
  }
  apply_inverse(rest.data(), change.data());
  for (int i = 0; i < size; ++i) x[i] += change[static_cast<std::size_t>(i)];
}

SparseLu::SparseLu(int size, const std::vector<int>& rows, const std::vector<int>& columns,
                   const std::vector<int>& groups)
    : state_(std::make_unique<State>()) {
  const int entries = static_cast<int>(rows.size());
  State& st = *state_;
  st.matrix.resize(size, size);
  st.position.resize(rows.size());
  std::vector<int> starts(static_cast<std::size_t>(size) + 1);
  std::vector<int> indices(rows.size());
  std::vector<double> values(rows.size());
  const std::vector<double> ones(rows.size(), 1.0);
  check(umfpack_di_triplet_to_col(size, size, entries, rows.data(), columns.data(), ones.data(), starts.data(),
                                  indices.data(), values.data(), st.position.data()),
        "the pattern is out of range");
  st.matrix = Eigen::Map<const SparseMatrix>(size, size, starts.back(), starts.data(), indices.data(), values.data());
  if (size <= most_dense_rows) {
    st.small.emplace(size);
    return;
  }
  if (!groups.empty()) st.frontal = FrontalLu::make(size, rows, columns, groups);
  if (st.frontal)
    st.rest = st.change = std::vector<double>(static_cast<std::size_t>(size));
  else
    st.analyse();
}

SparseLu::~SparseLu() = default;
SparseLu::SparseLu(SparseLu&&) noexcept = default;
SparseLu& SparseLu::operator=(SparseLu&&) noexcept = default;

int SparseLu::size() const { return static_cast<int>(state_->matrix.rows()); }

bool SparseLu::factorize(const std::vector<double>& values) {
  State& st = *state_;
  double* entries = st.matrix.valuePtr();
  std::fill(entries, entries + st.matrix.nonZeros(), 0.0);
  double finite = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    entries[st.position[k]] += values[k];
    finite += values[k] - values[k];
  }
  umfpack_di_free_numeric(&st.numeric);
  st.small_is_factored = st.frontal_is_factored = false;
  if (finite != 0.0) return false;
  if (st.small) return st.factorize_small();
  if (st.frontal && (st.frontal_is_factored = st.frontal->factorize(values))) return true;
  return factorize_sparse();
}

/// By UMFPACK; where frontal matrices did not do, its analysis of the pattern comes first.
bool SparseLu::factorize_sparse() {
  State& st = *state_;
  if (st.symbolic == nullptr) st.analyse();
  const double* entries = st.matrix.valuePtr();
  const int status = umfpack_di_numeric(st.matrix.outerIndexPtr(), st.matrix.innerIndexPtr(), entries, st.symbolic,
                                        &st.numeric, st.control, st.info);
  // Finite values may overflow on the way.
  const bool finite_factors = std::isfinite(st.info[UMFPACK_UMAX]) && std::isfinite(st.info[UMFPACK_UMIN]);
  if (status == UMFPACK_OK && finite_factors) return true;
  umfpack_di_free_numeric(&st.numeric);
  return false;
}

void SparseLu::solve(const double* b, double* x) { state_->solve(UMFPACK_A, b, x); }
void SparseLu::solve_transposed(const double* b, double* x) { state_->solve(UMFPACK_At, b, x); }

SparseLu::Determinant SparseLu::determinant() const {
  if (!state_->is_factored()) return {};
  if (state_->small) return determinant_of(*state_->small, size());
  if (state_->frontal_is_factored) return determinant_of(*state_->frontal);
  // P R A Q = L U with L's diagonal 1. UMFPACK's own product of U's diagonal never ends where an entry is not finite.
  const auto n = static_cast<std::size_t>(size());
  std::vector<int> row_order(n);
  std::vector<int> column_order(n);
  std::vector<double> diagonal(n);
  std::vector<double> row_scale(n);
  int reciprocal = 0;  // R is 1 / row_scale or row_scale
  if (umfpack_di_get_numeric(nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, row_order.data(),
                             column_order.data(), diagonal.data(), &reciprocal, row_scale.data(),
                             state_->numeric) != UMFPACK_OK)
    return {};
  Determinant result{permutation_parity(row_order) * permutation_parity(column_order), 0.0};
  for (std::size_t k = 0; k < n; ++k) {
    if (diagonal[k] == 0.0) return {};
    if (diagonal[k] < 0.0) result.sign = -result.sign;
    const double scale = std::log2(row_scale[k]);
    result.log2_size += std::log2(std::abs(diagonal[k])) + (reciprocal != 0 ? -scale : scale);
  }
  return std::isfinite(result.log2_size) ? result : Determinant{};
}

double SparseLu::singular_distance(std::span<const double> units) const {
  if (!state_->is_factored()) return 0.0;
  constexpr int iterations = 4;
  Equilibrated& scaled = state_->scaled;
  scaled.equilibrate(state_->matrix, units);
  Eigen::VectorXd& v = scaled.v;
  Eigen::VectorXd& left = scaled.left;
  Eigen::VectorXd& right = scaled.right;
  v.resize(size());
  left.resize(size());
  for (Eigen::Index i = 0; i < v.size(); ++i) v(i) = std::cos(1.0 + 2.0 * static_cast<double>(i));
  double growth = 0.0;
  // (D_r A D_c)^-1 = D_c^-1 A^-1 D_r^-1
  for (int iteration = 0; iteration < iterations; ++iteration) {
    v.normalize();
    right = v.cwiseQuotient(scaled.column_scale);
    state_->solve_unrefined(UMFPACK_At, right.data(), left.data());
    left = left.cwiseQuotient(scaled.row_scale).cwiseQuotient(scaled.row_scale);
    state_->solve_unrefined(UMFPACK_A, left.data(), right.data());
    v = right.cwiseQuotient(scaled.column_scale);
    growth = v.norm();
    if (!std::isfinite(growth) || growth == 0.0) return 0.0;
  }
  const double largest = scaled.largest_singular_value(iterations);
  return largest > 0.0 ? 1.0 / (std::sqrt(growth) * largest) : 0.0;
}

SparseLu::Condition SparseLu::condition(std::span<const double> units) const {
  // Equilibrate a copy, then find the smallest singular value by inverse iteration on (D_r A D_c)^T (D_r A D_c) with a
  // factorisation of the scaled copy.
  const int n = size();
  Equilibrated equilibrated;
  equilibrated.equilibrate(state_->matrix, units);
  const SparseMatrix& scaled = equilibrated.matrix;

  Condition result;
  State work;
  void* symbolic = nullptr;
  const int analysed = umfpack_di_symbolic(n, n, scaled.outerIndexPtr(), scaled.innerIndexPtr(), scaled.valuePtr(),
                                           &symbolic, work.control, work.info);
  work.symbolic = symbolic;
  if (analysed != UMFPACK_OK) return result;
  // Exactly singular matrices are moved by less than rounding, so that the iteration below can name the null vector.
  SparseMatrix moved = scaled;
  int status = umfpack_di_numeric(moved.outerIndexPtr(), moved.innerIndexPtr(), moved.valuePtr(), work.symbolic,
                                  &work.numeric, work.control, work.info);
  for (int attempt = 1; status != UMFPACK_OK && attempt < 8; ++attempt) {
    umfpack_di_free_numeric(&work.numeric);
    for (Eigen::Index k = 0; k < moved.nonZeros(); ++k)
      moved.valuePtr()[k] +=
          std::numeric_limits<double>::epsilon() * std::sin(1.0 + static_cast<double>(k * (attempt + 1)));
    status = umfpack_di_numeric(moved.outerIndexPtr(), moved.innerIndexPtr(), moved.valuePtr(), work.symbolic,
                                &work.numeric, work.control, work.info);
  }
  if (status != UMFPACK_OK) return result;
  work.matrix = moved;
  work.integer_work.resize(static_cast<std::size_t>(n));
  work.real_work.resize(static_cast<std::size_t>(n) * 5);

  Eigen::VectorXd v(n);
  Eigen::VectorXd u(n);
  Eigen::VectorXd w(n);
  const double largest = equilibrated.largest_singular_value(20);
  double smallest = 0.0;
  for (int i = 0; i < n; ++i) v(i) = std::cos(1.0 + 2.0 * i);
  for (int iteration = 0; iteration < 6; ++iteration) {
    v.normalize();
    work.solve(UMFPACK_At, v.data(), u.data());
    work.solve(UMFPACK_A, u.data(), w.data());
    const double growth = w.norm();
    if (!std::isfinite(growth) || growth == 0.0) break;
    smallest = 1.0 / std::sqrt(growth);
    v = w;
  }
  v.normalize();
  const Eigen::VectorXd direction = equilibrated.column_scale.cwiseProduct(v);
  result.reciprocal = largest > 0.0 ? smallest / largest : 0.0;
  result.null_direction.assign(direction.data(), direction.data() + n);
  return result;
}

}  // namespace tchat
