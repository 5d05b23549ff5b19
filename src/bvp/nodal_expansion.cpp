#include "bvp/nodal_expansion.hpp"

#include "bvp/gauss_points.hpp"

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
      put(Eigen::VectorXd::Constant(1, m_ == 0 ? 0.0 : gradient.dot(states.col(m_))));
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

/// A direction in which an orbit and its first free parameter change.
struct Direction {
  const Eigen::VectorXd& entries;
  const OrbitShape& shape;

  auto node(Eigen::Index column) const { return entries.segment(column * shape.dimension, shape.dimension); }
  double duration(int s) const { return entries(entries.size() - 1 - shape.segments + s); }
  double parameter() const { return entries(entries.size() - 1); }
};

/// The second derivative in the directions u and v: with F' and F'' of a function at a point,
///
///     -h (T F'' + T_u F' v + T_v F' u)  at the Gauss points,     h'',     -g''.
class SecondWithParameter {
 public:
  SecondWithParameter(const DefiningSystem& system, const Orbit& x, const Eigen::VectorXd& u, const Eigen::VectorXd& v)
      : system_(system),
        x_(x),
        u_{u, x.shape},
        v_{v, x.shape},
        n_(x.shape.dimension),
        q_(system.free_count()),
        rule_(x.shape.collocation) {}

  Eigen::VectorXd rows() {
    Eigen::VectorXd rows =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n_) * x_.shape.columns() + x_.shape.segments);
    Eigen::Index next = 0;
    for (int s = 0; s < x_.shape.segments; ++s) {
      const IndexVector& index = system_.signature()[static_cast<std::size_t>(s)];
      for_each_gauss_point(x_, rule_, s, [&](int j, int g, double h, double) {
        const Eigen::Index first = x_.shape.first_node(s) + static_cast<Eigen::Index>(j) * rule_.points();
        Eigen::VectorXd state = Eigen::VectorXd::Zero(n_), a = state, b = state;
        for (int i = 0; i <= rule_.points(); ++i) {
          state += rule_.value(g, i) * x_.states.col(first + i);
          a += rule_.value(g, i) * u_.node(first + i);
          b += rule_.value(g, i) * v_.node(first + i);
        }
        evaluate(FunctionKind::field, index.field, state.data(), a, b);
        rows.segment(next, n_) = -h * (x_.duration(s) * second_ + u_.duration(s) * by_v_ + v_.duration(s) * by_u_);
        next += n_;
      });
      const Eigen::VectorXd a = u_.node(x_.shape.last_node(s)), b = v_.node(x_.shape.last_node(s));
      if (system_.has_event(s)) {  // a plane across the flow is linear
        evaluate(FunctionKind::event, index.event, x_.end(s), a, b);
        rows(next) = second_(0);
      }
      evaluate(FunctionKind::jump, index.jump, x_.end(s), a, b);
      system_.clear_absent(s, second_.data(), 1);
      rows.segment(next + 1, n_) = -second_;
      next += 1 + n_;
    }
    return rows;
  }

 private:
  void evaluate(FunctionKind kind, int number, const double* state, const Eigen::VectorXd& a,
                const Eigen::VectorXd& b) {
    const HybridSystem& hybrid = system_.system();
    const int r = hybrid.rows(kind);
    Eigen::VectorXd direction = Eigen::VectorXd::Zero(n_ + q_);
    direction.head(n_) = a;
    direction(n_) = u_.parameter();
    Eigen::MatrixXd by_state(r, n_), by_parameter(r, q_);
    by_u_.resize(r);
    hybrid.first(kind, number, state, x_.par.data(), system_.free_parameters(), by_u_.data(), by_state.data(),
                 by_parameter.data());
    by_v_ = by_state * b + by_parameter.col(0) * v_.parameter();
    hybrid.second(kind, number, state, x_.par.data(), system_.free_parameters(), direction.data(), by_u_.data(),
                  by_state.data(), by_parameter.data());
    second_ = by_state * b + by_parameter.col(0) * v_.parameter();
  }

  const DefiningSystem& system_;
  const Orbit& x_;
  Direction u_, v_;
  int n_;
  int q_;
  CollocationRule rule_;
  Eigen::VectorXd by_u_, by_v_, second_;  // F' u, F' v, F'' of the last point
};

}  // namespace

Eigen::VectorXd NodalExpansion::second_with_parameter(const Orbit& x, const Eigen::VectorXd& u,
                                                      const Eigen::VectorXd& v) const {
  return SecondWithParameter(system_, x, u, v).rows();
}

Eigen::VectorXd NodalExpansion::part(const Orbit& x, const NodalParts& parts, int m) const {
  return Expansion(system_, x, parts, m).rows();
}

}  // namespace tchat
