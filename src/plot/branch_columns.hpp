/// Which columns of p-files a diagram shows.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "files/branch_file.hpp"

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

}  // namespace tchat
