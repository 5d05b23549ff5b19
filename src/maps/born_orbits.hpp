/// The impacting periodic orbits that are born at grazing: one impact of low velocity in k returns.
///
/// Let delta be the change of a parameter, d0 the deviation from x* on P before the impact, y = sqrt(-h_D), k returns
/// of P_smooth (derivative A by the state, b by the parameter) after the discontinuity map. Where that has a square
/// root, to first order in y and delta (states with h_D = h_P = 0 do not jump),
///
///     d0 = A^k (d0 + B y) + (Id + A + ... + A^(k-1)) b delta,     h_x d0 + h_p delta = -y^2 = O(2),
///
/// n + 1 equations for d0 and y. With q = h_x (Id - A)^-1 b + h_p, by which h_D of the orbit without contact grows, and
/// Xi_{k,j} = h_x A^j (Id - A^k)^-1 (-beta) = xi_j + xi_{j+k} + ...,
///
///     y = -q delta / (sqrt(2/a*) Xi_{k,k}):  beyond contact (q delta < 0) where Xi_{k,k} > 0, before it otherwise.
///
/// Between impacts, at return j < k, h_D = sqrt(2/a*) y (Xi_{k,j} - Xi_{k,k}) must be positive. The largest multiplier
/// is -sqrt(2/a*) xi_k / (2 y). Without a square root y^2 is proportional to delta, by the piecewise linear map.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "maps/discontinuity_map.hpp"
#include "maps/grazing_orbit.hpp"

namespace tchat {

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
  std::vector<BornOrbit> orbits;  ///< k = 1, 2, ...
};

/// Up to `most` returns, in orbit.parameter. `map` is the map on P.
BornOrbits born_orbits(const HybridSystem& system, const GrazingOrbit& orbit, const DiscontinuityMap& map, int most);

}  // namespace tchat
