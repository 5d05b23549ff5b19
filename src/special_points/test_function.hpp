/// Functions whose zeros along a branch are special points.
///
/// All share one mechanism (special_point_search): evaluated at every accepted point, a change of sign over a step
/// brackets a zero, the zero is located on the arclength of that step (locator.hpp), classified, labelled and written.
/// A new kind of special point is one new class. Test functions are pure: the same point gives the same value.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bvp/condensed_system.hpp"
#include "special_points/point_type.hpp"
#include "stability/floquet_multipliers.hpp"

namespace tchat {

/// What a test function may look at: a converged point and its linearisation.
struct TestedPoint {
  const Orbit& orbit;
  const OrbitVector& tangent;
  const CondensedSystem& condensed;
  const FloquetMultipliers& multipliers;
  const std::vector<double>& transversalities;  ///< h_x f / (|h_x| |f|) at the end of each segment
  double singular_distance = 1.0;               ///< CondensedSystem::signed_distance() of the bordered problem
};

/// What a point of the branch is; for a zero of a test function, what it found.
struct SpecialPoint {
  PointType type = PointType::ordinary;
  UserPointKind kind;  ///< for PointType::user
  bool ends_branch = false;
  std::string description;                  ///< one line for the d-file
  std::vector<UserPointKind> further = {};  ///< what else vanishes there
};

class TestFunction {
 public:
  virtual ~TestFunction() = default;
  virtual std::string name() const = 0;
  /// Nothing where the function is not defined; an undefined value cannot change sign.
  virtual std::optional<double> value(const TestedPoint& point) const = 0;
  /// The sign that an undefined value stands for; 0: none.
  virtual int sign_where_undefined(const TestedPoint&) const { return 0; }
  /// |value| up to this counts as zero.
  virtual double zero_level(const TestedPoint& point) const = 0;
  /// True for functions that may change sign twice within a step that is otherwise fine; such a step is then shortened
  /// until their trend is followed.
  virtual bool oscillates() const { return false; }
  /// False at a zero that is none of the special points looked for: a factor that keeps the function regular vanishes.
  virtual bool is_genuine(const TestedPoint&) const { return true; }
  /// True when Newton's matrix is singular at the zeros, which are then located from both sides.
  virtual bool singular_at_zero() const { return false; }
  /// What else there is to know of a labelled point, in lines for the d-file; empty: nothing.
  virtual std::string details(const TestedPoint&) const { return ""; }
  /// The special point at a located zero; `rising` says which way the function went through it.
  virtual SpecialPoint classify(const TestedPoint& point, bool rising) const = 0;
};

}  // namespace tchat
