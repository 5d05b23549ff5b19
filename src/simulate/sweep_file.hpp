/// The values of a sweep in their order, and O.sweep, the table of its results.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/parameter_vector.hpp"
#include "motion/growth_series.hpp"

namespace tchat {

// O.sweep, the table of a sweep, a text that awk and pandas read at once:
//
//     # tchat sweep of PROBLEM
//     # over mu from -0.82 to -0.79, 301 values
//     # over x1 from -1 to 1, 100 values, initial state
//     # PAR m = 0.28                                     every parameter that is not swept
//     # start 1: x = (...)                               or `start 1: up from x = (...)`
//     # attractor 1: periodic, signature {(1,2,2), (1,1,1)}, impacts 1, period 6.72, index 0, mode 1,1,1;1,2,2, state
//     0.1,0.2 index mu x1(0) start attractor kind period time impacts penetration lambda1 error1 x1 x2 0 -0.82 -1 1 1
//     periodic 2 6.72 1 0.01 ...
//
// One row for each recorded state, or one row of a value without any; scalars stand in every row. Columns that were
// not asked for are missing, as those of the largest values of states, max(x1), ... before the states. `period` is in
// events, `time` in time; what does not exist is `nan`. Attractor 0: none. Columns of section states have the names of
// the states, that of a swept initial state is `NAME(0)`; where the states of several event functions are recorded a
// column `event` tells which. The state of an attractor is one that `tchat simulate --state` goes on from, with the
// values of its index.

/// The name that a column has in the file: without blanks.
std::string sweep_column(std::string name);
/// Column of the largest value of a state: max(x1), as p-files call it.
std::string largest_value_column(const std::string& state);
/// Is it the name of such a column?
bool is_largest_value_column(const std::string& column);

/// One `--over`.
struct SweptQuantity {
  std::string name;  ///< of the parameter or state
  double from = 0.0, to = 0.0;
  long count = 1;
  bool is_state = false;  ///< an initial state

  /// Value i of 0..count-1; `from` and `to` are met exactly.
  double value(long i) const;
  std::string column() const { return is_state ? name + "(0)" : name; }
};

/// A line of the heading.
struct SweepAttractor {
  int number = 1;
  AttractorKind kind = AttractorKind::none;
  std::string signature;  ///< "{(1,2,2), (1,1,1)}"; "" when it is not periodic
  int impacts = -1;       ///< per period
  double period = 0.0;    ///< time; NaN
  std::size_t index = 0;  ///< of the value where it has been found first
  std::string mode;       ///< index vectors watched from `state` on, as --mode takes them
  Eigen::VectorXd state;  ///< on it there, n
};

struct SweepTable {
  std::string problem;  ///< its name
  std::vector<SweptQuantity> over;
  std::vector<std::pair<std::string, double>> parameters;  ///< name and value of those not swept
  std::vector<std::string> starts;                         ///< start 1, 2, ... in words
  std::vector<SweepAttractor> attractors;

  std::vector<std::string> names;            ///< of the columns of numbers: all but `kind`
  std::vector<std::vector<double>> columns;  ///< of each name one, a number a row
  std::vector<AttractorKind> kinds;          ///< a kind a row

  std::size_t rows() const { return kinds.size(); }
  /// By a name with or without blanks. Nothing when there is no such column.
  const std::vector<double>* column(const std::string& name) const;
  /// The recorded state k, from 1, by the names of all states: these are the last columns. Nothing when none are
  /// recorded.
  const std::vector<double>* state(int k, const std::vector<std::string>& state_names) const;
};

/// The heading: all lines that begin with '#'.
std::string sweep_heading(const SweepTable& table);

/// Reads O.sweep. Throws UserError with file, line, cause and cure for a file that is none, or is damaged; a part
/// (O.sweep.I) is refused with the command that gathers.
SweepTable read_sweep_file(const std::string& path);

// The values of a sweep: one or two swept quantities, and the order in which they are counted.

/// A swept quantity and where its values go.
struct SweepTarget {
  SweptQuantity quantity;
  int position = 1;  ///< index of the parameter or state, from 1
};

/// "mu" of "PAR(mu)", or of "mu".
std::string bare_name(const std::string& name);

/// "mu=-0.82:-0.79:301", "PAR(1)=...", "x1=-2:2:400", a parameter's name before a state's. Throws UserError, one
/// sentence with the cure.
SweepTarget parse_over(const HybridSystem& system, const std::string& text);

/// Both, which must differ; at most ten million values. Throws UserError.
std::vector<SweepTarget> parse_overs(const HybridSystem& system, const std::vector<std::string>& texts);

/// Writes the values of the swept quantities, in their order, into a state and PAR.
void set_swept_values(const std::vector<SweepTarget>& over, const Eigen::VectorXd& values, Eigen::VectorXd& state,
                      Eigen::VectorXd& par);

class SweepGrid {
 public:
  explicit SweepGrid(const std::vector<SweptQuantity>& over) : over_(over) {}

  const std::vector<SweptQuantity>& over() const { return over_; }
  std::size_t size() const;
  /// Values of the first quantity: of a chain of neighbours.
  std::size_t chain_length() const { return static_cast<std::size_t>(over_.front().count); }
  std::size_t chains() const { return size() / chain_length(); }
  /// The first quantity runs fastest.
  Eigen::VectorXd values(std::size_t index) const;

 private:
  std::vector<SweptQuantity> over_;
};

}  // namespace tchat
