/// What an axis of a diagram shows along a branch: a column of the p-file, a state where segments end or begin, or an
/// expression of these.
#pragma once

#include <string>
#include <vector>

#include "files/branch_file.hpp"
#include "plot/label_text.hpp"

namespace tchat {

/// The values along one section. A state at an event that comes several times in a period has as many values at each
/// point: the arms of the branch.
struct BranchQuantity {
  LabelText label;
  std::vector<std::vector<double>> arms;  ///< at least one; each has a value for every row
  std::vector<bool> known;                ///< by row: false where the orbit is needed and q.NAME does not have it
  std::string orbits_of;                  ///< what the orbits are needed for, "x2@wall"; empty: nothing
};

/// `wanted` is a column (find_column), STATE@WHERE, or an expression of them. WHERE is the name of an event function or
/// of a jump, or the number of a segment; the state is that at the end of these segments, before the jump, and with
/// STATE@after:WHERE that behind the jump. `coefficient` and `uncertainty` are those of normal forms, known at
/// labels that have one in d.NAME. Throws UserError for what is none of these, and when q.NAME is needed and
/// has none of the orbits.
BranchQuantity read_quantity(const BranchFile& file, std::size_t section, const std::string& wanted,
                             const char* option);

}  // namespace tchat
