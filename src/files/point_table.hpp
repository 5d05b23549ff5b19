/// The table on the screen: branch, point, type in letters, label and at most five columns of 13, so that a line fits
/// 100 characters: the free parameters and the period, then the solution measure, user functions and maxima,
///
///       BR    PT  TY  LAB        alpha      L2-NORM  ...
///        1   -12  GR    4  1.99833E+00  1.41421E+00
///
/// PT is negative when the orbit is stable, as in the p-file. The d-file has the same lines.
#pragma once

#include <string>
#include <vector>

#include "files/point_columns.hpp"
#include "files/point_file.hpp"

namespace tchat {

/// The name of a column on the screen: "T1" for the first duration, else its heading.
std::string shown_name(const PointColumn& column);

/// The headings, one line with its newline.
std::string format_table_heading(const std::vector<PointColumn>& columns);

/// The line of one point; inadmissible points end in the word `inadmissible`. Types as AUTO shows them: blank for
/// ordinary and for regular points.
std::string format_table_line(const PointLine& point, const std::vector<PointColumn>& columns);

}  // namespace tchat
