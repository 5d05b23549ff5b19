#include "bvp/critical_multiplier.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tchat {

namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// Rows of S by segment: n condensed, 1 event, n connectivity; one full row and column of the border last.
SparseLu make_pattern(int n, int m) {
  std::vector<int> rows;
  std::vector<int> columns;
  const int block = 2 * n + 1;
  const int size = m * block;
  const auto dense = [&](int row, int row_count, int column, int column_count) {
    for (int a = 0; a < row_count; ++a)
      for (int b = 0; b < column_count; ++b) rows.push_back(row + a), columns.push_back(column + b);
  };
  for (int s = 0; s < m; ++s) {
    const int at = s * block;
    dense(at, n, at, block);
    dense(at + n, 1, at + n, n);
    for (int a = 0; a < n; ++a) rows.push_back(at + n + 1 + a), columns.push_back((s + 1) % m * block + a);
    dense(at + n + 1, n, at + n, n);
  }
  dense(0, size, size, 1);
  dense(size, 1, 0, size);
  return {size + 1, rows, columns};
}

void normalise(std::vector<double>& v) {
  const double norm = std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0));
  if (norm > 0.0)
    for (double& entry : v) entry /= norm;
}

}  // namespace

CriticalMultiplier::CriticalMultiplier(const DefiningSystem& system, const OrbitShape& shape, int multiplier)
    : system_(system),
      shape_(shape),
      n_(shape.dimension),
      size_(shape.segments * (2 * shape.dimension + 1)),
      multiplier_(multiplier),
      lu_(make_pattern(n_, shape.segments)),
      column_(static_cast<std::size_t>(size_)),
      row_(static_cast<std::size_t>(size_)),
      small_v_(static_cast<std::size_t>(size_) + 1),
      small_w_(static_cast<std::size_t>(size_) + 1),
      rhs_(static_cast<std::size_t>(size_) + 1, 0.0),
      v_(shape, system.free_count()),
      gradient_(shape, system.free_count()),
      collocation_weights_(
          static_cast<std::size_t>(shape.segments * shape.intervals * shape.collocation * shape.dimension)) {
  for (std::size_t i = 0; i < column_.size(); ++i) {
    column_[i] = std::sin(1.0 + 0.7 * static_cast<double>(i));
    row_[i] = std::cos(0.3 + 0.9 * static_cast<double>(i));
  }
  normalise(column_);
  normalise(row_);
  rhs_.back() = 1.0;
}

void CriticalMultiplier::assemble(const CondensedSystem& condensed, const Orbit& x) {
  const HybridSystem& hybrid = system_.system();
  const double* par = x.par.data();
  Vector f(n_);
  Vector duration(n_);
  Vector gradient(n_);
  Matrix gx(n_, n_);
  values_.clear();
  for (int s = 0; s < shape_.segments; ++s) {
    const IndexVector& v = system_.signature()[static_cast<std::size_t>(s)];
    condensed.duration_block(s, duration.data());
    for (int a = 0; a < n_; ++a) {
      values_.insert(values_.end(), condensed.first_block(s) + a * n_, condensed.first_block(s) + (a + 1) * n_);
      values_.insert(values_.end(), condensed.last_block(s) + a * n_, condensed.last_block(s) + (a + 1) * n_);
      values_.push_back(duration(a));
    }
    system_.section_gradient(s, x.end(s), par, gradient.data());
    values_.insert(values_.end(), gradient.data(), gradient.data() + n_);
    hybrid.first(FunctionKind::jump, v.jump, x.end(s), par, {}, f.data(), gx.data(), nullptr);
    const double factor = s + 1 == shape_.segments ? multiplier_ : 1.0;
    values_.insert(values_.end(), static_cast<std::size_t>(n_), factor);
    for (int a = 0; a < n_; ++a)
      for (int b = 0; b < n_; ++b) values_.push_back(-gx(a, b));
  }
  values_.insert(values_.end(), column_.begin(), column_.end());
  values_.insert(values_.end(), row_.begin(), row_.end());
}

bool CriticalMultiplier::solve_bordered() {
  if (!lu_.factorize(values_)) return false;
  lu_.solve(rhs_.data(), small_v_.data());
  lu_.solve_transposed(rhs_.data(), small_w_.data());
  value_ = small_v_.back();
  return std::isfinite(value_) && std::isfinite(small_w_.front());
}

bool CriticalMultiplier::evaluate(CondensedSystem& condensed, const Orbit& x) {
  // The border follows the null vectors; the first time it takes some rounds to find them.
  const int rounds = started_ ? 1 : 4;
  for (int round = 0; round < rounds; ++round) {
    assemble(condensed, x);
    if (!solve_bordered()) return false;
    if (round + 1 == rounds) break;
    std::copy_n(small_w_.begin(), size_, column_.begin());
    std::copy_n(small_v_.begin(), size_, row_.begin());
    normalise(column_);
    normalise(row_);
  }
  started_ = true;
  differentiate(condensed, x);
  multiplicity_ = 0.0;
  const std::size_t last = at(shape_.segments - 1) + static_cast<std::size_t>(n_) + 1;
  for (std::size_t a = 0; a < static_cast<std::size_t>(n_); ++a) multiplicity_ += small_w_[last + a] * small_v_[a];
  std::copy_n(small_w_.begin(), size_, column_.begin());
  std::copy_n(small_v_.begin(), size_, row_.begin());
  normalise(column_);
  normalise(row_);
  return true;
}

/// gradient = -w^T (dS) v, interval by interval and end by end.
void CriticalMultiplier::differentiate(CondensedSystem& condensed, const Orbit& x) {
  condensed.extend(small_v_.data(), v_);
  std::vector<double> condensed_weights;
  for (int s = 0; s < shape_.segments; ++s)
    condensed_weights.insert(condensed_weights.end(), small_w_.begin() + static_cast<std::ptrdiff_t>(at(s)),
                             small_w_.begin() + static_cast<std::ptrdiff_t>(at(s)) + n_);
  condensed.extend_adjoint(condensed_weights.data(), collocation_weights_);
  gradient_.set_zero();
  const double* weights = collocation_weights_.data();
  for (int s = 0; s < shape_.segments; ++s) {
    for (int j = 0; j < shape_.intervals; ++j, weights += shape_.collocation * n_)
      add_interval(condensed, x, s, j, weights);
    add_ends(x, s, &small_w_[at(s)]);
  }
}

/// Collocation rows: slope v - h T f_x v - h sigma f.
void CriticalMultiplier::add_interval(const CondensedSystem& condensed, const Orbit& x, int s, int j,
                                      const double* weights) {
  const HybridSystem& hybrid = system_.system();
  const CollocationRule& rule = condensed.rule();
  const std::vector<int>& free = system_.free_parameters();
  const int c = shape_.collocation;
  const int q = system_.free_count();
  const int field = system_.signature()[static_cast<std::size_t>(s)].field;
  const double h = x.mesh[static_cast<std::size_t>(j + 1)] - x.mesh[static_cast<std::size_t>(j)];
  const double duration = x.duration(s);
  const double sigma = v_.durations(s);
  const int column = s * shape_.nodes() + j * c;
  Vector f(n_), d(n_), point(n_);
  Vector direction = Vector::Zero(n_ + q);
  Matrix fx(n_, n_), dx(n_, n_), fp(n_, q), dp(n_, q);
  for (int g = 0; g < c; ++g, weights += n_) {
    const Eigen::Map<const Vector> w(weights, n_);
    point.noalias() = x.states.middleCols(column, c + 1) * rule.value.row(g).transpose();
    direction.head(n_).noalias() = v_.states.middleCols(column, c + 1) * rule.value.row(g).transpose();
    hybrid.first(FunctionKind::field, field, point.data(), x.par.data(), free, f.data(), fx.data(), fp.data());
    hybrid.second(FunctionKind::field, field, point.data(), x.par.data(), free, direction.data(), d.data(), dx.data(),
                  dp.data());
    const Vector by_state = h * (duration * (dx.transpose() * w) + sigma * (fx.transpose() * w));
    for (int i = 0; i <= c; ++i) gradient_.states.col(column + i) += rule.value(g, i) * by_state;
    gradient_.durations(s) += h * w.dot(d);
    gradient_.globals += h * (duration * (dp.transpose() * w) + sigma * (fp.transpose() * w));
  }
}

/// Event row h_x v and connectivity rows mu v_next - g_x v of segment s; `weights` are those of its rows of S.
void CriticalMultiplier::add_ends(const Orbit& x, int s, const double* weights) {
  const HybridSystem& hybrid = system_.system();
  const std::vector<int>& free = system_.free_parameters();
  const IndexVector& index = system_.signature()[static_cast<std::size_t>(s)];
  const int q = system_.free_count();
  const int end = (s + 1) * shape_.nodes() - 1;
  Vector direction = Vector::Zero(n_ + q);
  direction.head(n_) = v_.states.col(end);

  double rate = 0.0;
  Vector hx(n_);
  Vector hp(q);
  hybrid.second(FunctionKind::event, index.event, x.end(s), x.par.data(), free, direction.data(), &rate, hx.data(),
                hp.data());
  gradient_.states.col(end) -= weights[n_] * hx;
  gradient_.globals -= weights[n_] * hp;

  const Eigen::Map<const Vector> w(weights + n_ + 1, n_);
  Vector d(n_);
  Matrix dx(n_, n_);
  Matrix dp(n_, q);
  hybrid.second(FunctionKind::jump, index.jump, x.end(s), x.par.data(), free, direction.data(), d.data(), dx.data(),
                dp.data());
  gradient_.states.col(end) += dx.transpose() * w;
  gradient_.globals += dp.transpose() * w;
}

}  // namespace tchat
