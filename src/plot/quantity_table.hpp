/// Quantities along a branch, as axes show them, as a table for other programs.
#pragma once

#include <string>
#include <vector>

#include "files/branch_file.hpp"
#include "files/table_writer.hpp"

namespace tchat {

/// One row a point, in the order of write_branch_table(): section, point, and each of `wanted` (read_quantity), under
/// the same name with a number where it has several values in a period: x2@wall, x2@wall (2). Not known where the
/// orbit is needed and there is none, and beyond the values that a section has. Throws UserError like read_quantity().
void write_quantity_table(TableWriter& out, const BranchFile& file, const std::vector<std::string>& wanted,
                          const char* option);

}  // namespace tchat
