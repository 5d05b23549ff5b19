/// What a label needs besides a change of sign: how well multipliers are known, and whether those of a located point
/// agree with its type.
///
/// A singular boundary value problem of periodic orbits in one parameter has a multiplier +1 (fold, branch point).
/// Where no multiplier is near +1, the parameter or the determinant turned for another reason: the mesh no longer
/// resolves the orbit, or what changed sign is rounding. Such a point is reported in words and has no label.
#pragma once

#include <complex>
#include <span>
#include <string>
#include <vector>

#include "stability/multipliers.hpp"
#include "stability/test_function.hpp"

namespace tchat {

/// Far more than a located zero misses its multiplier by, unless that is about infinite.
inline constexpr double agreeing_multiplier = 5e-2;

/// Relative error of the return map: that of a corrected orbit, and of the mesh as the structural multiplier shows it.
double multiplier_accuracy(const FloquetMultipliers& multipliers);

/// Distance of the multiplier nearest to `target`, infinite without multipliers. The trivial one is left out.
double multiplier_distance(const FloquetMultipliers& multipliers, double target);

double largest_modulus(std::span<const std::complex<double>> values);

/// By how much a multiplier is outside of the unit circle, an eigenvalue to the right of the imaginary axis.
double stability_excess(const FloquetMultipliers& multipliers, const std::complex<double>& mu);

/// Where the structural multiplier is larger, the other multipliers of that mesh are not used.
inline constexpr double structural_bound = 5e-2;

/// The first segment (from 0) whose end is tangent to its event surface, |h_x f| < 1e-4 |h_x| |f|; -1: none.
int touching_segment(const TestedPoint& point);

/// Why a located zero of the function of folds or branch points (`target` 1) or of period doublings (-1) is no such
/// point, "" where it may be one. `what` changes there, for the text. Decides nothing where multipliers are not
/// computed or partly unknown (h_x f = 0), and where the problem is not that of orbits in one parameter
/// (TestedPoint::one_parameter_family).
std::string objection_without_multiplier(const TestedPoint& point, int target, const std::string& what);

/// The multipliers that surely crossed the unit circle (of eigenvalues: the imaginary axis) between two points.
struct StabilityChange {
  int count = 0;  ///< more unstable ones behind, negative: fewer
  std::complex<double> before, after;
};

/// Number of unstable multipliers, as far as it is known.
struct UnstableCount {
  int inside = 0;
  int outside = 0;
  int undecided = 0;  ///< within their uncertainty of the unit circle
};
UnstableCount count_unstable(const FloquetMultipliers& multipliers);

/// count = 0 where those that are undecided explain the difference, or multipliers of either point are not known.
StabilityChange stability_change(const FloquetMultipliers& before, const FloquetMultipliers& after);

/// Of a real multiplier.
bool is_through_one(const StabilityChange& change, bool are_eigenvalues);

/// "a multiplier goes from 0.93 to 1.49, through +1, without a label"
std::string describe(const StabilityChange& change, bool are_eigenvalues);

}  // namespace tchat
