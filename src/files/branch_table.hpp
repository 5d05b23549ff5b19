/// The points of a run as one table for other programs, one row a point, from p-, q- and d-file together.
///
///     section  branch  point  type  name  label  kind  stable  admissible
///         section from 1; type in letters, name as IRS knows it (GR1), kind in words; point positive
///     the columns of the p-file, by their names in full
///     the other parameters: those of the run that do not change, and durations where they are known
///     multiplier1_re  multiplier1_im  ...  newton_iterations
///
/// Not known: stable along curves of special points; admissible, multipliers and iterations without a block of the
/// d-file; name and kind without a label of the q-file. 1e99, which stands for "not finite" in the files, is infinite
/// for a multiplier and otherwise not known.
#pragma once

#include "files/branch_file.hpp"
#include "files/table_writer.hpp"

namespace tchat {

/// One row for each point; the multipliers are a list.
void write_branch_table(TableWriter& out, const BranchFile& file);

}  // namespace tchat
