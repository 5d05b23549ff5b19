/// What the axes of a diagram show along a branch: columns of the p-file and other quantities, as numbers and as a
/// table.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "files/branch_file.hpp"
#include "files/table_writer.hpp"
#include "plot/label_text.hpp"

namespace tchat {

/// A column of a section, or a parameter that is fixed in it.
struct ColumnSource {
  std::size_t column = 0;
  std::optional<double> constant;
  std::string name;  ///< heading

  double value(const PointRow& row) const { return constant ? *constant : row.values[column]; }
};

/// A column by its heading ("alpha", "MAX x1", in any case), its number (1 is the first after LAB), as PAR(k), U(k) or
/// MAX U(k) where the heading is a name of the problem, or by the last word of a heading (x1 for MAX x1). A parameter
/// that has no column has its value from the q-file. Throws UserError that lists the columns there are.
ColumnSource find_column(const BranchFile& file, std::size_t section, const std::string& wanted, const char* option);

/// The same; nothing when there is no such column.
std::optional<ColumnSource> column_source(const BranchFile& file, std::size_t section, const std::string& wanted);

struct AxisColumns {
  std::string x, y;  ///< names that find_column takes
};

/// What is shown when the user does not say: two-parameter curves (all of them) in the plane of their first two free
/// problem parameters that all share, the first file's ICP(1) along x; otherwise the first column of the first file and
/// its second, the solution measure.
AxisColumns default_columns(const std::vector<BranchFile>& files);

// What an axis of a diagram shows along a branch: a column of the p-file, a state where segments end or begin, or an
// expression of these.

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

/// One row a point, in the order of write_branch_table(): section, point, and each of `wanted` (read_quantity), under
/// the same name with a number where it has several values in a period: x2@wall, x2@wall (2). Not known where the
/// orbit is needed and there is none, and beyond the values that a section has. Throws UserError like read_quantity().
void write_quantity_table(TableWriter& out, const BranchFile& file, const std::vector<std::string>& wanted,
                          const char* option);

}  // namespace tchat
