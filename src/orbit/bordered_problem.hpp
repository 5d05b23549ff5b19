/// The square problem that Newton's method solves for a point of a branch: the defining system, its integral conditions
/// and the monitors that are held among the border rows, a condition of a few numbers on the whole orbit (a
/// critical multiplier) or none, and one row of the branch (pseudo-arclength, or a fixed parameter).
///
///     J dx = -F,    grad I . dx = -I,    grad G . dx = -G,    row . dx = target       (n m N c + ... + m + q
///     equations)
///
/// The branch's row and the gradients of G reach into all intervals, and would be eliminated from each; and those of G
/// are known only after J has been condensed. So J is closed by rows at the ends of segments, which cost nothing there
/// (CondensedSystem): one for the branch's row, one for each number of G. With the null vectors Z that all other rows
/// leave, and a solution y,
///
///     dx = y + Z b,    (grad G . Z) b = -G - grad G . y    and    row . Z b = target - row . y
///
/// What G leaves of Z is the tangent t = Z a, a the vector product of the rows of grad G . Z (its entries are the
/// determinants without one column, with alternating signs); row . t is then the determinant of all rows on Z.
///
/// A condition is found by iteration from where it was last: which multiplier it means, and the border of its own
/// problem. A trial of Newton's method that fails leaves these anywhere. They belong to the point of the branch that
/// the trial began from, and are brought back (`recall`) before the next one.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "orbit/condensed_system.hpp"
#include "orbit/defining_system.hpp"

namespace tchat {

class Monitor;

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
  /// One for linearize() and correct() alone, without entries for the collocation rows.
  OrbitResidual make_residual_of_ends() const;

  /// Old factors may be used for another point: not with a condition, whose value comes with the factors.
  bool allows_chord() const { return condition_ == nullptr; }

  /// Overwrites `memory`, whose space is used again.
  void remember(ConditionMemory& memory) const;
  void recall(const ConditionMemory& memory);

  /// The orbit that integral conditions compare phases with, on the mesh of those that follow. Copied.
  void set_reference(const Orbit& x);
  Linearization linearize(const Orbit& x, const OrbitVector& row, OrbitResidual& residual);
  void evaluate(const Orbit& x, OrbitResidual& residual);
  /// Newton's correction, all conditions to zero, row . dx = target; false when the row is exactly orthogonal to the
  /// tangent.
  bool solve(const OrbitResidual& residual, const OrbitVector& row, double target, OrbitVector& dx);
  /// The same where the residual is that of the last linearisation; the tangent is found on the way.
  bool correct(const OrbitResidual& linearized, const OrbitVector& row, double target, OrbitVector& dx);
  /// All conditions to zero, where there is none of a curve; dx has any component along the tangent.
  void solve_across(const OrbitResidual& residual, OrbitVector& dx);
  /// What all conditions, but for the row, leave, of any length; until the next linearisation, or this is asked again.
  const OrbitVector& tangent();
  /// The sign of row . tangent(), 1 where it is zero. After a linearisation all rows, those of corrections among them,
  /// must grow in one direction of the branch: once found the sign is that of all.
  double tangent_sign(const OrbitVector& row);
  /// CondensedSystem::signed_distance(), with the sign that the determinant has with the branch's row and the
  /// condition's gradients themselves; with a condition times the length of a for gradients of unit size, which is zero
  /// where they leave more than the tangent. 0 where the last linearisation was singular, NaN where it failed
  /// otherwise. Allocates.
  double signed_distance(const OrbitVector& row);
  /// CondensedSystem::singularity() with row and gradients in place of the closing rows of a condition.
  CondensedSystem::Singularity singularity(const OrbitVector& row);
  /// What stands for this row of a branch, on v, of orbits of this shape.
  static double at_ends(const OrbitShape& shape, const OrbitVector& row, const OrbitVector& v);
  /// Largest residual, the condition's included.
  double residual_size(const OrbitResidual& residual) const;

 private:
  template <int Rows, int Columns>
  using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Rows, Columns>;
  static constexpr int most_null_vectors = OrbitCondition::most + 1;
  using Numbers = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_null_vectors, 1>;

  void close(const OrbitShape& shape, const OrbitVector& row);
  Numbers on_null_vectors(const OrbitVector& row) const;
  double size_on_null_vectors(const OrbitVector& row) const;
  void find_null_vectors();
  void measure_null_vectors();
  bool put_on_branch(const OrbitVector& row, double target, OrbitVector& dx);
  Numbers across(const OrbitVector& dx) const;
  Numbers dual_slope(int k) const;
  void add_null_vectors(const Numbers& shares, OrbitVector& dx) const;
  void combine_null_vectors(const Numbers& shares, OrbitVector& v) const;
  int conditions() const { return condition_ ? condition_->count() : 0; }
  /// The border's right-hand side with minus these in the rows of the integrals, zero in the others.
  std::span<const double> border(const std::vector<double>& integrals);

  CondensedSystem condensed_;
  std::unique_ptr<OrbitCondition> condition_;
  std::vector<HeldMonitor> held_;
  EndVector closing_;                   // from it, where there is no condition
  std::vector<OrbitVector> gradients_;  // of integrals and held monitors
  std::vector<double> border_;          // right-hand side of all these
  Orbit reference_;                     // only where there are integrals

  // of the last linearisation
  Linearization outcome_ = Linearization::not_finite;
  std::vector<OrbitVector> null_vectors_;  // Z, found when they are asked for
  bool null_vectors_known_ = false;
  Small<OrbitCondition::most, most_null_vectors> slopes_;  // grad G . Z
  Numbers along_;                                          // a
  std::optional<double> row_along_;                        // row . t
  OrbitVector tangent_;                                    // t where there is a condition
};

}  // namespace tchat
