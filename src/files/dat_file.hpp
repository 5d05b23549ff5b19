/// Starting data NAME.dat: one period of an orbit, given by rows
///
///     t  x_1 .. x_n  [x_{n+1} .. x_{2n}  ...  x_{n m}]      segment 1's states first
///
/// with t rising over any positive span. A row of t x_1 .. x_n serves too where several segments follow one another:
/// where t repeats, a segment ends before and the next one starts after the event. '#' starts a comment, blank lines
/// and one header line are skipped; blanks, tabs and commas separate; exponents may be e, E, d, D. Comment lines `#
/// PAR(k) = v` and `# PAR(name) = v` give parameter values.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tchat {

struct DatFile {
  std::vector<double> tau;                         ///< rising, from 0 to 1
  double span = 1.0;                               ///< last t - first t in the file
  Eigen::MatrixXd states;                          ///< (n m) x tau.size()
  std::vector<double> durations;                   ///< of the segments, where their own times tell them; else empty
  std::vector<std::pair<int, double>> parameters;  ///< PAR index and value, in file order
  std::vector<long> parameter_lines;               ///< where these stand, from 1
  std::vector<std::pair<std::string, double>> named_parameters;  ///< by the problem's own names, in file order
};

/// Reads the file for `segments` segments of `dimension` states each. Throws UserError with path, line, what was found
/// and the cure: missing or empty file, tokens that are no finite numbers, wrong number of columns, t falling, t
/// repeated in rows of several segments or not once an event, fewer than two rows, PAR index out of range.
DatFile read_dat_file(const std::string& path, int dimension, int segments);

/// An equilibrium: one row of its states, with or without t before them, which is not read. tau is 0, span 1.
DatFile read_point_dat_file(const std::string& path, int dimension);

/// The same for text already read; `path` is for the messages.
DatFile parse_point_dat_file(std::string_view text, const std::string& path, int dimension);
DatFile parse_dat_file(std::string_view text, const std::string& path, int dimension, int segments);

}  // namespace tchat
