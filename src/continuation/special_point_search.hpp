/// The one mechanism behind all special points of a branch: evaluate the test functions at every accepted point,
/// bracket changes of sign, locate the first zero of a step on its arclength, classify it.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "continuation/path_follower.hpp"
#include "special_points/locator.hpp"
#include "special_points/test_function.hpp"
#include "stability/floquet_multipliers.hpp"

namespace tchat {

/// What is known about a converged point besides the orbit.
struct PointData {
  FloquetMultipliers multipliers;
  std::vector<double> transversalities;       ///< h_x f / (|h_x| |f|) at the end of each segment
  double determinant = 1.0;                   ///< as in TestedPoint
  std::vector<std::optional<double>> values;  ///< of the test functions
  std::vector<double> zero_levels;
  std::vector<int> signs;  ///< of the values; 0 for those up to the zero level
};

struct LocationSettings {
  bool multipliers = true;   ///< compute them (ISP > 0)
  double tolerance = 1e-7;   ///< on arclength
  int max_evaluations = 10;  ///< ITMX
};

class SpecialPointSearch {
 public:
  using Note = std::function<void(const std::string&)>;

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

  /// `next` is a converged step of length ds from `here`, whose linearisation the follower holds. When test functions
  /// change sign on the way, `next`, `ds` and `newton` are moved to their first zero, and what it is is returned.
  /// Afterwards data() belongs to `next`, which becomes the new `here`.
  std::optional<SpecialPoint> advance(const PathPoint& here, PathPoint& next, double& ds, NewtonResult& newton,
                                      const Note& note);

 private:
  struct Zero {
    std::size_t test;
    double ds;
    bool converged;
  };

  void evaluate(const PathPoint& at);
  TestedPoint tested(const PathPoint& at) const;
  int sign_at(const TestedPoint& point, std::size_t test) const;
  std::vector<std::size_t> changed(const PointData& end) const;
  Zero locate(std::size_t test, const PathPoint& here, PathPoint& trial, double ds, double end_value);
  SpecialPoint classify(const Zero& zero, const PathPoint& at, const PointData& end);
  void remember(double ds);

  PathFollower& follower_;
  const DefiningSystem& system_;
  std::vector<std::unique_ptr<TestFunction>> tests_;
  LocationSettings settings_;
  FloquetSolver floquet_;
  PointData data_;
  std::optional<double> determinant_unit_;  // log2 of its size at the start of the branch
  struct Past {
    double arclength;
    std::vector<std::optional<double>> values;
  };
  std::vector<Past> history_;  // the last accepted points, for resolved()
  std::vector<int> signs_;     // of the test functions at the last accepted point; 0: none yet
};

}  // namespace tchat
