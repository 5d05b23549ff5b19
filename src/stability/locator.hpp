/// Location of a zero of a test function on the arclength of one continuation step.
#pragma once

#include <cmath>
#include <functional>
#include <optional>

namespace tchat {

/// Two places on the step, in its direction, between which the function changes sign.
struct SignChange {
  double low = 0.0;
  double high = 0.0;
  double low_value = 0.0;
  double high_value = 0.0;

  double length() const { return std::abs(high - low); }
  double change() const { return std::abs(high_value - low_value); }
  /// A place in between, where the function has `value`, takes the place of one of the ends.
  void narrow(double at, double value) {
    if (value * low_value > 0.0)
      low = at, low_value = value;
    else
      high = at, high_value = value;
  }
};

enum class ZeroSearch {
  located,        ///< the bracket is smaller than the tolerance, or the value is zero to rounding
  jump,           ///< the sign changes at a jump or a pole: there is no zero
  out_of_trials,  ///< the bracket is still larger
  step_failed     ///< a step did not converge, or the function has no value there
};

struct LocatedZero {
  double ds = 0.0;     ///< arclength from the start of the step
  double value = 0.0;  ///< test function there
  int evaluations = 0;
  ZeroSearch status = ZeroSearch::out_of_trials;
  SignChange bracket;  ///< the narrowest that is known
  bool converged() const { return status == ZeroSearch::located; }
};

/// `function(ds)` makes a full continuation step of length ds and returns the test function there, or nothing when the
/// step fails. The bracket is [0, ds] with values f0 and f1 of opposite sign, however small. Boost's TOMS 748
/// (safeguarded, superlinear) until the bracket is shorter than `tolerance`, at most `max_evaluations` evaluations. A
/// failed step ends the search: with the best point so far when that is about as near to the zero as the tolerance.
LocatedZero locate_zero(const std::function<std::optional<double>(double)>& function, double ds, double f0, double f1,
                        double tolerance, double rounding_level, int max_evaluations);

/// The same from one place of a step to another, as often as it takes: where the trials do not suffice or a step fails,
/// once more on a half of what is left, divided where a step converges.
LocatedZero locate_zero_surely(const std::function<std::optional<double>(double)>& function, const SignChange& step,
                               double tolerance, double rounding_level, int max_evaluations);

/// A step over which the function changes sign has been narrowed to `bracket`, shorter than `tolerance`: is it a jump
/// or a pole, as the change there is no small share of the change over the step?
bool is_jump(const SignChange& step, const SignChange& bracket, double tolerance);

}  // namespace tchat
