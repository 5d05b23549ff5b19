/// The k-segment impacting orbit as a problem for AUTO-07p: IPS = 4 with n k functions, (n + 1) k boundary conditions,
/// k free durations and alpha, Jacobians written out by hand (JAC = 1).
///
///     u_s' = T_s f(u_s),   1 - u_s,1(1) = 0,   u_{s+1}(0) = (x1, -r x2, y1, y2)(u_s(1))   (s = 1..k, cyclic)
///
/// PAR(1) = alpha, PAR(20 + s) = T_s. With n > 4 the chain on one segment (oscillator_chain.hpp), which starts from the
/// states in the file `start`.
#pragma once

#include <string>

#include "orbit/orbit.hpp"

namespace tchat::benchmark {

inline constexpr int auto_first_duration = 21;

/// The Fortran source for n = 4, starting data in closed form included.
std::string auto_source(int segments);

/// The same for the chain of n states on one segment and a uniform mesh.
std::string auto_chain_source(int n, int intervals);

/// The file `start` of the chain: alpha and T, then the states at all nodes.
std::string auto_chain_start(const Orbit& x);

/// What of AUTO's run is not the problem's.
struct AutoRequest {
  int points = 10;      ///< NMX
  double step = 0.02;   ///< DS, fixed
  int adapt_every = 0;  ///< IAD
  int diagnostics = 0;  ///< IID: 0 nothing, 2 what AUTO writes unless told otherwise, Newton's iterations too
};

/// The constants file for orbits of this shape: the tolerances and weights that BranchWalk uses.
std::string auto_constants(const OrbitShape& shape, const AutoRequest& request);

}  // namespace tchat::benchmark
