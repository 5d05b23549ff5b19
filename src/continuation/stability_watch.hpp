/// Changes of the number of unstable multipliers along a branch that no label explains.
#pragma once

#include <optional>

#include "continuation/branch.hpp"

namespace tchat {

struct UnlabelledChange {
  LostPoint point;
  bool is_through_one;  ///< of one real multiplier: on a curve that holds monitors that need not be a special point
};

class StabilityWatch {
 public:
  /// An accepted point.
  struct Point {
    int number;
    double parameter;  ///< the principal one
    const SpecialPoint& special;
    const FloquetMultipliers& multipliers;
  };

  /// Points before it are forgotten.
  void begin(const Point& point);

  /// The change since the last point whose multipliers are known. Nothing where there is none, where a bifurcation or
  /// an impact velocity through zero is labelled in between, or `is_reported`: a special point that may be missing is.
  std::optional<UnlabelledChange> add(const Point& point, bool is_reported);

 private:
  void remember(const Point& point);

  struct Known {
    double parameter;
    FloquetMultipliers multipliers;
  };
  std::optional<Known> known_;
};

}  // namespace tchat
