/// The discontinuity map of a grazing point (2.61-2.70, 2.71-2.79): what contact makes of the intersections of
/// trajectories with a section through x*.
///
/// On P (h_P = h_{D,x} f = 0): x0 in P is where a trajectory of the smooth flow, that ignores the contact, has its
/// least h_D. Its penetration is -h_D(x0). Where that is positive the trajectory has met D before, at x_in, has jumped
/// to x_out = g_D(x_in), and the trajectory through x_out meets P at x1 = g_P(x0). Elsewhere g_P(x0) = x0. On another
/// section P' through x*, transversal to f: x0' flows to P, then g_P, and back to P' (2.73-2.79).
///
/// With y = sqrt(-h_D(x0)), g_P(x0) = X(x0, y), where X is smooth in both, for y of either sign. States come and go as
/// x, but all is computed in deviations from x*, so that x1 - x* keeps its digits at small penetrations.
///
/// Views of the system, which outlives the map; const members may be called from several threads where the problem's
/// functions may.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "maps/cross_section.hpp"
#include "maps/grazing_point.hpp"

namespace tchat {

/// How much of the expansion of X: terms up to y; y^2, x - x* and p - p*; y^3, y (x - x*) and y (p - p*); or all of X.
enum class MapOrder { half, one, three_halves, exact };

/// X(x, y; p) = x* + y_ y + yy y^2 + yyy y^3 + dx (x - x*) + ydx y (x - x*) + dp (p - p*) + ydp y (p - p*) + ...
///
/// x on the section, x - x* and p - p* as small as y^2. Matrices take tangents of the section; what they make of
/// others is that of their projection along f. Columns of dp, ydp: `parameters`.
struct DiscontinuityExpansion {
  Eigen::VectorXd y, yy, yyy;   ///< n
  Eigen::MatrixXd dx, ydx;      ///< n x n
  std::vector<int> parameters;  ///< PAR indices, from 1: all of the problem's
  Eigen::MatrixXd dp, ydp;      ///< n x parameters
  double error = 0.0;           ///< estimated, the largest of all entries
};

class DiscontinuityMap {
 public:
  /// On P, or on P' where `section` is given. Throws UserError when P' does not exist or the flow is tangent to it, and
  /// ComputationError when a function cannot be evaluated near x*.
  DiscontinuityMap(const HybridSystem& system, GrazingPoint point, std::optional<CrossSection> section = {});
  ~DiscontinuityMap();
  DiscontinuityMap(DiscontinuityMap&&) noexcept;
  DiscontinuityMap& operator=(DiscontinuityMap&&) noexcept;
  DiscontinuityMap(const DiscontinuityMap&) = delete;
  DiscontinuityMap& operator=(const DiscontinuityMap&) = delete;

  const GrazingPoint& point() const;
  const std::optional<CrossSection>& section() const;
  /// The row of derivatives of the section's function at x*: h_{P,x} or h_{P',x}, n.
  const Eigen::VectorXd& section_gradient() const;
  const DiscontinuityExpansion& expansion() const;

  /// -h_D where the smooth trajectory through x meets P: positive when there is contact. x is near the section, not
  /// necessarily on it. NaN when it cannot be computed.
  double penetration(const Eigen::VectorXd& x, const ParameterVector& par) const;

  /// The map to an order, or exact. The identity where the penetration is not positive. x is on the section of `par`
  /// (P depends on the parameters). Entries are NaN where the exact map has no value: too far from x*.
  Eigen::VectorXd apply(const Eigen::VectorXd& x, const ParameterVector& par, MapOrder order) const;
  Eigen::VectorXd exact(const Eigen::VectorXd& x, const ParameterVector& par) const {
    return apply(x, par, MapOrder::exact);
  }
  /// Derivative by x of the same, n x n, at positive penetration (elsewhere Id); without bound as that goes to zero.
  Eigen::MatrixXd derivative(const Eigen::VectorXd& x, const ParameterVector& par, MapOrder order) const;

  /// The same in deviations from x*, at the parameters of the grazing point: X(x* + d, y) - x* for any y, d on the
  /// section; and the penetration of x* + d. They keep their digits however small d and y are.
  /// `onto_section`: where the smooth flow through x* + d meets the section.
  Eigen::VectorXd onto_section(const Eigen::VectorXd& d) const;
  Eigen::VectorXd smooth_deviation(const Eigen::VectorXd& d, double y) const;
  double penetration_of_deviation(const Eigen::VectorXd& d) const;
  Eigen::VectorXd expanded_deviation(const Eigen::VectorXd& d, double y, MapOrder order) const;

 private:
  struct Implementation;
  std::unique_ptr<const Implementation> p_;
};

}  // namespace tchat
