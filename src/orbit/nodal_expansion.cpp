#include "orbit/nodal_expansion.hpp"

#include "orbit/gauss_points.hpp"

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

}  // namespace tchat
