/// Starting data NAME.dat: reader, the segments of an orbit as parts with times of their own, and parameter values
/// before a run.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/parameter_vector.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// Starting data NAME.dat: one period of an orbit, given by rows
//
//     t  x_1 .. x_n  [x_{n+1} .. x_{2n}  ...  x_{n m}]      segment 1's states first
//
// with t rising over any positive span. A row of t x_1 .. x_n serves too where several segments follow one another:
// where t repeats, a segment ends before and the next one starts after the event. '#' starts a comment, blank lines
// and one header line are skipped; blanks, tabs and commas separate; exponents may be e, E, d, D. Comment lines `#
// PAR(k) = v` and `# PAR(name) = v` give parameter values.

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

struct OrbitPart {
  std::vector<double> times;  ///< rising
  Eigen::MatrixXd states;     ///< n x times.size()

  double duration() const { return times.back() - times.front(); }
};

/// The part that begins with `first` and goes on with `second`, whose times are moved to the end of `first`; the first
/// row of `second` is left out.
OrbitPart joined(const OrbitPart& first, const OrbitPart& second);

/// The data of an orbit with these segments: the relative times of all parts together, states between rows by linear
/// interpolation, and the durations. A part of one row lasts no time. `parts` is not empty.
DatFile data_of_parts(const std::vector<OrbitPart>& parts);

// Values of PAR before a run: the plugin's, and the command line's, which has the last word.

/// The plugin's starting values; zero where it has none.
ParameterVector initial_parameters(const HybridSystem& system);

/// The lines `# PAR(k) = v` of starting data, names replaced by indices of `par`, in the order in which they apply.
/// Throws UserError, beginning with `path`, for a name that the problem does not have and an index beyond PAR.
std::vector<std::pair<int, double>> given_parameters(const DatFile& data, const HybridSystem& system,
                                                     const std::string& path, const ParameterVector& par);

/// PAR(2)=0.8 and PAR(omega)=0.8 of the command line. True when any differs from what was there. Throws UserError for a
/// name that the problem does not have.
bool apply_command_line(const HybridSystem& system, const RunSettings& settings, ParameterVector& par);

/// Lines "# PAR(k) = v" of a .dat file: the problem's parameters, and further entries before the durations that are not
/// zero, which the Fortran interface may read without saying so.
std::string parameter_lines(const HybridSystem& system, const Eigen::VectorXd& par);

}  // namespace tchat
