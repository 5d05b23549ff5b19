/// The periodic orbit through a grazing point, what becomes of an attractor beyond the contact, and the impacting
/// orbits born there.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "maps/discontinuity_map.hpp"
#include "maps/grazing_point.hpp"
#include "model/index_vector.hpp"
#include "stability/grazing_tests.hpp"

namespace tchat {

// The smooth periodic orbit through a grazing point, and its return map from x* to x* on P (2.5.2), by forward
// integration.
//
// Unknowns x* (n), the duration T of the last segment and one parameter p; equations
//
//     x* returns to x* (n),   h_D(x*, p) = 0,   h_P(x*, p) = 0,
//
// n + 2 each: the orbit of a label is moved to the contact itself, and to the accuracy of the integrator.

/// An orbit cut at its contact: where the search begins.
struct ContactTurn {
  IndexVector contact;       ///< (f, h_D, g_D)
  Signature aftermath = {};  ///< see GrazingPoint
  Eigen::VectorXd x;         ///< near x*, n
  ParameterVector par;
  /// Of the section that the contact lies on, which does not move x*: it belongs to the smooth orbit.
  int section_jump = no_function;
  /// From x* to x*, contact and aftermath left out. The last segment ends at x*: (f, h_D, no_function).
  Signature segments;
  std::vector<double> durations;  ///< of each
  int parameter = 1;              ///< PAR index that moves the orbit to the contact
};

struct GrazingOrbit {
  GrazingPoint point;
  Signature segments;             ///< as in ContactTurn
  std::vector<double> durations;  ///< of each
  int parameter = 1;
  Eigen::MatrixXd A;              ///< derivative of the smooth return map on P, n x n; A f = 0 and h_{P,x} A = 0
  Eigen::MatrixXd by_parameters;  ///< of its value by PAR(1), PAR(2), ..., the problem's parameters: n x parameters
  Eigen::VectorXcd multipliers;   ///< eigenvalues of A, largest modulus first; one is zero
  double moved = 0.0;             ///< of PAR(parameter), from the turn's value

  double period() const;
};

/// Throws UserError, beginning with `source`, where grazing_point() does, and ComputationError when the turn cannot be
/// integrated or Newton's method does not converge near it.
GrazingOrbit find_grazing_orbit(const HybridSystem& system, const ContactTurn& turn, const std::string& source);

// What becomes of an attracting periodic orbit beyond its grazing contact: does an attractor persist beside it?
//
// By Fredriksson and Nordmark's criterion (2.111, 4.22), with the square root of the discontinuity map the strongest
// term: the bifurcation is discontinuous where some xi_n < 0, and continuous where all are positive and stay so. Where
// there is no square root (a plane) by the piecewise linear map (3.11-3.12).

struct GrazingVerdict {
  enum class Kind { continuous, discontinuous, unstable, unknown };
  Kind kind = Kind::unknown;
  int n = 0;               ///< discontinuous by xi_n: the first n that is negative
  std::string reason;      ///< a sentence
  double linear = 0.0;     ///< without a square root: (3.11), det(Id - A L) det(Id - A)
  bool is_linear = false;  ///< decided by it

  /// "continuous", "discontinuous, n = 1", "none: ...", "cannot tell".
  std::string words() const;
};

/// `map` is the map on P of the orbit's contact; `xi` begins with xi_1.
GrazingVerdict grazing_verdict(const GrazingOrbit& orbit, const DiscontinuityMap& map,
                               const std::vector<ImpactReturn>& xi);

/// L, n x n: the discontinuity map on P to first order where it has no square root, on the side of contact.
Eigen::MatrixXd linear_contact(const DiscontinuityMap& map);

// The impacting periodic orbits that are born at grazing: one impact of low velocity in k returns.
//
// Let delta be the change of a parameter, d0 the deviation from x* on P before the impact, y = sqrt(-h_D), k returns
// of P_smooth (derivative A by the state, b by the parameter) after the discontinuity map. Where that has a square
// root, to first order in y and delta (states with h_D = h_P = 0 do not jump),
//
//     d0 = A^k (d0 + B y) + (Id + A + ... + A^(k-1)) b delta,     h_x d0 + h_p delta = -y^2 = O(2),
//
// n + 1 equations for d0 and y. With q = h_x (Id - A)^-1 b + h_p, by which h_D of the orbit without contact grows, and
// Xi_{k,j} = h_x A^j (Id - A^k)^-1 (-beta) = xi_j + xi_{j+k} + ...,
//
//     y = -q delta / (sqrt(2/a*) Xi_{k,k}):  beyond contact (q delta < 0) where Xi_{k,k} > 0, before it otherwise.
//
// Between impacts, at return j < k, h_D = sqrt(2/a*) y (Xi_{k,j} - Xi_{k,k}) must be positive. The largest multiplier
// is -sqrt(2/a*) xi_k / (2 y). Without a square root y^2 is proportional to delta, by the piecewise linear map.

struct BornOrbit {
  int returns = 1;  ///< k
  /// Of delta, on whose side it lives: +1, -1; 0: there is none at first order.
  int side = 0;
  bool beyond_contact = false;  ///< on the side where the orbit without contact would penetrate
  int hits_at = 0;              ///< would meet D once more after so many returns, and is no such orbit; 0 does not
  /// With a square root y = rate |delta|, without y^2 = rate |delta|.
  double rate = 0.0;
  /// With a square root the largest multiplier is this / |delta|; without it is this itself.
  std::complex<double> multiplier = 0.0;

  bool exists() const { return side != 0 && hits_at == 0; }
};

struct BornOrbits {
  bool has_square_root = true;
  /// q: d h_D / d delta of the orbit without contact, at its least.
  double clearance = 0.0;
  double clearance_terms = 0.0;   ///< sum of the moduli that q is made of
  std::vector<BornOrbit> orbits;  ///< k = 1, 2, ...
};

/// Up to `most` returns, in orbit.parameter. `map` is the map on P.
BornOrbits born_orbits(const HybridSystem& system, const GrazingOrbit& orbit, const DiscontinuityMap& map, int most);

}  // namespace tchat
