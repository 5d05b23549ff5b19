/// Are two labelled solutions at one parameter value the same orbit?
///
/// Orbits cut by events are compared by their states where segments end, before the jumps: the same when these agree
/// for some rotation of the signature, compared until both orbits are back at their start. A smooth orbit has no such
/// states; points of one are compared with the nearest ones on the curve of the other. An equilibrium has one state.
#pragma once

#include <vector>

#include "explore/orbit_catalogue.hpp"
#include "files/solution_file.hpp"

namespace tchat {

struct ComparedOrbit {
  const LabelledSolution* solution = nullptr;
  SignatureWord signature;  ///< with its repetitions
};

/// Largest difference of two orbits of one primitive signature, as a share of the size of each state (its largest
/// modulus on `a`, at least 1e-3 of that of all). States from 0 that are in `drifting`, which nothing depends on, are
/// left out. Infinite where they cannot be compared: tori, other signatures, other numbers of states.
double orbit_distance(const ComparedOrbit& a, const ComparedOrbit& b, const std::vector<Eigen::Index>& drifting);

}  // namespace tchat
