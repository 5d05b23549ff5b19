#include "orbit/directional_expansion.hpp"

#include <algorithm>

#include "linear/array_kernel.hpp"

namespace tchat {

DirectionalExpansion::DirectionalExpansion(const DefiningSystem& system, const OrbitShape& shape)
    : system_(system),
      shape_(shape),
      rule_(shape.collocation),
      states_(Eigen::MatrixXd::Zero(shape.dimension, 8 * intervals_at_once * shape.collocation)),
      values_(states_) {}

RowWeights DirectionalExpansion::make_rows() const {
  const auto n = static_cast<std::size_t>(shape_.dimension);
  const auto points = static_cast<std::size_t>(shape_.total_intervals()) * static_cast<std::size_t>(shape_.collocation);
  return {std::vector<double>(points * n, 0.0),
          std::vector<double>(static_cast<std::size_t>(shape_.segments) * (1 + n), 0.0)};
}

void DirectionalExpansion::find(const Orbit& x, const OrbitVector& u, RowWeights& second, RowWeights& third) {
  for (int s = 0; s < x.shape.segments; ++s) {
    const int intervals = x.shape.intervals_of(s);
    for (int first = 0; first < intervals; first += intervals_at_once)
      put_intervals(x, u, s, first, std::min(first + intervals_at_once, intervals), second, third);
    put_ends(x, u, s, second, third);
  }
}

/// values_ from columns 0 and 1 of states_: the three numbers that states depend on move them alike.
void DirectionalExpansion::evaluate(FunctionKind kind, int number, int points, const Orbit& x) {
  for (Eigen::Index column = 0; column < 8 * points; column += 8) {
    states_.col(column + 2) = states_.col(column + 1);
    states_.col(column + 4) = states_.col(column + 1);
  }
  system_.system().third_at_points(kind, number, points, states_.data(), x.par.data(), values_.data());
}

void DirectionalExpansion::put_intervals(const Orbit& x, const OrbitVector& u, int s, int first, int last,
                                         RowWeights& second, RowWeights& third) {
  const int n = shape_.dimension;
  const int c = shape_.collocation;
  const IntervalBasis basis{rule_.value.data(), c, c, n, last - first};
  const Eigen::Index node = x.shape.first_node(s) + first * c;
  array_functions().interpolate(basis, x.states.col(node).data(), states_.col(0).data(), 8 * n);
  array_functions().interpolate(basis, u.states.col(node).data(), states_.col(1).data(), 8 * n);
  evaluate(FunctionKind::field, system_.signature()[static_cast<std::size_t>(s)].field, (last - first) * c, x);
  const double* const mesh = x.mesh_of(s);
  const double* values = values_.data();
  auto row = static_cast<std::size_t>((x.shape.first_interval(s) + first) * c * n);
  for (int j = first; j < last; ++j) {
    const double along = -(mesh[j + 1] - mesh[j]) * x.duration(s);
    const double sigma = -(mesh[j + 1] - mesh[j]) * u.durations(s);
    for (int g = 0; g < c; ++g, values += 8 * n)
      for (int a = 0; a < n; ++a, ++row) {
        second.collocation[row] = along * values[3 * n + a] + 2.0 * sigma * values[n + a];
        third.collocation[row] = along * values[7 * n + a] + 3.0 * sigma * values[3 * n + a];
      }
  }
}

void DirectionalExpansion::put_ends(const Orbit& x, const OrbitVector& u, int s, RowWeights& second,
                                    RowWeights& third) {
  const IndexVector& index = system_.signature()[static_cast<std::size_t>(s)];
  const int n = shape_.dimension;
  auto row = static_cast<std::size_t>(s * (1 + n));
  states_.col(0) = x.states.col(x.shape.last_node(s));
  states_.col(1) = u.states.col(x.shape.last_node(s));
  second.ends[row] = third.ends[row] = 0.0;
  if (system_.has_event(s)) {
    evaluate(FunctionKind::event, index.event, 1, x);
    second.ends[row] = values_.data()[3];  // one row
    third.ends[row] = values_.data()[7];
  }
  ++row;
  evaluate(FunctionKind::jump, index.jump, 1, x);
  system_.clear_absent(s, values_.data(), 8);
  for (int a = 0; a < n; ++a, ++row) {
    second.ends[row] = -values_(a, 3);
    third.ends[row] = -values_(a, 7);
  }
}

}  // namespace tchat
