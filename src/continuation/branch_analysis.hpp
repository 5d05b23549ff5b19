/// What a branch of solutions of one family needs while it is computed: the multipliers of a point, where the branch
/// ends of itself, what its last point tends to. A DefiningSystem makes the analysis of its own kind of solutions
/// (make_analysis); the classes are in src/kinds.
#pragma once

#include <optional>
#include <string>

#include "continuation/orbit_trend.hpp"
#include "stability/test_function.hpp"

namespace tchat {

struct FamilyFacts;
struct PathPoint;

class BranchAnalysis {
 public:
  virtual ~BranchAnalysis() = default;

  virtual const FamilyFacts& facts() const = 0;
  /// Multipliers, or what takes their place. `condensed` holds the linearisation at x.
  virtual void find_multipliers(const CondensedSystem& condensed, const Orbit& x, FloquetMultipliers& result) = 0;

  /// Have equal solutions equal states at equal tau? No where nothing fixes the phase.
  virtual bool has_fixed_phase() const { return true; }
  /// May the solutions shrink to a point along a branch, which ends there?
  virtual bool may_shrink() const { return false; }
  /// The special point at which a branch ends because x has shrunk, with a description.
  virtual SpecialPoint shrunk(const Orbit& x) const;
  /// Why no solution lies beyond the step of signed length ds between two points, or at its end; "" where one may.
  virtual std::string passed_infinity(const PathPoint& /*from*/, const PathPoint& /*to*/, double /*ds*/) const {
    return "";
  }
  /// The period has passed zero on a step: what happened; "".
  virtual std::string passed_zero(const Orbit& /*from*/, const Orbit& /*to*/) const { return ""; }
  /// The same of the duration of a segment.
  virtual std::string passed_zero_segment(const Orbit& /*from*/, const Orbit& /*to*/) const { return ""; }
  /// What x, the last point of a branch whose period has grown so, tends to, in a sentence; "" if nothing is known.
  virtual std::string tendency(const Orbit& /*x*/, const PeriodGrowth&, const std::string& /*parameter_name*/) const {
    return "";
  }

  /// Why the first point of a branch, corrected from `start`, is no solution of this family, with a cure; "" if it is.
  virtual std::string why_no_solution(const Orbit& /*first*/, const Orbit& /*start*/,
                                      const std::string& /*source*/) const {
    return "";
  }
  /// What a user might change where no first point is found near `start`.
  virtual std::string start_advice(const Orbit& start) const;
};

}  // namespace tchat
