#include "orbit/nodal_system.hpp"

#include <algorithm>

#include "orbit/gauss_points.hpp"

namespace tchat {

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
