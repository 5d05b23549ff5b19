/// How many attractors of a sweep lie on branches.
#pragma once

#include <string>
#include <vector>

#include "explore/attractor_samples.hpp"
#include "explore/exploration_commands.hpp"
#include "explore/explored_diagram.hpp"
#include "explore/orbit_catalogue.hpp"

namespace tchat {

struct Sweep {
  std::string letter;  ///< before the numbers of its attractors
  AttractorSamples samples;
  std::vector<std::string> monitors;  ///< of branches, which it has columns of in part
  bool is_cut = false;  ///< by tchat (plugin/problem_library.hpp): its orbits are followed without that section
};

/// Does a branch begin at such an attractor? At periodic ones and those at rest.
bool is_followed(const SweepAttractor& attractor);

/// The branches that the attractor of a value lies on: by its state where it rests, else by signature, period and
/// largest values, which several branches may share.
std::vector<std::string> branches_of(const OrbitCatalogue& catalogue, const Sweep& sweep, const SweptAttractor& sample);

/// Adds the sweep's counts to the diagram, and its attractors on no branch.
void measure_coverage(const Sweep& sweep, const OrbitCatalogue& catalogue, const ExplorationCommands& commands,
                      ExploredDiagram& diagram);

}  // namespace tchat
