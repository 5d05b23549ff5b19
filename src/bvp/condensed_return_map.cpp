#include "bvp/condensed_return_map.hpp"

#include <algorithm>

namespace tchat {

CondensedReturnMap::CondensedReturnMap(const DefiningSystem& system, const OrbitShape& shape)
    : system_(system),
      shape_(shape),
      n_(shape.dimension),
      size_(shape.segments * (2 * shape.dimension + 1)),
      condensed_weights_(static_cast<std::size_t>(shape.segments * shape.dimension)),
      collocation_weights_(
          static_cast<std::size_t>(shape.segments * shape.intervals * shape.collocation * shape.dimension)),
      point_(n_),
      f_(n_),
      d_(n_),
      hx_(n_),
      hp_(system.free_count()),
      direction_(Eigen::VectorXd::Zero(n_ + system.free_count())),
      fx_(n_, n_),
      dx_(n_, n_),
      fp_(n_, system.free_count()),
      dp_(n_, system.free_count()) {
  const int block = 2 * n_ + 1;
  const auto dense = [&](int row, int row_count, int column, int column_count) {
    for (int a = 0; a < row_count; ++a)
      for (int b = 0; b < column_count; ++b) rows_.push_back(row + a), columns_.push_back(column + b);
  };
  for (int s = 0; s < shape.segments; ++s) {
    const int at = s * block;
    dense(at, n_, at, block);
    dense(at + n_, 1, at + n_, n_);
    for (int a = 0; a < n_; ++a) {
      if (s + 1 == shape.segments) factor_positions_.push_back(rows_.size());
      rows_.push_back(at + n_ + 1 + a);
      columns_.push_back((s + 1) % shape.segments * block + a);
    }
    dense(at + n_ + 1, n_, at + n_, n_);
  }
}

void CondensedReturnMap::values(const CondensedSystem& condensed, const Orbit& x, double mu,
                                std::vector<double>& values) {
  const HybridSystem& hybrid = system_.system();
  const double* par = x.par.data();
  values.clear();
  for (int s = 0; s < shape_.segments; ++s) {
    const IndexVector& v = system_.signature()[static_cast<std::size_t>(s)];
    condensed.duration_block(s, d_.data());
    for (int a = 0; a < n_; ++a) {
      values.insert(values.end(), condensed.first_block(s) + a * n_, condensed.first_block(s) + (a + 1) * n_);
      values.insert(values.end(), condensed.last_block(s) + a * n_, condensed.last_block(s) + (a + 1) * n_);
      values.push_back(d_(a));
    }
    system_.section_gradient(s, x.end(s), par, hx_.data());
    values.insert(values.end(), hx_.begin(), hx_.end());
    hybrid.first(FunctionKind::jump, v.jump, x.end(s), par, {}, f_.data(), fx_.data(), nullptr);
    values.insert(values.end(), static_cast<std::size_t>(n_), s + 1 == shape_.segments ? mu : 1.0);
    for (int a = 0; a < n_; ++a)
      for (int b = 0; b < n_; ++b) values.push_back(-fx_(a, b));
  }
}

void CondensedReturnMap::parameter_column(const CondensedSystem& condensed, const Orbit& x, int g, double* column) {
  const HybridSystem& hybrid = system_.system();
  const std::span<const int> parameter = std::span(system_.free_parameters()).subspan(static_cast<std::size_t>(g), 1);
  for (int s = 0; s < shape_.segments; ++s, column += 2 * n_ + 1) {
    const IndexVector& v = system_.signature()[static_cast<std::size_t>(s)];
    condensed.parameter_block(s, g, column);
    column[n_] = 0.0;  // a plane across the flow is left there
    double h = 0.0;
    if (system_.has_event(s))
      hybrid.first(FunctionKind::event, v.event, x.end(s), x.par.data(), parameter, &h, hx_.data(), column + n_);
    hybrid.first(FunctionKind::jump, v.jump, x.end(s), x.par.data(), parameter, f_.data(), fx_.data(), d_.data());
    for (int a = 0; a < n_; ++a) column[n_ + 1 + a] = -d_(a);
  }
}

void CondensedReturnMap::subtract_derivative(CondensedSystem& condensed, const Orbit& x, const double* v,
                                             const double* w, OrbitVector& extended, OrbitVector& gradient) {
  const int block = 2 * n_ + 1;
  condensed.extend(v, extended);
  direction_.tail(system_.free_count()) = extended.globals;
  for (int s = 0; s < shape_.segments; ++s)
    std::copy_n(w + s * block, n_, condensed_weights_.begin() + static_cast<std::ptrdiff_t>(s) * n_);
  condensed.extend_adjoint(condensed_weights_.data(), collocation_weights_);
  const double* weights = collocation_weights_.data();
  for (int s = 0; s < shape_.segments; ++s) {
    for (int j = 0; j < shape_.intervals; ++j, weights += shape_.collocation * n_)
      add_interval(condensed, x, s, j, weights, extended, gradient);
    add_ends(x, s, w + s * block, extended, gradient);
  }
}

/// Collocation rows: slope v - h T f_x v - h sigma f. The innermost loops of a curve: plain ones, no temporaries.
void CondensedReturnMap::add_interval(const CondensedSystem& condensed, const Orbit& x, int s, int j,
                                      const double* weights, const OrbitVector& v, OrbitVector& gradient) {
  const HybridSystem& hybrid = system_.system();
  const Eigen::MatrixXd& value = condensed.rule().value;
  const std::vector<int>& free = system_.free_parameters();
  const int n = n_;
  const int c = shape_.collocation;
  const int q = system_.free_count();
  const int field = system_.signature()[static_cast<std::size_t>(s)].field;
  const double h = x.mesh[static_cast<std::size_t>(j + 1)] - x.mesh[static_cast<std::size_t>(j)];
  const double duration = x.duration(s);
  const double sigma = v.durations(s);
  const int column = s * shape_.nodes() + j * c;
  const double* const states = x.states.col(column).data();
  const double* const deviations = v.states.col(column).data();
  double* const by_states = gradient.states.col(column).data();
  // h (T w^T f_xx v + sigma w^T f_x) for one variable
  const auto weighted = [&](const double* second, const double* first, const double* w) {
    double sum = 0.0;
    for (int b = 0; b < n; ++b) sum += (duration * second[b] + sigma * first[b]) * w[b];
    return h * sum;
  };
  for (int g = 0; g < c; ++g, weights += n) {
    for (int a = 0; a < n; ++a) {
      double at = 0.0;
      double along = 0.0;
      for (int i = 0; i <= c; ++i) {
        at += value(g, i) * states[i * n + a];
        along += value(g, i) * deviations[i * n + a];
      }
      point_(a) = at;
      direction_(a) = along;
    }
    hybrid.first(FunctionKind::field, field, point_.data(), x.par.data(), free, f_.data(), fx_.data(), fp_.data());
    hybrid.second(FunctionKind::field, field, point_.data(), x.par.data(), free, direction_.data(), d_.data(),
                  dx_.data(), dp_.data());
    for (int a = 0; a < n; ++a) {
      const double by_state = weighted(&dx_(0, a), &fx_(0, a), weights);
      for (int i = 0; i <= c; ++i) by_states[i * n + a] += value(g, i) * by_state;
      gradient.durations(s) += h * weights[a] * d_(a);
    }
    for (int k = 0; k < q; ++k) gradient.globals(k) += weighted(&dp_(0, k), &fp_(0, k), weights);
  }
}

/// Derivatives of h_x v by the state and the free parameters at the end of segment s, into hx_ and hp_. The plane
/// across the flow has the gradient f.
void CondensedReturnMap::section_change(const Orbit& x, int s, const Eigen::Ref<const Eigen::VectorXd>& v) {
  const HybridSystem& hybrid = system_.system();
  const std::vector<int>& free = system_.free_parameters();
  const IndexVector& index = system_.signature()[static_cast<std::size_t>(s)];
  if (system_.has_event(s)) {
    double rate = 0.0;
    hybrid.second(FunctionKind::event, index.event, x.end(s), x.par.data(), free, direction_.data(), &rate, hx_.data(),
                  hp_.data());
    return;
  }
  hybrid.first(FunctionKind::field, index.field, x.end(s), x.par.data(), free, f_.data(), fx_.data(), fp_.data());
  hx_.noalias() = fx_.transpose() * v;
  hp_.noalias() = fp_.transpose() * v;
}

/// Event row h_x v and connectivity rows mu v_next - g_x v of segment s; `weights` are those of its rows of S.
void CondensedReturnMap::add_ends(const Orbit& x, int s, const double* weights, const OrbitVector& v,
                                  OrbitVector& gradient) {
  const HybridSystem& hybrid = system_.system();
  const std::vector<int>& free = system_.free_parameters();
  const IndexVector& index = system_.signature()[static_cast<std::size_t>(s)];
  const int end = (s + 1) * shape_.nodes() - 1;
  direction_.head(n_) = v.states.col(end);

  section_change(x, s, v.states.col(end));
  gradient.states.col(end) -= weights[n_] * hx_;
  gradient.globals -= weights[n_] * hp_;

  const Eigen::Map<const Eigen::VectorXd> w(weights + n_ + 1, n_);
  hybrid.second(FunctionKind::jump, index.jump, x.end(s), x.par.data(), free, direction_.data(), d_.data(), dx_.data(),
                dp_.data());
  for (int b = 0; b < n_; ++b) gradient.states(b, end) += dx_.col(b).dot(w);
  for (int k = 0; k < system_.free_count(); ++k) gradient.globals(k) += dp_.col(k).dot(w);
}

}  // namespace tchat
