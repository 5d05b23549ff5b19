/// The one mechanism behind all special points of a branch: evaluate the test functions at every accepted point,
/// bracket changes of sign, locate the first zero of a step on its arclength, classify it.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "base/levels.hpp"
#include "continuation/branch.hpp"
#include "continuation/branch_point_bracket.hpp"
#include "continuation/newton_chord.hpp"
#include "continuation/orbit_trend.hpp"
#include "stability/test_function.hpp"

namespace tchat {

class DefiningSystem;
class PathFollower;

struct LocationSettings {
  bool multipliers = true;                       ///< compute them (ISP > 0)
  double tolerance = level::tolerance;           ///< on arclength
  int max_evaluations = 10;                      ///< ITMX
  std::vector<std::vector<int>> monitored = {};  ///< event functions of each segment, as in inadmissibilities()

  /// Special points that are so near to a point, by arclength, are at that point.
  double same_place() const { return 10.0 * tolerance; }
};

class SpecialPointSearch {
 public:
  /// Who hears of what deserves no label: a note for the d-file, what the user must know, as a point may be missing,
  /// and the name of a test function whose zero is the start of the branch.
  struct Reports {
    std::function<void(const std::string&)> note;
    std::function<void(const std::string&)> lost;
    std::function<void(const std::string&)> start;
  };

  SpecialPointSearch(PathFollower& follower, const DefiningSystem& system, BranchAnalysis& analysis,
                     std::vector<std::unique_ptr<TestFunction>> tests, const LocationSettings& settings);

  const std::vector<std::unique_ptr<TestFunction>>& tests() const { return tests_; }

  /// Evaluates at the start of a branch. Functions that vanish there take their sign from the next point.
  PointData begin(PathPoint& start);

  /// At a converged point, whose linearisation the follower holds.
  PointData evaluate_again(PathPoint& at);  ///< with a new linearisation
  PointData evaluate(PathPoint& at);
  /// Overwrites the data of another point, whose space is used again.
  void evaluate(PathPoint& at, PointData& data);

  /// Do the points of the branch follow each other as closely as the test functions ask for (Resolution)? Else one of
  /// them may have changed sign twice on the step from `here` to `next`, and a shorter one will tell.
  bool resolved(const PathPoint& here, const Candidate& next) const;

  /// Does a converged step go on along the same branch? Close to a branch point Newton may come out on another one: the
  /// tangent turns much there and the problem is nearly singular.
  bool same_branch(const PathPoint& here, const PathPoint& next);

  /// `next` is a converged step from `here`, evaluated, whose linearisation the follower holds. When test functions
  /// change sign on the way, `next` and `newton` are moved to their first zero, and what it is is returned. Afterwards
  /// `next` becomes the new `here`.
  std::optional<SpecialPoint> advance(const PathPoint& here, Candidate& next, NewtonResult& newton,
                                      const Reports& reports);

  /// A step that was cut at a zero has shown what lies beyond. As long as further zeros are known there, the next steps
  /// end where it ended, not farther: `ds`, or what is left of that step.
  double limited(double ds) const;

  /// Functions that were within their uncertainty at every point so far where they are defined, three or more; `at` is
  /// the last one.
  std::vector<VanishingFunction> vanishing(const PathPoint& at, const PointData& data) const;

  /// What the test functions know of `at`, whose linearisation the follower holds.
  std::vector<std::string> details(const PathPoint& at, const PointData& data) const;
  /// What test functions see of a point; `data` must outlive it.
  TestedPoint tested(const PathPoint& at, const PointData& data) const;

 private:
  /// What came of the search for a zero.
  enum class Search { none, located, start, jump, no_special_point, refused, failed };
  struct Zero {
    std::size_t test;
    double ds;
    Search search;
  };
  /// Where a step is cut: the zero of a group of functions.
  struct Cut {
    Candidate at;
    std::vector<std::size_t> group;
    std::optional<NewtonResult> newton;  // nothing: interpolated
  };

  double signed_distance(const PathPoint& at) const;
  void find_event_courses(const Orbit& x, PointData& data);
  bool is_near_zero(std::size_t test, const TestValue& end) const;
  std::vector<std::size_t> changed(const PointData& end) const;
  std::optional<Candidate> farther_step(const PathPoint& here, Candidate& next);
  std::optional<SpecialPoint> advance_to_first_zero(const PathPoint& from, Candidate& next, NewtonResult& newton,
                                                    const Candidate& whole);
  std::optional<Cut> first_in(const PathPoint& here, PathPoint& trial, const Candidate& step);
  bool has_tangent(double length) const;
  NewtonResult step_within(const PathPoint& here, double length, PathPoint& trial);
  void keep_rest(const Candidate& whole, const PathPoint& cut);
  void report_start(const PointData& next, const Reports& reports) const;
  void report_lost(const PointData& next, const Reports& reports) const;
  bool is_start(double length) const;
  std::optional<BranchPointBracket> find_branch_point(const PathPoint& here, PathPoint& trial, const Candidate& step);
  std::vector<Zero> find_zeros(const PathPoint& here, PathPoint& trial, double ds, const PointData& end);
  Zero locate(std::size_t test, const PathPoint& here, PathPoint& trial, double ds, double end_value);
  Search zero_at_start(std::size_t test) const;
  bool has_evidence(std::size_t test, const PathPoint& at, const PointData& data);
  bool is_flat(const Zero& zero, const PointData& there, double distance, double length, const PointData& end) const;
  Zero first_sharp_zero(const PathPoint& here, PathPoint& trial, double length, const std::vector<Zero>& zeros,
                        const PointData& end);
  std::vector<std::size_t> vanishing_with(const Zero& first, const std::vector<Zero>& zeros, const PointData& there,
                                          double length, const PointData& end) const;
  std::vector<std::size_t> vanishing_at(const BranchPointBracket& branch_point) const;
  std::string objection_at(const BranchPointBracket& bracket, const PathPoint& trial, const PointData& at_zero) const;
  SpecialPoint classify(const std::vector<std::size_t>& group, Candidate& at);
  void remember(const PointData& data, double ds);

  PathFollower& follower_;
  const Candidate* whole_ = nullptr;  // the step on which a zero is looked for
  std::vector<double> singular_;      // lengths of trial steps on it to points without a tangent
  const DefiningSystem& system_;
  std::vector<std::unique_ptr<TestFunction>> tests_;
  LocationSettings settings_;
  BranchAnalysis& analysis_;
  EventCourseFinder course_finder_;
  EventScales event_scales_;
  /// At how many points a function was defined, and whether its value exceeded its uncertainty at one of them.
  struct Evidence {
    int points = 0;
    bool has_sign = false;
  };
  std::vector<Evidence> evidence_;  // of each test function
  bool is_one_parameter_family_;    // TestedPoint
  struct Past {
    double arclength;
    std::vector<TestValue> tests;
  };
  double distance_here_ = 1.0;    // PointData::singular_distance at the last accepted point
  std::vector<Past> history_;     // the last accepted points, for resolved()
  std::vector<int> signs_;        // of the test functions at the last accepted point; 0: none yet
  std::vector<bool> labelled_;    // the last accepted point is labelled as their zero
  std::vector<Search> searches_;  // on the step being searched
  std::vector<std::string> objections_;
  double rest_ = 0.0;  // of a step that was cut; 0: nothing more is known there
};

}  // namespace tchat
