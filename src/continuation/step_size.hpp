/// Step length control of pseudo-arclength continuation (DS, DSMIN, DSMAX, IADS), with AUTO's rules.
#pragma once

namespace tchat {

struct StepSettings {
  double initial = 0.01;  ///< DS, signed
  double minimum = 0.0;   ///< DSMIN
  double maximum = 0.1;   ///< DSMAX
  int adapt_every = 1;    ///< IADS; 0 keeps the step fixed
  int max_newton = 8;     ///< ITNW
};

class StepSize {
 public:
  explicit StepSize(const StepSettings& settings);

  double value() const { return ds_; }

  /// Much shorter than both the first and the largest step: no reason to halve for the sake of test functions.
  bool is_short() const;

  /// Is the length due for adaptation after point number `point`?
  bool adapts_at(int point) const;
  bool is_longest() const;
  /// What converged() makes of the length.
  double after(int iterations) const;

  /// After point number `point` converged in `iterations`: grow or shrink by the work it took, not beyond DSMAX.
  ///     iterations <= 1: x 2;  2: x 1.5;  3..ITNW/2: x 1.1;  >= ITNW: x 0.5;  otherwise unchanged
  void converged(int iterations, int point);

  /// After a failure: halve. False when the step is fixed or would fall below the minimum: the branch ends.
  bool failed();

  /// DSMIN, but never below 1e-10 max(|DS|, DSMAX).
  double smallest() const;

 private:
  StepSettings settings_;
  double ds_;
};

}  // namespace tchat
