#include "orbit/orbit_expansion.hpp"

#include <algorithm>

#include "linear/array_kernel.hpp"

namespace tchat {

namespace {

/// The eight parts of a state, of what a function makes of it, or of a duration.
using Parts = Eigen::MatrixXd;

class Expansion {
 public:
  Expansion(const DefiningSystem& system, const Orbit& x, const NodalParts& parts, int m)
      : system_(system), x_(x), parts_(parts), m_(m), n_(x.shape.dimension), rule_(x.shape.collocation) {}

  Eigen::VectorXd rows() {
    rows_.resize(static_cast<Eigen::Index>(n_) * x_.shape.columns() + x_.shape.segments);
    for (int s = 0; s < x_.shape.segments; ++s) {
      put_collocation(s);
      put_ends(s);
    }
    return rows_;
  }

 private:
  const IndexVector& index(int s) const { return system_.signature()[static_cast<std::size_t>(s)]; }

  /// The state of a node (of all segments) in part k, null where that is zero.
  const double* node(int k, Eigen::Index column) const {
    if (k == 0) return x_.states.col(column).data();
    const Eigen::VectorXd* const part = parts_[static_cast<std::size_t>(k)];
    return part == nullptr ? nullptr : part->data() + column * n_;
  }
  double duration(int k, int s) const {
    if (k == 0) return x_.duration(s);
    const Eigen::VectorXd* const part = parts_[static_cast<std::size_t>(k)];
    return part == nullptr ? 0.0 : (*part)(part->size() - x_.shape.segments + s);
  }

  Parts evaluate(FunctionKind kind, int number, const Parts& states) const {
    Parts values(system_.system().rows(kind), 8);
    system_.system().third(kind, number, states.data(), x_.par.data(), values.data());
    return values;
  }

  void put_collocation(int s) {
    Parts states = Parts::Zero(n_, 8);
    for_each_gauss_point(x_, rule_, s, [&](int j, int g, double h, double) {
      const Eigen::Index first = x_.shape.first_node(s) + static_cast<Eigen::Index>(j) * rule_.points();
      Eigen::VectorXd row = Eigen::VectorXd::Zero(n_);
      states.setZero();
      for (int k = 0; k < 8; ++k)
        for (int i = 0; i <= rule_.points(); ++i) {
          const double* const from = node(k, first + i);
          if (from == nullptr) break;
          const Eigen::Map<const Eigen::VectorXd> state(from, n_);
          states.col(k) += rule_.value(g, i) * state;
          if (k == m_) row += rule_.slope(g, i) * state;
        }
      const Parts field = evaluate(FunctionKind::field, index(s).field, states);
      for (int k = 0; k < 8; ++k)
        if ((k & m_) == k) row -= h * duration(k, s) * field.col(m_ - k);
      put(row);
    });
  }

  void put_ends(int s) {
    Parts states = Parts::Zero(n_, 8);
    for (int k = 0; k < 8; ++k)
      if (const double* const end = node(k, x_.shape.last_node(s)))
        states.col(k) = Eigen::Map<const Eigen::VectorXd>(end, n_);
    if (system_.has_event(s)) {
      put(evaluate(FunctionKind::event, index(s).event, states).col(m_));
    } else {  // the plane goes through x_s(1)
      Eigen::VectorXd gradient(n_);
      system_.section_gradient(s, x_.end(s), x_.par.data(), gradient.data());
      put(Eigen::VectorXd::Constant(1, gradient.dot(states.col(m_))));
    }
    Parts jump = evaluate(FunctionKind::jump, index(s).jump, states);
    system_.clear_absent(s, jump.data(), 8);
    Eigen::VectorXd row = -jump.col(m_);
    if (const double* const next = node(m_, x_.shape.first_node((s + 1) % x_.shape.segments)))
      row += Eigen::Map<const Eigen::VectorXd>(next, n_);
    put(row);
  }

  void put(const Eigen::VectorXd& row) {
    rows_.segment(next_, row.size()) = row;
    next_ += row.size();
  }

  const DefiningSystem& system_;
  const Orbit& x_;
  const NodalParts& parts_;
  int m_;
  int n_;
  CollocationRule rule_;
  Eigen::VectorXd rows_;
  Eigen::Index next_ = 0;
};

}  // namespace

Eigen::VectorXd NodalExpansion::part(const Orbit& x, const NodalParts& parts, int m) const {
  return Expansion(system_, x, parts, m).rows();
}

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
