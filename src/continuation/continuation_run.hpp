/// One branch from a converged start: step, evaluate test functions, locate special points, record, adapt, stop.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "base/levels.hpp"
#include "continuation/branch.hpp"
#include "continuation/branch_limits.hpp"
#include "continuation/orbit_trend.hpp"
#include "continuation/path_follower.hpp"
#include "continuation/special_point_search.hpp"
#include "orbit/mesh_adaptation.hpp"

namespace tchat {

struct ContinuationSettings {
  StepSettings step;
  int max_points = 100;  ///< NMX; the start counts
  int principal = 1;     ///< PAR index of ICP(1), or what stands for a monitor
  std::string principal_name = "PAR(1)";
  double parameter_min = -1e300, parameter_max = 1e300;  ///< RL0, RL1
  double measure_min = -1e300, measure_max = 1e300;      ///< A0, A1
  int measure = 0;                                       ///< IPLT
  std::vector<BranchBounds> further_bounds;              ///< BOUNDS
  Eigen::VectorXd state_weights;                         ///< THU, n entries, in the units of the user
  Eigen::VectorXd state_units = {};                      ///< of the orbits' states, in those; none: all are 1
  int print_every = 0;                                   ///< NPR
  int adapt_mesh_every = 0;                              ///< IAD
  bool multipliers = true;                               ///< ISP > 0
  double location_tolerance = level::tolerance;          ///< EPSS
  int max_location = 10;                                 ///< ITMX
  bool label_start = true;                               ///< false at a restart: the first point is known already
  bool stop_when_closed = true;                          ///< CLSTOP
  bool negative_durations = false;                       ///< a segment's may become so (GRSTOP = 0)
  bool clip = false;                                     ///< end on the bounds, not at the first point beyond them
  /// Called for every labelled point; true ends the branch there (STOP).
  std::function<bool(const SpecialPoint&)> stop_at;
  std::vector<std::vector<int>> monitored;  ///< event functions monitored on each segment
  std::function<bool()> interrupted;        ///< asked after every point
  /// A line about a point that its problem type has to say, or "".
  std::function<std::string(const Orbit&)> remark = {};
  std::function<std::string(const Orbit&)> label_remark = {};  ///< the same of labelled points alone
  /// Asked after every point: true ends the run there, for it is to go on with another discretisation.
  std::function<bool(const Orbit&)> outgrown = {};
  /// Asked after every point: why the branch ends there, or "".
  std::function<std::string(const Orbit&)> unresolved = {};
  /// Largest estimated error and structural multiplier of a point that the branch goes on to (ERRMAX); 0: any.
  double error_bound = 0.0;
  bool resumes = false;            ///< the first point is the last of a run with another mesh, and written
  bool may_refine = false;         ///< a finer mesh is tried where the bound is exceeded (EndReason::outgrown)
  bool reports_stability = false;  ///< all bifurcations are detected: a change of stability has a label, or is reported
  std::optional<OrbitTrend> trend = {};  ///< of the part of the branch before the start, on another mesh
  int first_number = 1;  ///< of the start; one that goes on with another discretisation was recorded before
};

/// All finite bounds: of the principal parameter, the solution measure, then further ones.
std::vector<BranchBounds> branch_bounds(const ContinuationSettings& settings);

/// Outside of the bounds, and not just by the accuracy of a located point (a user value may be a bound). `size`: of the
/// quantity, HybridSystem::parameter_size().
bool is_beyond(const ContinuationSettings& settings, const BranchBounds& bounds, double value, double size);

class ContinuationRun {
 public:
  ContinuationRun(PathFollower& follower, const DefiningSystem& system, ContinuationSettings settings,
                  std::vector<std::unique_ptr<TestFunction>> tests, BranchSink& sink);

  /// `start` is converged, with its tangent oriented for DS > 0.
  BranchSummary run(PathPoint start);
  /// Where it has ended.
  const PathPoint& last() const { return here_; }
  const OrbitTrend& trend() const { return trend_; }
  /// The next step that it would have tried.
  double next_length() const { return step_.value(); }

 private:
  void resume();
  bool take_step();
  void count_iterations(const PathPoint& from, Candidate& to);
  int tried_along_tangent(const PathPoint& from, Candidate& to);
  std::optional<double> move_to_first_point();
  SpecialPoint end_at_first_point(SpecialPoint special, double length);
  SpecialPoint advance();
  bool leads_through_point();
  double where_located() const;
  bool ends_beside_point();
  SpecialPoint end_at_point();
  SpecialPoint shrunk_orbit(SpecialPoint special, bool through_point);
  SpecialPoint curve_end(SpecialPoint special);
  SpecialPoint end_conditions(SpecialPoint special);
  void report_passed_points();
  void record(const SpecialPoint& special, const PointData& data);
  void accept(const SpecialPoint& special);
  void save_accepted();
  void mark_accepted();
  void end(EndReason reason, std::string detail);
  void prepare_next_step();
  void report_lost(const std::string& text);
  void report_start(const std::string& test_name);
  void report(const LostPoint& point);
  double parameter_at(const PathPoint& point) const;
  void give_up();
  std::string exceeded_bound(const Candidate& at) const;
  bool is_near_end() const;
  std::string passed_end() const;
  std::string passed_zero_duration() const;
  std::string bound_at_start() const;
  std::string shorter_orbit();
  std::string end_text(const std::string& what) const;
  bool may_go_to_next();
  void write_last_again(PointType type);
  bool turns_visibly(double parameter) const;
  void add_to_trend();
  void add_to_way();
  std::string no_progress() const;

  PathFollower& follower_;
  const DefiningSystem& system_;
  ContinuationSettings settings_;
  BranchSink& sink_;
  std::unique_ptr<BranchAnalysis> analysis_;
  SpecialPointSearch search_;
  StepSize step_;
  OrbitTrend trend_;
  bool has_whole_orbits_ = false;  // there was one that no shorter orbit makes
  int points_in_parts_ = 0;        // of the last points, which have been such
  ClosedBranch closed_;
  std::vector<BranchBounds> bounds_;  // all that are finite
  PathPoint here_;                    // the last accepted point, moved to a new mesh where one was due
  bool is_moved_ = false;             // is here_ on another mesh than it was accepted on?
  PathPoint accepted_;                // then: the last accepted point as it was accepted
  PointData accepted_data_;
  double accepted_parameter_ = 0.0;  // the principal parameter there
  Candidate next_;                   // the point being computed; once accepted its step and data, the point is here_
  NewtonResult newton_;              // of the step to it
  int iterations_ = 0;               // that it would take from the tangent: what the step length goes by
  bool is_doubtful_ = false;         // iterations_ is uncertain: the next step starts from the tangent, to count it
  bool limited_ = false;             // by zeros that are known to lie ahead: it says nothing of the next one
  double steepest_ = 0.0;            // largest part of the principal parameter in a tangent so far
  double before_ = 0.0;              // that part at the last point but one
  double turned_at_ = 0.0;           // the principal parameter at the last turn of the branch, or at its start
  double first_period_ = 0.0;
  std::string passed_;  // why a longer trial of the step was no orbit
  StabilityWatch stability_;
  MeshEquidistribution equidistribution_;
  std::vector<NamedTestValue> test_values_;  // of the point that is handed over
  std::size_t lost_before_ = 0;              // reports at the last accepted point
  int number_ = 1;                           // of here_
  struct {
    int steps = 0, longest = 0;  // of length DSMAX
    double length = 0.0;         // the sum of the largest changes of all steps, each relative to a size
  } way_;
  bool ended_ = false;
  BranchSummary summary_;
};

}  // namespace tchat
