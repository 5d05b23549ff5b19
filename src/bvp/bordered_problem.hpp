/// The square problem that Newton's method solves for a point of a branch: the defining system, its integral conditions
/// among the border rows, at most one scalar condition on the whole orbit (a critical multiplier), and one row of the
/// branch (pseudo-arclength, or a fixed parameter).
///
///     J dx = -F,    grad I . dx = -I,    grad G . dx = -G,    row . dx = target       (n m N c + ... + m + q
///     equations)
///
/// The gradient of an integral I is known before J is factored. That of G is known only after J has been condensed. So
/// J is condensed with a stand-in for it, the gradient of the last linearisation, and the true gradient enters by a
/// rank-one correction: one more solution of the same factors.
///
/// A condition is found by iteration from where it was last: which multiplier it means, and the border of its own
/// problem. A trial of Newton's method that fails leaves these anywhere. They belong to the point of the branch that
/// the trial began from, together with the stand-in, and are brought back (`recall`) before the next one.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bvp/condensed_system.hpp"

namespace tchat {

/// A scalar G of the orbit, durations and free parameters with its gradient.
class OrbitCondition {
 public:
  virtual ~OrbitCondition() = default;
  /// G and its gradient at x, whose linearisation is in `condensed`. False when they cannot be found.
  virtual bool evaluate(CondensedSystem& condensed, const Orbit& x) = 0;
  virtual double value() const = 0;
  virtual const OrbitVector& gradient() const = 0;
  /// The multiplier that is kept exactly, where it is one number: 1 or -1.
  virtual std::optional<int> kept_multiplier() const { return std::nullopt; }
  /// "" on the curve, or why the last point, which solves the equations, lies beyond its end.
  virtual std::string beyond_end() const { return {}; }

  /// What evaluations near the point of the last one begin from; `memory` is overwritten, empty before the first one.
  virtual void remember(std::vector<double>& memory) const = 0;
  virtual void recall(const std::vector<double>& memory) = 0;
};

/// What linearisations near a point of the branch begin from; empty without a condition.
struct ConditionMemory {
  std::vector<double> condition;
  OrbitVector stand_in;
};

class BorderedProblem {
 public:
  /// `condition` may be null. The defining system must outlive this object; with R coupling rows and I integral
  /// conditions n m + m + q = R + I + 1, or R + I + 2 with a condition.
  BorderedProblem(const DefiningSystem& system, const OrbitShape& shape, std::unique_ptr<OrbitCondition> condition);

  CondensedSystem& condensed() { return condensed_; }
  const CondensedSystem& condensed() const { return condensed_; }
  const DefiningSystem& system() const { return condensed_.system(); }
  OrbitCondition* condition() { return condition_.get(); }

  /// Old factors may be used for another point: not with a condition, whose value comes with the factors.
  bool allows_chord() const { return condition_ == nullptr; }

  /// Overwrites `memory`, whose space is used again.
  void remember(ConditionMemory& memory) const;
  void recall(const ConditionMemory& memory);

  /// The orbit that integral conditions compare phases with, on the mesh of those that follow. Copied.
  void set_reference(const Orbit& x);
  Linearization linearize(const Orbit& x, const OrbitVector& row, OrbitResidual& residual);
  void evaluate(const Orbit& x, OrbitResidual& residual);
  /// Newton's correction: all conditions to zero, row . dx = target.
  void solve(const OrbitResidual& residual, double target, OrbitVector& dx);
  /// All conditions unchanged, row . dx = target.
  void solve(double target, OrbitVector& dx);
  /// Largest residual, the condition's included.
  double residual_size(const OrbitResidual& residual) const;

 private:
  void correct(double condition_target, OrbitVector& dx) const;
  OrbitVector& stand_in() { return rows_.back(); }
  const OrbitVector& stand_in() const { return rows_.back(); }
  /// The border's right-hand side with these in the branch's row and that of the stand-in, the integrals' in between.
  std::span<const double> border(double branch, const std::vector<double>& integrals, double stand_in);

  CondensedSystem condensed_;
  std::unique_ptr<OrbitCondition> condition_;
  std::vector<OrbitVector> rows_;  // the branch's row, the integrals' gradients and the stand-in for that of G
  std::vector<double> border_;     // right-hand side of these
  std::vector<double> unchanged_;  // integrals that keep their values
  Orbit reference_;                // only where there are integrals
  OrbitVector response_;           // solution for a unit in the stand-in's row
  double response_slope_ = 1.0;    // grad G . response
};

}  // namespace tchat
