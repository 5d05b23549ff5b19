/// Stored orbits against forward integration, and the multipliers that follow from it.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <vector>

#include "kinds/segment_check.hpp"
#include "orbit/orbit.hpp"
#include "settings/problem_type.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// Floquet multipliers of a return map from the flow Jacobians of its segments, (2.26):
//
//     P_s = (Id - f h_x / (h_x f)) Phi_s,   M = g_{m,x} P_m ... g_{1,x} P_1.
//
// Where a segment ends (nearly) in contact, h_x f = 0 to a thousandth of |h_x| |f|, nothing is divided: the change
// sigma of its duration stays an unknown, with the equation h_x (Phi_s v + sigma f) = 0. With all such sigma the
// multipliers are those of the pencil
//
//     [R Q; C D] (v; sigma) = mu [Id 0; 0 0] (v; sigma),
//
// infinite ones among them. Computed by plain products and dense eigenvalues, independent of collocation and of the
// periodic QZ iteration: small multipliers beside large ones are accurate to rounding in the large ones only.

/// One segment: all at its end x_s(1), n x n, n, row of n, n x n.
struct SegmentLink {
  Eigen::MatrixXd flow;  ///< Phi_s
  Eigen::VectorXd f;
  Eigen::RowVectorXd hx;
  Eigen::MatrixXd gx;
};

class ReturnPencil {
 public:
  /// `links` of one period, in order; at least one.
  explicit ReturnPencil(const std::vector<SegmentLink>& links);

  /// n multipliers, largest modulus first; infinite ones are 1e99. Empty when an entry of the links is not finite.
  std::vector<std::complex<double>> multipliers() const;

  /// False where any number would do: at the end of a curve of folds or period doublings on the grazing curve, to
  /// `tolerance`.
  bool determines_multipliers(double tolerance) const;

  /// The relative size of the least change of the pencil that makes mu a multiplier (0: it is one).
  double backward_error(std::complex<double> mu) const;

 private:
  Eigen::Index dimension_;
  Eigen::MatrixXd a_;  // [R Q; C D]
};

/// Largest difference of two sets of multipliers, each of one matched with one of the other: |a - b| / max(1, |a|), of
/// those beyond 1e6 their reciprocals'. The pair of smallest modulus is left out: the structural zero, which tchat's
/// files give as its size in the discretisation.
double largest_difference(std::vector<std::complex<double>> stored, std::vector<std::complex<double>> computed);

// A stored orbit against forward integration: every segment from its stored start (segment_check.hpp), every jump, and
// the multipliers (ReturnPencil) against those of the run's d-file.

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
  /// Of the multipliers that the label must have (verify_solutions.hpp): the largest distance from the nearest one, and
  /// the largest backward error.
  std::optional<double> critical_difference;
  double critical_error = 0.0;
};

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
