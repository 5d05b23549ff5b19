/// The discontinuity map of a grazing point, and how far its expansion is from the exact map.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "maps/grazing_point.hpp"

namespace tchat {

// Taylor coefficients of a smooth vector function of one variable, from its values: for functions that are known to
// rounding but whose derivatives are not at hand.

struct TaylorCoefficients {
  Eigen::MatrixXd columns;  ///< column k: of t^k at t = 0
  Eigen::VectorXd errors;   ///< estimated, of each column: largest entry
};

/// The first `count` (at most 6) coefficients at 0, by the polynomial through Chebyshev points of [-size, size]: `size`
/// is halved, from `first_size`, and for each coefficient that one taken where two neighbours agree best, between the
/// truncation of long intervals and the rounding of short ones. Values that are not finite (too far away) leave a size
/// out; errors are infinite, columns NaN, where no two sizes remain.
TaylorCoefficients taylor_coefficients(const std::function<Eigen::VectorXd(double)>& function, double first_size,
                                       int count);

// The discontinuity map of a grazing point (2.61-2.70, 2.71-2.79): what contact makes of the intersections of
// trajectories with a section through x*.
//
// On P (h_P = h_{D,x} f = 0): x0 in P is where a trajectory of the smooth flow, that ignores the contact, has its
// least h_D. Its penetration is -h_D(x0). Where that is positive the trajectory has met D before, at x_in, has jumped
// to x_out = g_D(x_in), and the trajectory through x_out meets P at x1 = g_P(x0). Elsewhere g_P(x0) = x0. On another
// section P' through x*, transversal to f: x0' flows to P, then g_P, and back to P' (2.73-2.79).
//
// With y = sqrt(-h_D(x0)), g_P(x0) = X(x0, y), where X is smooth in both, for y of either sign. States come and go as
// x, but all is computed in deviations from x*, so that x1 - x* keeps its digits at small penetrations.
//
// Views of the system, which outlives the map; const members may be called from several threads where the problem's
// functions may.

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

// The exact discontinuity map beside its expansion, at penetrations over several decades, and the orders of the error.

inline constexpr std::array<MapOrder, 3> expanded_orders{MapOrder::half, MapOrder::one, MapOrder::three_halves};

struct ComparedPenetration {
  double penetration = 0.0;
  double change = 0.0;             ///< |g(x0) - x*|, exact; NaN where the exact map has no value
  std::array<double, 3> errors{};  ///< |exact - expansion|, of the orders above
};

/// error ~ y^power, by least squares over the smallest penetrations at which rounding does not show.
struct ErrorOrder {
  double power = 0.0;
  double from = 0.0, to = 0.0;  ///< penetrations of the fit
};

struct MapComparison {
  std::vector<ComparedPenetration> rows;            ///< penetrations falling by tens
  std::array<std::optional<ErrorOrder>, 3> orders;  ///< nothing: the expansion is exact but for rounding
};

/// On the section of the map, straight into D from x*: the shortest tangent of the section along which h_D falls.
MapComparison compare_with_expansion(const DiscontinuityMap& map, double largest, int decades);

}  // namespace tchat
