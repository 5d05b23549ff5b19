/// Location of a zero of a test function on the arclength of one continuation step.
#pragma once

#include <functional>
#include <optional>

namespace tchat {

struct LocatedZero {
  double ds = 0.0;     ///< arclength from the start of the step
  double value = 0.0;  ///< test function there
  int evaluations = 0;
  bool converged = false;  ///< the bracket is smaller than the tolerance, or the value is zero to rounding
};

/// `function(ds)` makes a full continuation step of length ds and returns the test function there, or nothing when the
/// step fails. The bracket is [0, ds] with values f0 and f1 of opposite sign. Boost's TOMS 748 (safeguarded,
/// superlinear) until the bracket is shorter than `tolerance`, at most `max_evaluations` evaluations. A failed step
/// ends the search: with the best point so far when that is about as near to the zero as the tolerance.
LocatedZero locate_zero(const std::function<std::optional<double>(double)>& function, double ds, double f0, double f1,
                        double tolerance, double rounding_level, int max_evaluations);

}  // namespace tchat
