/// PAR: the problem's parameters and the segment durations in one vector, as users and files number them.
#pragma once

#include <Eigen/Core>
#include <utility>

#include "model/parameter_layout.hpp"

namespace tchat {

/// PAR(k) is par(k - 1); unused ones are zero. The vector of an orbit has room for its durations and for monitors, any
/// other one has the room of an orbit of one segment. The vector knows which of its entries are durations.
class ParameterVector : public Eigen::VectorXd {
 public:
  /// No entries.
  ParameterVector() = default;
  /// Zeros, with room for an orbit of `segments` segments.
  explicit ParameterVector(const ParameterLayout& layout, int segments = 1)
      : Eigen::VectorXd(Eigen::VectorXd::Zero(layout.room(segments))), layout_(layout) {}
  /// These values.
  ParameterVector(const ParameterLayout& layout, Eigen::VectorXd values)
      : Eigen::VectorXd(std::move(values)), layout_(layout) {}
  /// New values of the same layout.
  template <class Values>
  ParameterVector& operator=(const Eigen::MatrixBase<Values>& values) {
    Eigen::VectorXd::operator=(values);
    return *this;
  }

  const ParameterLayout& layout() const { return layout_; }

  double duration(int s) const { return (*this)(layout_.duration(s) - 1); }
  double& duration(int s) { return (*this)(layout_.duration(s) - 1); }
  /// The durations of `count` segments from segment s on.
  auto durations(int count, int s = 0) { return segment(layout_.duration(s) - 1, count); }
  auto durations(int count, int s = 0) const { return segment(layout_.duration(s) - 1, count); }
  /// Sets durations and what is behind them to zero.
  void clear_durations() { tail(size() - layout_.first_duration() + 1).setZero(); }

  double rotation() const { return (*this)(layout_.rotation() - 1); }
  double& rotation() { return (*this)(layout_.rotation() - 1); }

  /// Resizes the vector for an orbit of `segments` segments; new entries are zero.
  void make_room(int segments) {
    const Eigen::Index before = size();
    if (before == layout_.room(segments)) return;
    conservativeResize(layout_.room(segments));
    if (size() > before) tail(size() - before).setZero();
  }

 private:
  ParameterLayout layout_;
};

}  // namespace tchat
