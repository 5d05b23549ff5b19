/// The p-file in AUTO-07p's layout: sections of header lines, which begin with "   0", and one line for each point,
///
///     BR (I4)  +-PT (I6)  TY (I4)  LAB (I5)  values (19 columns each)         PT negative: stable
///
/// The header holds the constants of the run as `KEY = value` pairs, names, under keys of our own the signature and,
/// where durations do not begin at PAR(61), the number of parameters of the problem, and ends with a bare "   0" and
/// the headings of the columns.
#pragma once

#include <string>
#include <vector>

#include "files/labelled_solution.hpp"
#include "files/point_columns.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

/// One point of a branch as tables show it.
struct PointLine {
  int branch = 1;
  int point = 1;  ///< from 1; files and tables show it modulo 9999
  bool stable = false;
  int type = 0;                ///< type number, tens digit included; 0 for an ordinary point
  int label = 0;               ///< 0 without
  std::vector<double> values;  ///< one for each column
  UserPointKind kind = {};     ///< what a UZ point is
  bool admissible = true;      ///< false: the orbit violates the model
};

/// What a section header tells.
struct PointFileHeader {
  RunSettings settings;                ///< of the run
  std::vector<int> active_parameters;  ///< free in the computation, durations included
  ProblemNames names;
  int curve_type = 0;  ///< two-parameter runs: basic type number of the points that make the curve (5, 7, 8); else 0
};

/// The header with all its lines, headings included. Every line ends with a newline.
std::string format_point_header(const PointFileHeader& header, const std::vector<PointColumn>& columns);

/// The line of one point. Values that are not finite are written as 1e99.
void append_point(std::string& text, const PointLine& point);
std::string format_point(const PointLine& point);

}  // namespace tchat
