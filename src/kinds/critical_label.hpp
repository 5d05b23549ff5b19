/// Multipliers that an orbit must have to be what its label says.
#pragma once

#include <complex>
#include <vector>

#include "files/solution_file.hpp"

namespace tchat {

/// +1 of a fold and of a branch point, also along a curve of folds; -1 of a period doubling and along a curve of them;
/// exp(i theta) of a torus bifurcation and along a curve of them, with the angle theta of the stored multiplier nearest
/// to the unit circle (off the real axis; without one, of the nearest in `computed`). On grazing curves +1 of a
/// grazing-fold and -1 of a grazing-flip. Empty for every other label. `is_in_parameter`: the label's branch has a
/// parameter as ICP(1) and nothing is held; else its folds and branch points are none of the orbits in a parameter.
std::vector<std::complex<double>> critical_multipliers(const LabelledSolution& solution,
                                                       const std::vector<std::complex<double>>& stored,
                                                       const std::vector<std::complex<double>>& computed,
                                                       bool is_in_parameter = true);

}  // namespace tchat
