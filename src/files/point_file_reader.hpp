/// Reads p-files (fort.7): of this program, of AUTO-07p and of AUTO 97 and TC-HAT.
///
/// A file is a sequence of sections: header lines, whose first word is 0, then one line for each point,
///
///     BR  +-PT  TY  LAB  values ...        PT negative: stable
///
/// The header's last line holds the headings of the columns; a line `columns = {3: 'name'}` has the names that are too
/// long for theirs. A section without header has the constants and headings of the one before, one with headings alone
/// (AUTO's further branches of a run) the constants. Numbers are list-directed (any width; `1.0-100`, `E+000`, `D+00`);
/// a NaN, an infinity or a field of stars is a gap (NaN) and gives one warning. A last line that was cut off is left
/// out with a warning.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/index_vector.hpp"
#include "model/parameter_vector.hpp"

namespace tchat {

/// One computed point.
struct PointRow {
  int branch = 0;
  int point = 0;  ///< signed: negative when stable
  int type = 0;   ///< type number, tens digit included
  int label = 0;  ///< 0 without
  std::vector<double> values;
};

/// The points of one run with what its header tells.
struct PointSection {
  int problem_type = 0;                ///< IPS, 0 when the header does not say
  int branch_mode = 1;                 ///< ISW
  int detect_bifurcations = 2;         ///< ISP
  int dimension = 0;                   ///< NDIM
  int segments = 0;                    ///< NSEG; 0 in files of other programs
  ParameterLayout layout;              ///< PARAMETERS, where the file has it
  int curve_type = 0;                  ///< two-parameter runs: type number of the points that make the curve, else 0
  std::vector<int> active_parameters;  ///< PAR indices free in the computation, durations and periods included
  std::map<int, std::string> states;   ///< names of states that have one, by number
  std::map<int, std::string> parameters;
  std::map<int, std::string> events;  ///< names of event functions and jumps, likewise
  std::map<int, std::string> jumps;
  Signature signature;               ///< field, event and jump of each segment; empty in files of others
  std::vector<double> bounds;        ///< RL0, RL1, A0, A1 to the digits of the header; empty without them
  std::vector<std::string> columns;  ///< names in full, headings in files without them; COLUMN(k) without header
  std::vector<PointRow> rows;

  /// The place of a column in `columns` and in the values of rows; nothing where there is none of this name.
  std::optional<std::size_t> column(const std::string& name) const;
  /// PAR(k) by its name or as "PAR(k)".
  std::string parameter_name(int k) const;
  /// The same with "T2" for the second duration: what screens and axes show.
  std::string shown_parameter(int k) const;
  std::string state_name(int k) const;
  /// "x" for "max(x)", "min(x)" or "mean(x)" of equilibria, where nothing moves; else `column` itself.
  std::string at_rest(const std::string& column) const;
  /// The free parameters that are no durations and no period (PAR(11) of AUTO's periodic orbits).
  std::vector<int> free_problem_parameters() const;
  /// The k of a column that is PAR(k), by its name or as "PAR(k)".
  std::optional<int> parameter_of_column(std::size_t column) const;
  /// A curve of special points in two parameters (|ISW| = 2), or of grazing orbits (IPS 150).
  bool is_two_parameter_curve() const;
  /// Does the sign of PT tell stability? Not for ISP = 0 and for boundary value problems without multipliers (IPS 4).
  bool has_stability() const;
};

struct PointFile {
  std::vector<PointSection> sections;  ///< in file order; none is without points
  std::vector<std::string> warnings;   ///< complete messages with path and line
};

/// Throws UserError with path:line, what was found and the cure: file missing, no p-file, a line with another number
/// of values than the one before, tokens that are no numbers, no point in the whole file.
PointFile read_point_file(const std::string& path);

/// The same for text already read; `path` is for the messages.
PointFile parse_point_file(std::string_view text, const std::string& path);

/// Does the text begin like a p-file? For telling the kinds of files apart.
bool looks_like_point_file(std::string_view text);

}  // namespace tchat
