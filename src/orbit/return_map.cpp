#include "orbit/return_map.hpp"

#include <algorithm>

namespace tchat {

CondensedReturnMap::CondensedReturnMap(const DefiningSystem& system, const OrbitShape& shape, int vectors)
    : system_(system),
      shape_(shape),
      rule_(shape.collocation),
      n_(shape.dimension),
      size_(shape.segments * (2 * shape.dimension + 1)),
      condensed_weights_(static_cast<std::size_t>(shape.segments * shape.dimension)),
      collocation_weights_(
          static_cast<std::size_t>(vectors),
          std::vector<double>(static_cast<std::size_t>(shape.total_intervals() * shape.collocation * shape.dimension))),
      curvature_(system.system(), FunctionKind::field, system.free_parameters(),
                 (shape.own ? intervals_at_once : std::min(intervals_at_once, shape.intervals)) * shape.collocation,
                 vectors),
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
    system_.clear_absent(s, fx_.data(), n_);
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
    system_.clear_absent(s, d_.data(), 1);
    for (int a = 0; a < n_; ++a) column[n_ + 1 + a] = -d_(a);
  }
}

void CondensedReturnMap::subtract_derivative(CondensedSystem& condensed, const Orbit& x, const double* w,
                                             std::span<const OrbitVector> extended, OrbitVector& gradient) {
  const int block = 2 * n_ + 1;
  for (int k = 0; k < curvature_.directions(); ++k) {
    const double* const weights = w + static_cast<std::ptrdiff_t>(k) * size_;
    for (int s = 0; s < shape_.segments; ++s)
      std::copy_n(weights + s * block, n_, condensed_weights_.begin() + static_cast<std::ptrdiff_t>(s) * n_);
    condensed.extend_adjoint(condensed_weights_.data(), collocation_weights_[static_cast<std::size_t>(k)]);
    const OrbitVector& v = extended[static_cast<std::size_t>(k)];
    put_parameters(k, v);
    for (int s = 0; s < shape_.segments; ++s) add_ends(x, s, weights + s * block + n_, v, gradient);
  }
  add_segments(x, extended, gradient);
}

void CondensedReturnMap::subtract_derivative(const Orbit& x, const RowWeights& weights, const OrbitVector& v,
                                             OrbitVector& gradient) {
  collocation_weights_.front() = weights.collocation;
  put_parameters(0, v);
  for (int s = 0; s < shape_.segments; ++s) add_ends(x, s, weights.ends.data() + s * (1 + n_), v, gradient);
  add_segments(x, std::span(&v, 1), gradient);
}

/// Those of direction number k.
void CondensedReturnMap::put_parameters(int k, const OrbitVector& v) {
  std::copy_n(v.globals.data(), v.globals.size(), curvature_.parameter_direction(k));
  direction_.tail(system_.free_count()) = v.globals;
}

/// What the fields of all segments say.
void CondensedReturnMap::add_segments(const Orbit& x, std::span<const OrbitVector> extended, OrbitVector& gradient) {
  for (int s = 0; s < shape_.segments; ++s)
    for (int first = 0; first < x.shape.intervals_of(s); first += intervals_at_once) {
      const int last = std::min(first + intervals_at_once, x.shape.intervals_of(s));
      put_points(x, s, first, last, extended);
      put_weights(x, s, first, last, extended);
      curvature_.compute(system_.signature()[static_cast<std::size_t>(s)].field, (last - first) * shape_.collocation,
                         x.par.data());
      add_intervals(x, s, first, last, gradient);
    }
}

/// States and null vectors at the Gauss points of intervals first..last - 1.
void CondensedReturnMap::put_points(const Orbit& x, int s, int first, int last, std::span<const OrbitVector> extended) {
  const IntervalBasis basis = this->basis(first, last);
  const int node = first * x.shape.collocation;
  const int directions = curvature_.directions();
  array_functions().interpolate(basis, x.node(s, node), curvature_.point(0), n_);
  for (int k = 0; k < directions; ++k)
    array_functions().interpolate(basis,
                                  extended[static_cast<std::size_t>(k)].states.col(x.shape.first_node(s) + node).data(),
                                  curvature_.direction(0, k), directions * n_);
}

IntervalBasis CondensedReturnMap::basis(int first, int last) const {
  return {rule_.value.data(), shape_.collocation, shape_.collocation, n_, last - first};
}

/// Collocation rows: slope v - h T (f_x v + f_p q) - h sigma f, with the weights w; minus their derivative is that of
/// u . f + (h T w) . (f_x v + f_p q), u = h sigma w.
void CondensedReturnMap::put_weights(const Orbit& x, int s, int first, int last,
                                     std::span<const OrbitVector> extended) {
  const int c = shape_.collocation;
  const double duration = x.duration(s);
  const double* const mesh = x.mesh_of(s);
  with_dimension(n_, [&](auto n) {
    int point = 0;
    for (int j = first; j < last; ++j) {
      const double h = mesh[j + 1] - mesh[j];
      for (int g = 0; g < c; ++g, ++point) {
        const auto from =
            static_cast<std::size_t>((x.shape.first_interval(s) + j) * c + g) * static_cast<std::size_t>(n_);
        double* const u = curvature_.value_weights(point);
        for (int a = 0; a < n; ++a) u[a] = 0.0;
        for (int k = 0; k < curvature_.directions(); ++k) {
          const double* const w = &collocation_weights_[static_cast<std::size_t>(k)][from];
          const double along = h * duration;
          const double sigma = h * extended[static_cast<std::size_t>(k)].durations(s);
          double* const scaled = curvature_.weights(point, k);
          for (int a = 0; a < n; ++a) scaled[a] = along * w[a];
          for (int a = 0; a < n; ++a) u[a] += sigma * w[a];
        }
      }
    }
  });
}

/// The directional derivative number k at a point, times its weights.
template <class Dimension>
double CondensedReturnMap::along(Dimension n, int gauss_point, int point, int k) const {
  const int from = gauss_point * n;
  const double* const w = &collocation_weights_[static_cast<std::size_t>(k)][static_cast<std::size_t>(from)];
  const double* const directional = curvature_.directional(point, k);
  double sum = 0.0;
  for (int a = 0; a < n; ++a) sum += w[a] * directional[a];
  return sum;
}

/// What the field says at the Gauss points of intervals first..last - 1.
void CondensedReturnMap::add_intervals(const Orbit& x, int s, int first, int last, OrbitVector& gradient) {
  const int c = shape_.collocation;
  const int points = (last - first) * c;
  const auto free = static_cast<int>(gradient.globals.size());
  const double* const mesh = x.mesh_of(s);
  const int first_point = x.shape.first_interval(s) * c;
  array_functions().add_interpolated(basis(first, last), curvature_.gradient(0), n_ + free,
                                     gradient.states.col(x.shape.first_node(s) + first * c).data());
  for (int k = 0; k < free; ++k) {
    double sum = 0.0;
    for (int point = 0; point < points; ++point) sum += curvature_.gradient(point)[n_ + k];
    gradient.globals(k) += sum;
  }
  with_dimension(n_, [&](auto n) {
    int point = 0;
    for (int j = first; j < last; ++j) {
      const double h = mesh[j + 1] - mesh[j];
      double sum = 0.0;
      for (int g = 0; g < c; ++g, ++point)
        for (int k = 0; k < curvature_.directions(); ++k) sum += along(n, first_point + j * c + g, point, k);
      gradient.durations(s) += h * sum;
    }
  });
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

/// Event row h_x v and connectivity rows mu v_next - g_x v of segment s; `weights` are those of these rows.
void CondensedReturnMap::add_ends(const Orbit& x, int s, const double* weights, const OrbitVector& v,
                                  OrbitVector& gradient) {
  const HybridSystem& hybrid = system_.system();
  const std::vector<int>& free = system_.free_parameters();
  const IndexVector& index = system_.signature()[static_cast<std::size_t>(s)];
  const int end = x.shape.last_node(s);
  direction_.head(n_) = v.states.col(end);

  section_change(x, s, v.states.col(end));
  gradient.states.col(end) -= weights[0] * hx_;
  gradient.globals -= weights[0] * hp_;

  const Eigen::Map<const Eigen::VectorXd> w(weights + 1, n_);
  hybrid.second(FunctionKind::jump, index.jump, x.end(s), x.par.data(), free, direction_.data(), d_.data(), dx_.data(),
                dp_.data());
  for (int b = 0; b < n_; ++b) gradient.states(b, end) += dx_.col(b).dot(w);
  for (int k = 0; k < system_.free_count(); ++k) gradient.globals(k) += dp_.col(k).dot(w);
}

namespace {

Eigen::Index unknowns(const OrbitShape& shape) {
  return static_cast<Eigen::Index>(shape.dimension) * shape.columns() + shape.segments;
}

/// Where the rows of a segment's ends begin.
std::vector<Eigen::Index> rows_of_ends(const OrbitShape& shape) {
  std::vector<Eigen::Index> result;
  Eigen::Index row = 0;
  for (int s = 0; s < shape.segments; ++s) {
    row += static_cast<Eigen::Index>(shape.nodes_of(s) - 1) * shape.dimension;
    result.push_back(row);
    row += 1 + shape.dimension;
  }
  return result;
}

struct Pattern {
  std::vector<int> rows, columns;
  std::vector<int> groups;  // of each row: mesh intervals and ends of segments one after the other

  /// All `count` columns from `column` on, of `row`.
  void put(int row, int column, int count) {
    for (int b = 0; b < count; ++b) rows.push_back(row), columns.push_back(column + b);
  }
};

/// In the order in which NodalSystem writes values.
Pattern pattern_of(const OrbitShape& shape) {
  const int n = shape.dimension;
  const int c = shape.collocation;
  Pattern pattern;
  int row = 0, group = 0;
  for (int s = 0; s < shape.segments; ++s) {
    const int first = shape.first_node(s) * n;
    const int duration = shape.columns() * n + s;
    for (int j = 0; j < shape.intervals_of(s); ++j, ++group)
      for (int k = 0; k < c * n; ++k, ++row) {
        pattern.put(row, first + j * c * n, (c + 1) * n);
        pattern.put(row, duration, 1);
        pattern.groups.push_back(group);
      }
    const int end = shape.last_node(s) * n;
    pattern.put(row++, end, n);
    const int next = shape.first_node((s + 1) % shape.segments) * n;
    for (int a = 0; a < n; ++a, ++row) {
      pattern.put(row, next + a, 1);
      pattern.put(row, end, n);
    }
    pattern.groups.resize(static_cast<std::size_t>(row), group++);
  }
  return pattern;
}

SparseLu sparse_of(const OrbitShape& shape) {
  const Pattern pattern = pattern_of(shape);
  return {static_cast<int>(unknowns(shape)), pattern.rows, pattern.columns, pattern.groups};
}

}  // namespace

NodalSystem::NodalSystem(const DefiningSystem& system, const OrbitShape& shape)
    : system_(system),
      shape_(shape),
      rule_(shape.collocation),
      rows_of_ends_(rows_of_ends(shape)),
      lu_(sparse_of(shape)),
      columns_(unknowns(shape), system.free_count()),
      right_(unknowns(shape)),
      solution_(unknowns(shape)),
      state_(shape.dimension),
      f_(shape.dimension),
      hx_(shape.dimension),
      hp_(system.free_count()),
      fx_(shape.dimension, shape.dimension),
      fp_(shape.dimension, system.free_count()) {}

bool NodalSystem::factorize(const Orbit& x, double mu) {
  if (!(x.shape == shape_)) {  // segments on meshes of their own have got other numbers of intervals
    shape_ = x.shape;
    rows_of_ends_ = rows_of_ends(shape_);
    lu_ = sparse_of(shape_);
  }
  values_.clear();
  for (int s = 0; s < shape_.segments; ++s) {
    put_collocation(x, s);
    put_ends(x, s, s + 1 < shape_.segments ? 1.0 : mu);
  }
  return columns_.allFinite() && lu_.factorize(values_);
}

void NodalSystem::put_collocation(const Orbit& x, int s) {
  const int n = shape_.dimension;
  const int field = system_.signature()[static_cast<std::size_t>(s)].field;
  Eigen::Index row = end_row(s) - static_cast<Eigen::Index>(shape_.nodes_of(s) - 1) * n;
  const double* const mesh = x.mesh_of(s);
  for (int j = 0; j < shape_.intervals_of(s); ++j) {
    const double h = mesh[j + 1] - mesh[j];
    for (int g = 0; g < shape_.collocation; ++g) {
      interpolate(x, rule_, s, j, g, state_.data());
      system_.system().first(FunctionKind::field, field, state_.data(), x.par.data(), system_.free_parameters(),
                             f_.data(), fx_.data(), fp_.data());
      const double scale = h * x.duration(s);
      for (int a = 0; a < n; ++a, ++row) {
        for (int i = 0; i <= shape_.collocation; ++i)
          for (int b = 0; b < n; ++b)
            values_.push_back((a == b ? rule_.slope(g, i) : 0.0) - scale * rule_.value(g, i) * fx_(a, b));
        values_.push_back(-h * f_(a));
        columns_.row(row) = -scale * fp_.row(a);
      }
    }
  }
}

void NodalSystem::put_ends(const Orbit& x, int s, double mu) {
  const int n = shape_.dimension;
  const HybridSystem& hybrid = system_.system();
  const std::vector<int>& free = system_.free_parameters();
  const IndexVector& index = system_.signature()[static_cast<std::size_t>(s)];
  Eigen::Index row = end_row(s);
  hp_.setZero();  // a plane across the flow is left there
  double h = 0.0;
  if (system_.has_event(s))
    hybrid.first(FunctionKind::event, index.event, x.end(s), x.par.data(), free, &h, hx_.data(), hp_.data());
  else
    system_.section_gradient(s, x.end(s), x.par.data(), hx_.data());
  values_.insert(values_.end(), hx_.begin(), hx_.end());
  columns_.row(row++) = hp_.transpose();
  hybrid.first(FunctionKind::jump, index.jump, x.end(s), x.par.data(), free, f_.data(), fx_.data(), fp_.data());
  system_.clear_absent(s, fx_.data(), n);
  system_.clear_absent(s, fp_.data(), system_.free_count());
  for (int a = 0; a < n; ++a) {
    values_.push_back(mu);
    for (int b = 0; b < n; ++b) values_.push_back(-fx_(a, b));
    columns_.row(row++) = -fp_.row(a);
  }
}

void NodalSystem::solve(OrbitVector& v) {
  right_.noalias() = -columns_ * v.globals;
  lu_.solve(right_.data(), solution_.data());
  std::copy_n(solution_.data(), v.states.size(), v.states.data());
  v.durations = solution_.tail(shape_.segments);
}

void NodalSystem::solve_adjoint(const OrbitVector& q, Eigen::VectorXd& weights) {
  std::copy_n(q.states.data(), q.states.size(), right_.data());
  right_.tail(shape_.segments) = q.durations;
  weights.resize(right_.size());
  lu_.solve_transposed(right_.data(), weights.data());
}

Eigen::VectorXd NodalSystem::solve(const Eigen::VectorXd& right) {
  Eigen::VectorXd solution(right.size());
  lu_.solve(right.data(), solution.data());
  return solution;
}

Eigen::VectorXd NodalSystem::solve_adjoint(const Eigen::VectorXd& right) {
  Eigen::VectorXd weights(right.size());
  lu_.solve_transposed(right.data(), weights.data());
  return weights;
}

/// M maps the shift, v = the field, to |f|^2 in the row of the plane across the flow, and to zero in all others.
double NodalSystem::phase_derivative(const Eigen::VectorXd& weights, const Orbit& x, int s) {
  system_.section_gradient(s, x.end(s), x.par.data(), hx_.data());
  return weights(end_row(s)) * hx_.squaredNorm();
}

RowWeights NodalSystem::by_kind(const Eigen::VectorXd& weights) const {
  const std::ptrdiff_t of_ends = 1 + shape_.dimension;
  RowWeights result;
  for (int s = 0; s < shape_.segments; ++s) {
    const double* const ends = weights.data() + end_row(s);
    const auto of_collocation = static_cast<std::ptrdiff_t>(shape_.nodes_of(s) - 1) * shape_.dimension;
    result.collocation.insert(result.collocation.end(), ends - of_collocation, ends);
    result.ends.insert(result.ends.end(), ends, ends + of_ends);
  }
  return result;
}

}  // namespace tchat
