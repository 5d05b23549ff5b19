/// What becomes of an attracting periodic orbit beyond its grazing contact: does an attractor persist beside it?
///
/// By Fredriksson and Nordmark's criterion (2.111, 4.22), with the square root of the discontinuity map the strongest
/// term: the bifurcation is discontinuous where some xi_n < 0, and continuous where all are positive and stay so. Where
/// there is no square root (a plane) by the piecewise linear map (3.11-3.12).
#pragma once

#include <string>
#include <vector>

#include "maps/discontinuity_map.hpp"
#include "maps/grazing_orbit.hpp"
#include "stability/grazing_response.hpp"

namespace tchat {

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

}  // namespace tchat
