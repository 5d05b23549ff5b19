/// Functions whose zeros along a branch are special points.
///
/// All share one mechanism (special_point_search): evaluated at every accepted point, a change of sign over a step
/// brackets a zero, the zero is located on the arclength of that step (locator.hpp), classified, labelled and written.
/// A new kind of special point is one new class and the list that it is added to. Test functions are pure: the same
/// point gives the same value.
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "orbit/event_minima.hpp"
#include "orbit/orbit.hpp"
#include "settings/point_type.hpp"
#include "stability/multipliers.hpp"

namespace tchat {

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
  direction   ///< near a zero the branch hardly turns within a step, for another one may cross it there
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

}  // namespace tchat
