/// The bounds of a branch: RL0, RL1 of the principal parameter, A0, A1 of the solution measure, BOUNDS of any other
/// quantity. A branch ends at the first point beyond them, or on them (--clip).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "orbit/collocation_rule.hpp"
#include "orbit/orbit.hpp"
#include "stability/test_function.hpp"

namespace tchat {

/// The range of one quantity: an entry of PAR (a parameter, duration or monitor) or the solution measure.
struct BranchBounds {
  static constexpr int solution_measure = 0;
  int parameter = solution_measure;         ///< index in PAR, from 1; or the solution measure
  std::string quantity;                     ///< its name
  std::string least_keyword, most_keyword;  ///< constants that set the range: RL0 and RL1, A0 and A1, BOUNDS twice
  double least = -1e300, most = 1e300;
  int measure = 0;               ///< IPLT, of the solution measure
  Eigen::VectorXd weights = {};  ///< THU, n entries, likewise

  double value(const Orbit& orbit, const CollocationRule& rule) const;
  /// Is there a bound that excludes anything? 1e300 does not.
  bool is_finite() const;
  /// "RL0, RL1", or "BOUNDS"
  std::string keywords() const;
};

/// A test function for each finite bound: the value minus the bound. Their zeros are end points.
std::vector<std::unique_ptr<TestFunction>> bound_tests(const std::vector<BranchBounds>& bounds);

}  // namespace tchat
