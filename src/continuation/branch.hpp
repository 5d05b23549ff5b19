/// The points of a branch as continuation hands them out, changes of stability without a label, and the step size.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "continuation/newton_chord.hpp"
#include "continuation/path_follower.hpp"
#include "orbit/admissibility.hpp"
#include "orbit/event_minima.hpp"
#include "stability/test_function.hpp"

namespace tchat {

// What is known about a converged point besides the orbit.

struct PointData {
  FloquetMultipliers multipliers;
  std::vector<double> transversalities;  ///< h_x f / (|h_x| |f|) at the end of each segment
  double singular_distance = 1.0;        ///< as in TestedPoint
  double principal_rate_size = 1.0;      ///< as there
  double estimated_error = 0.0;          ///< of the states between mesh points, relative
  std::vector<EventCourse> courses;      ///< of the monitored event functions
  std::vector<TestValue> tests;          ///< one for each test function
  std::vector<std::string> details;      ///< of a labelled point
};

/// A test function that is zero within its uncertainty all along a branch.
struct VanishingFunction {
  std::string name;
  std::string reason;  ///< "" where none is known
};

/// A converged step of length ds and what is known of the point that it has come to.
struct Candidate {
  PathPoint point;
  double ds = 0.0;
  PointData data;
};

// What continuation produces: the points of a branch, handed one by one to whoever writes them, and a summary.

struct FamilyFacts;

/// The value of a test function under its name.
struct NamedTestValue {
  std::string name;
  std::optional<double> value;
};

/// A computed point of the branch, complete. References are valid during the call that hands it over.
struct BranchPoint {
  int number = 1;        ///< 1, 2, ...
  SpecialPoint special;  ///< type ordinary: an unlabelled point
  const PathPoint& path;
  const FloquetMultipliers& multipliers;
  const std::vector<Violation>& violations;  ///< empty: admissible
  double estimated_error = 0.0;              ///< of the states between mesh points, relative
  int newton_iterations = 0;
  const std::vector<NewtonIteration>& newton;  ///< of the step that reached it
  double step = 0.0;                           ///< ds of that step, 0 at the start
  const std::vector<NamedTestValue>& tests;
  const std::vector<std::string>& details;  ///< of a labelled point: what else its test functions know
  std::string remark = {};                  ///< what its problem type has to say of it, one line or none
  bool labelled() const { return special.type != PointType::ordinary; }
};

/// A test function changed sign on the step to a point, but no zero of it could be located.
struct LostPoint {
  int number = 1;
  std::string text;
  double from = 0.0;  ///< the principal parameter where the step began
  double to = 0.0;    ///< and where it ended
};

/// Receives a branch as it grows.
class BranchSink {
 public:
  virtual ~BranchSink() = default;
  virtual void point(const BranchPoint& point) = 0;
  /// The step that will be tried next from the last point.
  virtual void next_step(int point_number, double ds) = 0;
  /// Something worth a line in the d-file, about the point being computed.
  virtual void note(int point_number, const std::string& text) = 0;
  /// The branch starts at a zero of this test function, which has no label.
  virtual void starts_at_zero(const std::string& name) {
    note(1, "The run starts at a zero of " + name + ": no label of its own");
  }
  /// A point that the step to a point has passed, which is not located.
  virtual void passed(const LostPoint& point) { note(point.number, point.text); }
  /// Something that the user must hear of: a special point may be missing.
  virtual void lost(const LostPoint& point) { note(point.number, point.text); }
};

enum class EndReason {
  outgrown,    ///< it goes on with another discretisation
  unresolved,  ///< no discretisation within the limits resolves what follows
  no_orbit,    ///< the period has passed infinity or zero
  max_points,
  beyond_bound,  ///< of RL0, RL1, A0, A1 or BOUNDS
  on_bound,      ///< of RL0, RL1, A0, A1 or BOUNDS, where the branch was to end
  special_point,
  curve_end,    ///< of a two-parameter curve, passed
  equilibrium,  ///< the orbit has shrunk to a point
  closed,       ///< the branch has come back to its first point
  interrupted,
  no_convergence,
  first_step_failed
};

/// A larger relative error of an orbit between mesh points is one of the mesh.
inline constexpr double coarse_mesh = 1e-3;

struct BranchSummary {
  EndReason reason = EndReason::max_points;
  std::string detail;               ///< which bound, which special point, what was tried
  bool undefined_function = false;  ///< no convergence, for a function of the problem has no value there
  bool stopped_at_grazing = false;  ///< by GRSTOP
  bool stopped_at_border = false;   ///< likewise, where chatter becomes incomplete
  std::string remark;               ///< what becomes of the orbit at the end; "" if nothing is to be said
  std::string no_progress;          ///< why the branch has not gone anywhere; "" if it has
  int points = 0;
  int inadmissible_points = 0;
  int unstable_points = 0;
  int undetermined_points = 0;  ///< whose stability is not known
  int neutral_points = 0;       ///< between bifurcations
  bool multipliers_computed = false;
  const FamilyFacts* family = nullptr;  ///< of the points
  bool critical_curve = false;          ///< every point has a critical multiplier, so stability says nothing
  bool without_contact = false;         ///< stability is that of the orbit without the contact that the curve keeps
  double worst_structural = 0.0;        ///< largest structural multiplier, or distance of the trivial one from 1
  bool has_structural = false;          ///< is it known at any point?
  bool has_trivial = false;             ///< orbits without a section have this one instead
  double worst_estimated_error = 0.0;
  std::optional<double> worst_unfolding = {};  ///< largest lambda of orbits that conserve a function
  std::vector<LostPoint> lost;                 ///< special points that may be missing
  std::vector<VanishingFunction> vanishing;    ///< test functions without zeros to look for
};

// Changes of the number of unstable multipliers along a branch that no label explains.

struct UnlabelledChange {
  LostPoint point;
  bool is_through_one;  ///< of one real multiplier: on a curve that holds monitors that need not be a special point
};

class StabilityWatch {
 public:
  /// An accepted point.
  struct Point {
    int number;
    double parameter;  ///< the principal one
    const SpecialPoint& special;
    const FloquetMultipliers& multipliers;
  };

  /// Points before it are forgotten.
  void begin(const Point& point);

  /// The change since the last point whose multipliers are known. Nothing where there is none, where a bifurcation or
  /// an impact velocity through zero is labelled in between, or `is_reported`: a special point that may be missing is.
  std::optional<UnlabelledChange> add(const Point& point, bool is_reported);

 private:
  void remember(const Point& point);

  struct Known {
    double parameter;
    FloquetMultipliers multipliers;
  };
  std::optional<Known> known_;
};

// Step length control of pseudo-arclength continuation (DS, DSMIN, DSMAX, IADS), with AUTO's rules.

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
