/// What becomes of orbits along a branch: limits that they tend to, and the analysis that each family provides.
#pragma once

#include <optional>
#include <string>

#include "orbit/defining_system.hpp"
#include "orbit/orbit.hpp"
#include "stability/test_function.hpp"

namespace tchat {

// What becomes of the orbit along a branch: does it shrink to a point, or a torus to a periodic orbit, does its period
// grow without bound?
//
// Of the `orbits` returns of a torus (orbit/torus_system.hpp) the deviation of a node is that from its mean over the
// returns: it vanishes on a periodic orbit, run through so many times.

/// Largest minus least value of each state over the orbit, n entries.
Eigen::VectorXd state_ranges(const Orbit& x);

/// Are there but events that cut the orbits of one field, so that they may shrink to an equilibrium of it?
bool is_smooth(const DefiningSystem& system);

/// Cosine of the angle between the states' deviations from their means, nodes being equal; both orbits on one mesh.
/// About -1 where a step has led through an equilibrium: beyond it the branch consists of the same orbits, begun half a
/// turn later.
double deviation_cosine(const Orbit& x, const Orbit& y, int orbits = 1);
/// The norm of the deviations of all nodes' states from their means.
double deviation_norm(const Orbit& x);
/// What a step of unit length along `direction`, a vector of states, adds to x's deviation from its mean, as a share of
/// the deviation, in its own direction.
double deviation_growth(const Orbit& x, const Eigen::MatrixXd& direction, int orbits = 1);

/// How the period has grown since the parameter stands still.
struct PeriodGrowth {
  double from = 0.0;
  double to = 0.0;
  double parameter = 0.0;
  double size = 0.0;  ///< of the parameter on the branch: of its values and of its range
};

class OrbitTrend {
 public:
  explicit OrbitTrend(int orbits = 1) : orbits_(orbits) {}

  /// An accepted point of the branch; `parameter` is the principal one, of this size.
  void add(const Orbit& x, double parameter, double parameter_size);

  /// Is every state's range of deviations at most this share of its largest one so far?
  bool has_shrunk(const Orbit& x, double share) const;

  /// The largest range of the deviations of a state, as a share of its largest one so far; 0 where none has moved.
  double amplitude(const Orbit& x) const;

  /// Nothing unless the period is positive and has grown by more than half since the parameter stands still.
  std::optional<PeriodGrowth> period_growth() const;

 private:
  struct Place {
    double parameter = 0.0;
    double period = 0.0;
  };
  int orbits_;
  Eigen::VectorXd largest_;  // ranges
  Eigen::VectorXd sizes_;    // largest moduli of the states
  double first_parameter_ = 0.0, size_ = 0.0;
  Place still_;  // since when the parameter has stood still
  Place last_;
};

// What a period that grows without bound tends to: an orbit that begins and ends at an equilibrium.

/// A sentence where `x`, the last orbit of a branch whose period has grown so, comes near an equilibrium of its field;
/// "" where it does not: then the period grows for another reason (the parameter scales time, a flight takes longer, a
/// conservative system has a family of orbits). The equilibrium is found by Newton's method from the slowest mesh
/// point.
std::string homoclinic_limit(const DefiningSystem& system, const Orbit& x, const PeriodGrowth& growth,
                             const std::string& parameter_name);

// What a branch of solutions of one family needs while it is computed: the multipliers of a point, where the branch
// ends of itself, what its last point tends to. A DefiningSystem makes the analysis of its own kind of solutions
// (make_analysis); the classes are in src/kinds.

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
  /// The special point at which a branch, or a curve of folds, ends because x has shrunk, with a description.
  virtual SpecialPoint shrunk(const Orbit& x, bool are_folds) const;
  /// Why no solution lies beyond the step of signed length ds between two points, or at its end; "" where one may.
  virtual std::string passed_infinity(const PathPoint& /*from*/, const PathPoint& /*to*/, double /*ds*/) const {
    return "";
  }
  /// The period has passed zero on a step: what happened; "".
  virtual std::string passed_zero(const Orbit& /*from*/, const Orbit& /*to*/) const { return ""; }
  /// The same of the duration of a segment.
  virtual std::string passed_zero_segment(const Orbit& /*from*/, const Orbit& /*to*/) const { return ""; }
  /// In how many like parts is x, which another solution makes, run round so often? 1 where it is none.
  virtual int like_parts(const Orbit& /*x*/) const { return 1; }
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
