/// Multipliers of points, functions of them whose zeros are special points, the location of zeros, and the evidence
/// that a label needs.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "orbit/event_minima.hpp"
#include "orbit/orbit.hpp"
#include "settings/point_type.hpp"

namespace tchat {

// The multipliers of a point of a branch, however they are computed.

/// What is printed for a multiplier that is infinite (grazing) or too large for files.
inline constexpr double infinite_multiplier = 1e99;

/// det(1 - t M) a_1 ... a_m, see floquet_multipliers.hpp.
struct MultiplierProduct {
  double value = 0.0;
  /// What errors of the size `no_transversality` make of it where an a_s is about zero; 0 elsewhere.
  double uncertainty = 0.0;
};

enum class Stability { stable, unstable, unknown };

struct FloquetMultipliers {
  /// n multipliers, the structural zero among them: the one closest to 1 first, then by | |mu| - 1 |. Of an orbit
  /// without a section the trivial one stands before these, in place of the zero.
  std::vector<std::complex<double>> values;
  bool has_trivial = false;
  int of_conserved = 0;     ///< how many more are 1 on every orbit; they come after the trivial one
  double structural = 0.0;  ///< size of the structural zero, or distance of the trivial one from 1
  bool valid = false;       ///< false: not computed, or the eigenvalue iteration failed
  /// They are the eigenvalues of f_x at an equilibrium (equilibrium_tests.hpp): stable on the left of the
  /// imaginary axis.
  bool are_eigenvalues = false;
  /// Nontrivial multipliers that are left out of `values`: where h_x f = 0 they may be 0/0, and what comes out is
  /// noise.
  int undetermined = 0;
  /// So it may be where the orbit passes so near to an equilibrium that errors on the way there are all of the flow
  /// behind it: `undetermined` are left out for that, and `structural` says nothing of the mesh.
  bool is_flow_lost = false;
  bool is_mesh_coarse = false;  ///< so it may be as well where the mesh does not resolve the orbit
  bool is_at_border = false;    ///< or where impacts cease to accumulate, where their limit has no derivative
  int surely_outside = 0;       ///< of those left out: they are outside of the unit circle, wherever they are
  /// Of the others, relative to those beyond the unit circle, where it is more than the accuracy of orbits.
  double uncertainty = 0.0;
  MultiplierProduct with_one = {};        ///< t = 1: vanishes with a multiplier +1
  MultiplierProduct with_minus_one = {};  ///< t = -1: vanishes with a multiplier -1

  /// How many are the same for every orbit, besides the structural zero.
  int known() const { return (has_trivial ? 1 : 0) + of_conserved; }
  /// All but those; the structural zero is among them.
  std::span<const std::complex<double>> nontrivial() const {
    return std::span(values).subspan(std::min(values.size(), static_cast<std::size_t>(known())));
  }
  bool determined() const { return valid && undetermined == 0; }
  /// Leaves out all but those that are the same for every orbit.
  void leave_out();

  /// All |mu| <= 1 + 1e-5 of those that are known; of eigenvalues all real parts <= 0 but for rounding.
  bool stable() const;
  /// stable() where all are known, and none so near to the unit circle that its uncertainty decides.
  Stability stability() const;
  /// stable(), but a multiplier has the modulus 1 to its accuracy, and no symmetry or conserved function says why:
  /// neighbours neither approach nor leave to first order.
  bool neutral() const;
  int stable_count() const;
};

// Functions whose zeros along a branch are special points.
//
// All share one mechanism (special_point_search): evaluated at every accepted point, a change of sign over a step
// brackets a zero, the zero is located on the arclength of that step (locate_zero()), classified, labelled and
// written. A new kind of special point is one new class and the list that it is added to. Test functions are pure: the
// same point gives the same value.

class CondensedSystem;
class OrbitCondition;

/// What a test function may look at: a converged point and its linearisation.
struct TestedPoint {
  const Orbit& orbit;
  const OrbitVector& tangent;
  CondensedSystem& condensed;  ///< whose right-hand sides are scratch
  const FloquetMultipliers& multipliers;
  const std::vector<double>& transversalities;  ///< h_x f / (|h_x| |f|) at the end of each segment
  double singular_distance = 1.0;  ///< of the bordered problem to a singular one, with its determinant's sign
  const OrbitCondition* condition = nullptr;  ///< of a two-parameter curve, evaluated at this point
  double principal_rate = 0.0;                ///< by which the principal parameter grows along the tangent
  double principal_rate_size = 1.0;           ///< against which that is small
  /// Periodic orbits in one free parameter, nothing held: where the problem is singular a multiplier is +1.
  bool one_parameter_family = false;
  std::span<const EventCourse> courses = {};  ///< of the monitored event functions, as far as they are known
};

/// What a test function says of a point.
struct TestValue {
  std::optional<double> value;  ///< nothing where the function is not defined: an undefined value has no zero
  double zero_level = 0.0;      ///< the uncertainty of the value: |value| up to this counts as zero
  int sign = 0;  ///< of the value, 0 within the zero level; of an undefined one the sign that it stands for, 0: none

  /// Undefined where the value is not finite.
  static TestValue of(double value, double zero_level) {
    if (!std::isfinite(value)) return undefined();
    const bool is_zero = !(std::abs(value) > zero_level);  // of a level that is not known, too
    return {value, zero_level, is_zero ? 0 : value > 0.0 ? 1 : -1};
  }
  static TestValue undefined(int sign = 0) { return {std::nullopt, 0.0, sign}; }
};

/// How closely points must follow each other along a branch, that no change of sign is missed between them. A step is
/// shortened until they do.
enum class Resolution {
  crossings,  ///< the polynomial through the last values has no two zeros between two points
  trend,      ///< each value is about what the last ones let expect, and they do not come near to zero in between
  direction,  ///< near a zero the branch hardly turns within a step, for another one may cross it there
  any         ///< no step is shortened for it
};

/// What a point of the branch is; for a zero of a test function, what it found.
struct SpecialPoint {
  PointType type = PointType::ordinary;
  UserPointKind kind;  ///< for PointType::user
  bool ends_branch = false;
  std::string description;                  ///< one line for the d-file
  std::vector<UserPointKind> further = {};  ///< what else vanishes there
  std::string remark = {};                  ///< one line for the screen and the d-file; may be empty
};

class TestFunction {
 public:
  virtual ~TestFunction() = default;
  virtual std::string name() const = 0;
  virtual TestValue evaluate(const TestedPoint& point) const = 0;
  std::optional<double> value(const TestedPoint& point) const { return evaluate(point).value; }
  virtual Resolution resolution() const { return Resolution::crossings; }
  /// False at a zero that is none of the special points looked for: a factor that keeps the function regular vanishes.
  virtual bool is_genuine(const TestedPoint&) const { return true; }
  /// Why a located zero is no special point of this type, which the user is to know; "" where it may be one.
  virtual std::string objection(const TestedPoint&) const { return ""; }
  /// True when Newton's matrix is singular at the zeros, which are then located from both sides.
  virtual bool singular_at_zero() const { return false; }
  /// A part of the tangent, which may turn at a branch point where a curve turns back into itself.
  virtual bool is_of_tangent() const { return false; }
  /// True when the value is a sign alone: what is looked for is where it jumps.
  virtual bool is_switch() const { return false; }
  /// True when a zero is told of, but neither located nor labelled: the equations are singular there.
  virtual bool is_only_reported() const { return false; }
  /// Why the function is zero at every point of a branch, where that is known; `point` is one of them.
  virtual std::string reason_to_vanish(const TestedPoint&) const { return ""; }
  /// What else there is to know of a labelled point, in lines for the d-file; empty: nothing.
  virtual std::string details(const TestedPoint&) const { return ""; }
  /// The special point at a located zero; `rising` says which way the function went through it.
  virtual SpecialPoint classify(const TestedPoint& point, bool rising) const = 0;
};

using TestList = std::vector<std::unique_ptr<TestFunction>>;

// PAR(k) - v: points that the user asked for (UZR).

class UserValueTest final : public TestFunction {
 public:
  /// `name` is the parameter's name for messages; `stop` ends the branch there.
  UserValueTest(int parameter, double wanted, bool stop, std::string name)
      : parameter_(parameter), wanted_(wanted), stop_(stop), parameter_name_(std::move(name)) {}

  std::string name() const override;
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  int parameter_;
  double wanted_;
  bool stop_;
  std::string parameter_name_;
};

// What a label needs besides a change of sign: how well multipliers are known, and whether those of a located point
// agree with its type.
//
// A singular boundary value problem of periodic orbits in one parameter has a multiplier +1 (fold, branch point).
// Where no multiplier is near +1, the parameter or the determinant turned for another reason: the mesh no longer
// resolves the orbit, or what changed sign is rounding. Such a point is reported in words and has no label.

/// Far more than a located zero misses its multiplier by, unless that is about infinite.
inline constexpr double agreeing_multiplier = 5e-2;

/// Relative error of the return map: that of a corrected orbit, and of the mesh as the structural multiplier shows it.
double multiplier_accuracy(const FloquetMultipliers& multipliers);

/// Distance of the multiplier nearest to `target`, infinite without multipliers. The trivial one is left out.
double multiplier_distance(const FloquetMultipliers& multipliers, double target);

double largest_modulus(std::span<const std::complex<double>> values);

/// By how much a multiplier is outside of the unit circle, an eigenvalue to the right of the imaginary axis.
double stability_excess(const FloquetMultipliers& multipliers, const std::complex<double>& mu);

/// Where the structural multiplier is larger, the other multipliers of that mesh are not used.
inline constexpr double structural_bound = 5e-2;

/// The first segment (from 0) whose end is tangent to its event surface, |h_x f| < 1e-4 |h_x| |f|; -1: none.
int touching_segment(std::span<const double> transversalities);
inline int touching_segment(const TestedPoint& point) { return touching_segment(point.transversalities); }

/// Why a located zero of the function of folds or branch points (`target` 1) or of period doublings (-1) is no such
/// point, "" where it may be one. `what` changes there, for the text. Decides nothing where multipliers are not
/// computed or partly unknown (h_x f = 0), and where the problem is not that of orbits in one parameter
/// (TestedPoint::one_parameter_family).
std::string objection_without_multiplier(const TestedPoint& point, int target, const std::string& what);

/// The multipliers that surely crossed the unit circle (of eigenvalues: the imaginary axis) between two points.
struct StabilityChange {
  int count = 0;  ///< more unstable ones behind, negative: fewer
  std::complex<double> before, after;
};

/// Number of unstable multipliers, as far as it is known.
struct UnstableCount {
  int inside = 0;
  int outside = 0;
  int undecided = 0;  ///< within their uncertainty of the unit circle
};
UnstableCount count_unstable(const FloquetMultipliers& multipliers);

/// count = 0 where those that are undecided explain the difference, or multipliers of either point are not known.
StabilityChange stability_change(const FloquetMultipliers& before, const FloquetMultipliers& after);

/// Of a real multiplier.
bool is_through_one(const StabilityChange& change, bool are_eigenvalues);

/// "a multiplier goes from 0.93 to 1.49, through +1, without a label"
std::string describe(const StabilityChange& change, bool are_eigenvalues);

// Location of a zero of a test function on the arclength of one continuation step.

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
/// once more on a half of what is left, divided where a step converges. The place of a jump is the last one before it.
LocatedZero locate_zero_surely(const std::function<std::optional<double>(double)>& function, const SignChange& step,
                               double tolerance, double rounding_level, int max_evaluations);

/// A step over which the function changes sign has been narrowed to `bracket`, shorter than `tolerance`: is it a jump
/// or a pole, as the change there is no small share of the change over the step?
bool is_jump(const SignChange& step, const SignChange& bracket, double tolerance);

}  // namespace tchat
