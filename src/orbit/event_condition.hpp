/// Defining condition of curves of two events at once: an event function vanishes at one end of a segment,
///
///     G(x) = h_e(x_s(0), p)     or     G(x) = h_e(x_s(1), p),
///
/// besides what ends the segments there. One condition more than a periodic orbit has, so that a second parameter is
/// free: n m + m + 2 unknowns besides the collocated functions, n m + m + 1 conditions and pseudo-arclength.
#pragma once

#include "orbit/orbit_condition.hpp"

namespace tchat {

class DefiningSystem;

class EventCondition final : public OrbitCondition {
 public:
  /// `segment` counts from 0. h_e must not vanish there for every orbit of the signature.
  EventCondition(const DefiningSystem& system, const OrbitShape& shape, int segment, int event, bool at_end);

  bool evaluate(CondensedSystem& condensed, const Orbit& x) override;
  double value(int = 0) const override { return value_; }
  const OrbitVector& gradient(int = 0) const override { return gradient_; }
  /// Nothing is found by iteration.
  void remember(std::vector<double>& memory) const override { memory.clear(); }
  void recall(const std::vector<double>&) override {}

 private:
  const DefiningSystem& system_;
  int segment_;
  int event_;
  bool at_end_;
  int column_ = 0;  // of the gradient that is not zero
  double value_ = 0.0;
  OrbitVector gradient_;
};

}  // namespace tchat
