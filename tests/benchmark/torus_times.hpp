/// Table (d): steps along a branch of invariant tori against the number N of orbits, beside a simulation and a curve
/// fitted to its points.
#pragma once

#include <vector>

namespace tchat::benchmark {

/// `orbits`: values of N, odd; `steps` of each are measured; `returns` of the simulation. NTST = 20, NCOL = 4.
void print_torus_times(const std::vector<int>& orbits, int steps, int returns);

}  // namespace tchat::benchmark
