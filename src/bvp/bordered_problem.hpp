/// The square problem that Newton's method solves for a point of a branch: the defining system, its integral conditions
/// and the monitors that are held among the border rows, a condition of one or two numbers on the whole orbit (a
/// critical multiplier) or none, and one row of the branch (pseudo-arclength, or a fixed parameter).
///
///     J dx = -F,    grad I . dx = -I,    grad G . dx = -G,    row . dx = target       (n m N c + ... + m + q
///     equations)
///
/// The branch's row and the gradients of G reach into all intervals, and would be eliminated from each; and that of G
/// is known only after J has been condensed. What stands for them has entries at the ends of segments only, and costs
/// nothing there (CondensedSystem): those of the row, and those that the gradients had at the last linearisation. Any
/// rows serve that tell the vectors apart that all other rows annihilate: the true gradients enter by a correction of
/// rank one for each number, a solution of the same factors, and the row itself along the tangent t,
///
///     dx = y + (target - row . y) / (row . t) t,
///
/// which is wanted anyway.
///
/// A condition is found by iteration from where it was last: which multiplier it means, and the border of its own
/// problem. A trial of Newton's method that fails leaves these anywhere. They belong to the point of the branch that
/// the trial began from, together with the stand-ins, and are brought back (`recall`) before the next one.
#pragma once

#include <Eigen/LU>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bvp/condensed_system.hpp"
#include "bvp/monitor.hpp"

namespace tchat {

/// A function G of the orbit, durations and free parameters, of one number or two, with its gradients.
class OrbitCondition {
 public:
  static constexpr int most = 2;

  virtual ~OrbitCondition() = default;
  /// How many numbers; constant.
  virtual int count() const { return 1; }
  /// G and its gradients at x, whose linearisation is in `condensed`. False when they cannot be found.
  virtual bool evaluate(CondensedSystem& condensed, const Orbit& x) = 0;
  /// Of number k = 0 .. count() - 1.
  virtual double value(int k) const = 0;
  virtual const OrbitVector& gradient(int k) const = 0;
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
  std::vector<EndVector> stand_ins;
};

/// A monitor that keeps this value.
struct HeldMonitor {
  std::shared_ptr<const Monitor> monitor;
  double value = 0.0;
  std::string name;  ///< for messages
};

class BorderedProblem {
 public:
  /// `condition` may be null. The defining system must outlive this object; with R coupling rows, I integral
  /// conditions, H monitors held and a condition of C numbers n m + m + q = R + I + H + C + 1. `threads`: see
  /// CondensedSystem.
  BorderedProblem(const DefiningSystem& system, const OrbitShape& shape, std::unique_ptr<OrbitCondition> condition,
                  std::vector<HeldMonitor> held = {}, int threads = 1);

  CondensedSystem& condensed() { return condensed_; }
  const CondensedSystem& condensed() const { return condensed_; }
  const DefiningSystem& system() const { return condensed_.system(); }
  const std::vector<HeldMonitor>& held() const { return held_; }
  OrbitCondition* condition() { return condition_.get(); }

  /// Zero, with an entry for each integral condition and each held monitor in `integral`.
  OrbitResidual make_residual() const;

  /// Old factors may be used for another point: not with a condition, whose value comes with the factors.
  bool allows_chord() const { return condition_ == nullptr; }

  /// Overwrites `memory`, whose space is used again.
  void remember(ConditionMemory& memory) const;
  void recall(const ConditionMemory& memory);

  /// The orbit that integral conditions compare phases with, on the mesh of those that follow. Copied.
  void set_reference(const Orbit& x);
  /// `row` is copied.
  Linearization linearize(const Orbit& x, const OrbitVector& row, OrbitResidual& residual);
  void evaluate(const Orbit& x, OrbitResidual& residual);
  /// Newton's correction, all conditions to zero, row . dx = target; false when the row is exactly orthogonal to the
  /// tangent.
  bool solve(const OrbitResidual& residual, double target, OrbitVector& dx);
  /// The same where the residual is that of the last linearisation; the tangent is found on the way.
  bool correct(const OrbitResidual& linearized, double target, OrbitVector& dx);
  /// All conditions to zero; dx has any component along the tangent.
  void solve_across(const OrbitResidual& residual, OrbitVector& dx);
  /// All conditions unchanged, row . dx > 0 (if it is not zero).
  void find_tangent(OrbitVector& dx);
  /// CondensedSystem::signed_distance(), with the sign that the determinant has with the branch's row and the
  /// condition's gradients themselves, and zero where these do not reach what J leaves open.
  double signed_distance();
  /// What stands for this row of a branch, on v.
  double at_ends(const OrbitVector& row, const OrbitVector& v) const;
  /// Largest residual, the condition's included.
  double residual_size(const OrbitResidual& residual) const;

 private:
  using Numbers = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, OrbitCondition::most, 1>;
  using Slopes = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, OrbitCondition::most, OrbitCondition::most>;

  void close(const OrbitVector& row, EndVector& closing) const;
  bool find_responses();
  void follow_gradients();
  Numbers minus_condition() const;
  void add_responses(Numbers wanted, OrbitVector& dx) const;
  void know_tangent();
  void complete_tangent();
  bool put_along(double target, OrbitVector& dx) const;
  int conditions() const { return condition_ ? condition_->count() : 0; }
  EndVector& stand_in(int k) { return closing_[1 + static_cast<std::size_t>(k)]; }
  double slope_cosine() const;
  /// The border's right-hand side with minus these in the rows of the integrals, zero in the others.
  std::span<const double> border(const std::vector<double>& integrals);

  CondensedSystem condensed_;
  std::unique_ptr<OrbitCondition> condition_;
  std::vector<HeldMonitor> held_;
  OrbitVector row_;                 // the branch's
  std::vector<EndVector> closing_;  // what stands for it, and for the gradients of G
  EndVector next_stand_in_;
  std::vector<OrbitVector> gradients_;  // of integrals and held monitors
  std::vector<double> border_;          // right-hand side of all these
  Orbit reference_;                     // only where there are integrals
  std::vector<OrbitVector> responses_;  // solutions for a unit in the row of each stand-in
  Eigen::PartialPivLU<Slopes> slopes_;  // of grad G . responses
  OrbitVector tangent_;
  bool tangent_known_ = false;       // that of the last linearisation, and not yet taken
  std::optional<double> row_along_;  // row_ . tangent_ of the last linearisation, taken or not
};

}  // namespace tchat
