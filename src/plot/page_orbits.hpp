/// The labelled solutions of a branch as JSON, for the script of a page: states in time, with events and jumps.
#pragma once

#include <map>
#include <string>

#include "files/branch_file.hpp"

namespace tchat {

struct PageOrbits {
  std::string json;                  ///< a list, one entry for each solution that is embedded
  std::map<int, std::size_t> place;  ///< by label: where in the list
  std::string missing;               ///< why there are none, or not all of them; "" where all are there
};

/// Of the q-file beside the branch. Long orbits are thinned, and of many labels all special points and an even choice
/// of the others are embedded, so that a page stays small. `dimension`: states of one segment where the file does not
/// say (0: it does). A q-file that is missing or cannot be read leaves the list empty.
PageOrbits page_orbits(const BranchFile& file, int dimension);

}  // namespace tchat
