/// The k-segment impacting orbit as a problem for AUTO-07p: IPS = 4 with 4k functions, 5k boundary conditions, k free
/// durations and alpha, Jacobians written out by hand (JAC = 1).
///
///     u_s' = T_s f(u_s),   1 - u_s,1(1) = 0,   u_{s+1}(0) = (x1, -r x2, y1, y2)(u_s(1))   (s = 1..k, cyclic)
///
/// PAR(1) = alpha, PAR(20 + s) = T_s.
#pragma once

#include <string>

namespace tchat::benchmark {

inline constexpr int auto_first_duration = 21;

/// The Fortran source, starting data in closed form included.
std::string auto_source(int segments);

struct AutoSettings {
  int segments = 1;
  int intervals = 50;    ///< NTST
  int points = 10;       ///< NMX
  bool details = false;  ///< write the Newton history to the diagnostics file
};

/// The constants file: the same mesh, tolerances, weights and fixed step as BranchWalk uses.
std::string auto_constants(const AutoSettings& settings);

}  // namespace tchat::benchmark
