/// A stored orbit against forward integration: every segment from its stored start (segment_check.hpp), every jump, and
/// the multipliers (return_pencil.hpp) against those of the run's d-file.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "kinds/return_pencil.hpp"
#include "kinds/segment_check.hpp"
#include "orbit/orbit.hpp"
#include "settings/family.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

struct OrbitCheck {
  std::vector<SegmentCheck> segments;  ///< state_defect counts the jump after the segment
  std::vector<double> durations;       ///< T_s
  double period = 0.0;                 ///< sum |T_s|, 1 for an orbit that takes no time
  bool goes_forward = true;            ///< sum T_s > 0, finite
  /// Of boundary value problems with integral conditions: the largest one, relative to its size.
  std::optional<double> integral_defect;
  /// Of the return map along the integrated segments; empty when one of them could not be integrated, or the
  /// map does not determine them.
  std::vector<std::complex<double>> multipliers;
  bool computes_multipliers = false;            ///< those of the return map were asked for
  std::optional<double> multiplier_difference;  ///< from the stored ones (largest_difference)
  double multiplier_error = 0.0;                ///< largest backward error of a stored one
  /// Of the multipliers that the label must have (critical_label.hpp): the largest distance from the nearest one, and
  /// the largest backward error.
  std::optional<double> critical_difference;
  double critical_error = 0.0;
};

/// Sizes by which defects of the states are measured: max |x_k| over the orbit, but at least a thousandth of the
/// largest.
Eigen::VectorXd state_scales(const Orbit& x);

/// Every segment from its stored start; column s of `following` (n x segments) is the state that its jump must lead to,
/// which state_defect counts; no column: not looked at. `settings` has all segments of the orbit. An event that could
/// have ended a segment but whose jump takes whole turns off `angles` (states, from 0) alone is none.
std::vector<SegmentCheck> check_segments(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                                         const Eigen::VectorXd& scale, const Eigen::MatrixXd& following,
                                         double tolerance, const std::vector<Eigen::Index>& angles = {});

/// What the checked segments make of the return map's derivative, in states divided by `scale`; empty where one of them
/// could not be integrated.
std::vector<SegmentLink> links_of(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                                  const std::vector<SegmentCheck>& segments, const Eigen::VectorXd& scale);

/// `stored`: the multipliers of the d-file; empty when there are none. `critical`: those that the label must have, by
/// the computed ones.
OrbitCheck check_orbit(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                       const std::vector<std::complex<double>>& stored, double tolerance,
                       const CriticalMultipliers& critical = {});

/// The solution of a boundary value problem: segments, boundary and integral conditions.
OrbitCheck check_boundary_values(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                                 double tolerance);

/// What is beyond `tolerance`, with the growth of errors (growth * 1e-9 where that is more; undecided beyond 1e-2): one
/// list for a segment, with the duration of the whole orbit at the first and integral conditions at the last one; one
/// for the multipliers.
enum class Defect { not_integrated, undecided, duration, state, integral, time, event, multipliers, critical };
std::vector<Defect> defects_of(const OrbitCheck& check, std::size_t segment, double tolerance);
/// They differ by more than `tolerance`, and by more than a change of the map by a hundredth of it explains:
/// multipliers that are many times as sensitive as the map (Jordan blocks, impacts of low velocity) are known to less.
bool are_multipliers_wrong(const OrbitCheck& check, double tolerance);
/// The same of the multipliers that the label must have: it is no point of its kind.
bool are_critical_ones_wrong(const OrbitCheck& check, double tolerance);

}  // namespace tchat
