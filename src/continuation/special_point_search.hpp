/// The one mechanism behind all special points of a branch: evaluate the test functions at every accepted point,
/// bracket changes of sign, locate the first zero of a step on its arclength, classify it.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "continuation/branch_point_bracket.hpp"
#include "continuation/path_follower.hpp"
#include "continuation/point_data.hpp"
#include "special_points/locator.hpp"
#include "special_points/test_function.hpp"
#include "stability/floquet_multipliers.hpp"

namespace tchat {

struct LocationSettings {
  bool multipliers = true;   ///< compute them (ISP > 0)
  double tolerance = 1e-7;   ///< on arclength
  int max_evaluations = 10;  ///< ITMX
};

class SpecialPointSearch {
 public:
  /// Who hears of what deserves no label: a note for the d-file, and what the user must know, as a point may be
  /// missing.
  struct Reports {
    std::function<void(const std::string&)> note;
    std::function<void(const std::string&)> lost;
  };

  SpecialPointSearch(PathFollower& follower, const DefiningSystem& system,
                     std::vector<std::unique_ptr<TestFunction>> tests, const LocationSettings& settings);

  const std::vector<std::unique_ptr<TestFunction>>& tests() const { return tests_; }
  /// Of the point evaluated last.
  const PointData& data() const { return data_; }

  /// Evaluates at the start of a branch. Functions that vanish there take their sign from the next point.
  void begin(const PathPoint& start);

  /// Are the oscillating test functions resolved by a converged step of length ds to `next`? False when one of them is
  /// far from what its last values let expect, or when they let expect that it has come near to zero in between: it may
  /// have changed sign twice, a shorter step will tell.
  bool resolved(const PathPoint& next, double ds);

  /// Does a converged step go on along the same branch? Close to a branch point Newton may come out on another one: the
  /// tangent turns much there and the problem is nearly singular.
  bool same_branch(const PathPoint& here, const PathPoint& next);

  /// `next` is a converged step of length ds from `here`, whose linearisation the follower holds. When test functions
  /// change sign on the way, `next`, `ds` and `newton` are moved to their first zero, and what it is is returned.
  /// Afterwards data() belongs to `next`, which becomes the new `here`.
  std::optional<SpecialPoint> advance(const PathPoint& here, PathPoint& next, double& ds, NewtonResult& newton,
                                      const Reports& reports);

  /// A step that was cut at a zero has shown what lies beyond. As long as further zeros are known there, the next steps
  /// end where it ended, not farther: `ds`, or what is left of that step.
  double limited(double ds) const;

  /// What the test functions know of `at`, whose linearisation the follower holds.
  std::vector<std::string> details(const PathPoint& at) const;

 private:
  /// What came of the search for a zero.
  enum class Search { none, located, start, jump, no_special_point, failed };
  struct Zero {
    std::size_t test;
    double ds;
    Search search;
  };
  /// How far the zeros are searched, and what is known there.
  struct Step {
    double ds;
    PathPoint point;
    PointData end;
  };
  /// Where a step is cut: the zero of a group of functions.
  struct Cut {
    double ds;
    PathPoint point;
    std::vector<std::size_t> group;
    std::optional<NewtonResult> newton;  // nothing: interpolated
  };

  void evaluate(const PathPoint& at);        // the follower holds its linearisation
  void evaluate_again(const PathPoint& at);  // with a new one
  TestedPoint tested(const PathPoint& at) const;
  int sign_at(const TestedPoint& point, std::size_t test) const;
  std::vector<std::size_t> changed(const PointData& end) const;
  Step searched_step(const PathPoint& here, const PathPoint& next, double ds);
  std::optional<SpecialPoint> advance_to_first_zero(const PathPoint& here, PathPoint& next, double& ds,
                                                    NewtonResult& newton, const Step& whole);
  std::optional<Cut> first_in(const PathPoint& here, PathPoint& trial, const Step& step);
  void keep_rest(const Step& whole, const PathPoint& cut);
  void report_lost(const Reports& reports) const;
  bool is_start(double length) const;
  std::optional<BranchPointBracket> find_branch_point(const PathPoint& here, PathPoint& trial, const Step& step);
  std::vector<Zero> find_zeros(const PathPoint& here, PathPoint& trial, double ds, const PointData& end);
  Zero locate(std::size_t test, const PathPoint& here, PathPoint& trial, double ds, double end_value);
  Search zero_at_start(std::size_t test) const;
  bool is_flat(const Zero& zero, const PointData& there, double distance, double length, const PointData& end) const;
  Zero first_sharp_zero(const PathPoint& here, PathPoint& trial, double length, const std::vector<Zero>& zeros,
                        const PointData& end);
  std::vector<std::size_t> vanishing_with(const Zero& first, const std::vector<Zero>& zeros, double length,
                                          const PointData& end) const;
  std::vector<std::size_t> vanishing_at(const BranchPointBracket& branch_point) const;
  SpecialPoint classify(const std::vector<std::size_t>& group, const PathPoint& at);
  void remember(double ds);

  PathFollower& follower_;
  const DefiningSystem& system_;
  std::vector<std::unique_ptr<TestFunction>> tests_;
  LocationSettings settings_;
  FloquetSolver floquet_;
  PointData data_;
  struct Past {
    double arclength;
    std::vector<std::optional<double>> values;
  };
  double distance_here_ = 1.0;    // PointData::singular_distance at the last accepted point
  std::vector<Past> history_;     // the last accepted points, for resolved()
  std::vector<int> signs_;        // of the test functions at the last accepted point; 0: none yet
  std::vector<int> signs_here_;   // of the values at the last accepted point; 0 within their zero levels
  std::vector<bool> labelled_;    // the last accepted point is labelled as their zero
  std::vector<Search> searches_;  // on the step being searched
  double rest_ = 0.0;             // of a step that was cut; 0: nothing more is known there
};

}  // namespace tchat
