/// The points of a branch as lines of the p-file and as the table on the screen.
#pragma once

#include <string>
#include <vector>

#include "files/solution_file.hpp"
#include "model/hybrid_system.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// The columns of a p-file, in AUTO's order: the first free parameter, the solution measure, maxima of the first
// states, the further free parameters, user functions, and last the period.

/// The names of a problem that heads columns; element k - 1 names U(k), PAR(k), event function k, jump k.
struct ProblemNames {
  std::vector<std::string> states;
  std::vector<std::string> parameters;
  std::vector<std::string> user_functions;
  std::vector<std::string> events = {};
  std::vector<std::string> jumps = {};

  static ProblemNames of(const HybridSystem& system);
  /// With the monitors of a run.
  static ProblemNames of(const HybridSystem& system, const RunSettings& settings);
  /// Of a parameter that is not the problem's own.
  void set_parameter(int k, const std::string& name);
  /// The name, or U(k), PAR(k) beyond the problem's own.
  std::string state(int k) const;
  std::string parameter(int k) const;
};

/// One column: what its number is and its heading.
struct PointColumn {
  enum class Kind {
    parameter,  ///< PAR(index)
    l2_norm,    ///< of the whole orbit, segments weighted by their durations
    maximum,    ///< of U(index) over the whole orbit; at an equilibrium U(index) itself
    minimum,
    integral,
    component_l2_norm,
    user_function,  ///< the index-th value of the problem's user functions
    period          ///< the sum of the durations
  };
  Kind kind = Kind::period;
  int index = 0;  ///< from 1; 0 where there is nothing to count
  std::string name;
  int segment = 0;  ///< from 1: the segment whose duration a parameter is; 0: of none
};

/// The measure that IPLT selects: 0 or beyond 3 n in size the L2 norm, 1..n maxima, -1..-n minima, n+1..2n integrals,
/// 2n+1..3n L2 norms of single states.
PointColumn measure_column(int selector, int dimension, const ProblemNames& names);

/// All columns of a run. `free_parameters` as in the settings, durations and output-only ones included; the number of
/// maxima is min(n, 7 - free parameters that are not durations), none when that is negative. A user function that is
/// listed as a monitor has one column. Equilibria have no period.
std::vector<PointColumn> point_columns(const RunSettings& settings, const ProblemNames& names);

// The p-file in AUTO-07p's layout: sections of header lines, which begin with "   0", and one line for each point,
//
//     BR (I4)  +-PT (I6)  TY (I4)  LAB (I5)  values (19 columns each)         PT negative: stable
//
// The header holds the constants of the run as `KEY = value` pairs, names, under keys of our own the signature and,
// where durations do not begin at PAR(61), the number of parameters of the problem, and ends with a bare "   0" and
// the headings of the columns.

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

// The table on the screen: branch, point, type in letters, label and at most five columns of 13, so that a line fits
// 100 characters: the free parameters and the period, then the solution measure, user functions and maxima,
//
//       BR    PT  TY  LAB        alpha      L2-NORM  ...
//        1   -12  GR    4  1.99833E+00  1.41421E+00
//
// PT is negative when the orbit is stable, as in the p-file. The d-file has the same lines.

/// The name of a column on the screen: "T1" for the first duration, else its heading.
std::string shown_name(const PointColumn& column);

/// The headings, one line with its newline.
std::string format_table_heading(const std::vector<PointColumn>& columns);

/// The line of one point; inadmissible points end in the word `inadmissible`. Types as AUTO shows them: blank for
/// ordinary and for regular points.
std::string format_table_line(const PointLine& point, const std::vector<PointColumn>& columns);

}  // namespace tchat
