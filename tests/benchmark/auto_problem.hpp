/// The k-segment impacting orbit as a problem for AUTO-07p: IPS = 4 with n k functions, (n + 1) k boundary conditions,
/// k free durations and alpha, Jacobians written out by hand (JAC = 1).
///
///     u_s' = T_s f(u_s),   1 - u_s,1(1) = 0,   u_{s+1}(0) = (x1, -r x2, y1, y2)(u_s(1))   (s = 1..k, cyclic)
///
/// PAR(1) = alpha, PAR(20 + s) = T_s. With n > 4 the chain on one segment (oscillator_chain.hpp), which starts from the
/// states in the file `start`.
#pragma once

#include <string>

#include "bvp/orbit.hpp"

namespace tchat::benchmark {

inline constexpr int auto_first_duration = 21;

/// The Fortran source for n = 4, starting data in closed form included.
std::string auto_source(int segments);

/// The same for the chain of n states on one segment and a uniform mesh.
std::string auto_chain_source(int n, int intervals);

/// The file `start` of the chain: alpha and T, then the states at all nodes.
std::string auto_chain_start(const Orbit& x);

struct AutoSettings {
  int dimension = 4;
  int segments = 1;
  int intervals = 50;    ///< NTST
  int points = 10;       ///< NMX
  bool details = false;  ///< write the Newton history to the diagnostics file
};

/// The constants file: the same mesh, tolerances, weights and fixed step as BranchWalk uses.
std::string auto_constants(const AutoSettings& settings);

}  // namespace tchat::benchmark
