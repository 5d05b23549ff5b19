/// Where a branch that has left its bounds is cut in a picture.
#pragma once

#include <cstddef>

#include "files/branch_file.hpp"

namespace tchat {

/// A run without --clip ends at the first point beyond RL0, RL1 (of the first column) or A0, A1 (of the second). The
/// part of the way from the point before to row `row` that is within the bounds: 1 for every other point. The bounds
/// are those of the header of the p-file, with all digits where r.NAME beside it has the same.
double part_within_bounds(const BranchFile& file, std::size_t section, std::size_t row);

}  // namespace tchat
