/// The square problem that Newton's method solves for a point of a branch: the defining system, its integral conditions
/// and the monitors that are held among the border rows, a condition of one or two numbers on the whole orbit (a
/// critical multiplier) or none, and one row of the branch (pseudo-arclength, or a fixed parameter).
///
///     J dx = -F,    grad I . dx = -I,    grad G . dx = -G,    row . dx = target       (n m N c + ... + m + q
///     equations)
///
/// The gradients of integrals I and of monitors are few, and rows of the matrix like others. That of G is known only
/// after J has been condensed, and the row of the branch, too, would only cost work in every interval. So J is factored
/// without them (CondensedSystem closes it with rows of its own): 1 + C null vectors v remain, and they are added to
/// any solution so that
///
///     row . dx = target,    grad G . dx = -G                                            (1 + C equations)
///
/// A condition is found by iteration from where it was last: which multiplier it means, and the border of its own
/// problem. A trial of Newton's method that fails leaves these anywhere. They belong to the point of the branch that
/// the trial began from, and are brought back (`recall`) before the next one.
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
  static constexpr int most = 2;  // numbers

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

/// What evaluations of a condition near a point of the branch begin from; empty without one.
using ConditionMemory = std::vector<double>;

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
  Linearization linearize(const Orbit& x, const OrbitVector& row, OrbitResidual& residual);
  void evaluate(const Orbit& x, OrbitResidual& residual);
  /// Newton's correction at the point of the last linearisation: all conditions to zero, row . dx = target.
  void correction(double target, OrbitVector& dx) const;
  /// The same with another residual and perhaps another row: a chord iteration. Not with a condition.
  void chord(const OrbitResidual& residual, const OrbitVector& row, double target, OrbitVector& dx);
  /// All conditions unchanged, row . dx = 1.
  void tangent(OrbitVector& dx) const;
  /// The determinant's sign, of J with all rows, times the distance to a singular matrix (CondensedSystem), where there
  /// is a condition also to one whose rows do not tell null vectors apart. Allocates.
  double signed_distance() const;
  /// Largest residual, the condition's included.
  double residual_size(const OrbitResidual& residual) const;

 private:
  static constexpr int most_rows = 1 + OrbitCondition::most;
  using Numbers = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_rows, 1>;
  using Slopes = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_rows, most_rows>;

  /// The branch's row, or the gradients of G.
  const OrbitVector& late_row(int k) const { return k == 0 ? row_ : condition_->gradient(k - 1); }
  bool find_slopes();
  std::span<const double> border(const std::vector<double>& integrals);
  void combine(double particular, const Numbers& wanted, OrbitVector& dx) const;

  CondensedSystem condensed_;
  std::unique_ptr<OrbitCondition> condition_;
  std::vector<HeldMonitor> held_;
  std::vector<OrbitVector> rows_;          // gradients of integrals and held monitors
  std::vector<double> border_;             // right-hand side of these
  Orbit reference_;                        // only where there are integrals
  OrbitVector row_;                        // of the branch
  OrbitVector particular_;                 // a solution for the residual of the last linearisation
  std::vector<OrbitVector> null_vectors_;  // 1 + C
  Slopes slopes_;                          // late rows . null vectors
  Eigen::PartialPivLU<Slopes> slopes_lu_;
};

}  // namespace tchat
