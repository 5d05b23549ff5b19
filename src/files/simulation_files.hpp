/// The files of a simulation: writers of O.trajectory and O.events, and the reader of trajectories.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "files/replaced_file.hpp"
#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "motion/hybrid_simulation.hpp"
#include "plugin/build_stamp.hpp"

namespace tchat {

// What a simulation writes: O.trajectory, the states along every segment, and O.events, what happened at its end and
// near-grazing contacts on the way.
//
// O.trajectory, after a '#' heading, an empty line between segments:
//
//     segment  i  j  k  t  U(1) .. U(n)              (i, j, k) ended the segment; j = k = 0: nothing has
//
// O.events, one line for each:
//
//     segment  i  j  k  t  h  h_x f  U(1) .. U(n) before  U(1) .. U(n) after the jump  what
//
// what: `event`; `event+2` when event function 2 came to zero at the same time; `contact`, a minimum of h near zero;
// `violation`, a monitored h that fell below zero; `beyond`, a wall already behind the start of a segment. Where
// nothing ended the segment k = 0, and the state after is the state before.

class SimulationFiles {
 public:
  static constexpr std::size_t everything = std::numeric_limits<std::size_t>::max();

  /// Opens both under temporary names, which no other simulation can at the same time (UserError). `heading` is one
  /// line: which problem, which parameters. Of the trajectory the last segments are kept, at most so many bytes, but
  /// those of two turns of a recognised orbit in any case.
  SimulationFiles(const HybridSystem& system, const std::string& name, const std::string& heading,
                  const Eigen::VectorXd& par, std::size_t trajectory_bytes = everything);

  void write(const SimulatedSegment& segment);
  void finish();

  long segments() const { return segments_; }
  /// Of the first ones, that the trajectory does not hold.
  long dropped_segments() const { return dropped_; }

  /// O.trajectory, O.events
  static std::string trajectory_path(const std::string& name) { return name + ".trajectory"; }
  static std::string events_path(const std::string& name) { return name + ".events"; }

 private:
  const HybridSystem& system_;
  Eigen::VectorXd par_;
  std::unique_ptr<FileLock> lock_;
  ReplacedFile trajectory_;
  ReplacedFile events_;
  void write_rows(std::string rows);  // of one segment, at once or kept until finish()
  void put_rows(const std::string& rows);

  std::size_t most_bytes_;
  std::deque<std::string> last_rows_;  // not yet written, because they may be dropped
  std::size_t bytes_ = 0;              // of those
  long segments_ = 0, dropped_ = 0;
  bool is_first_ = true;
};

// The rows of NAME.trajectory (`tchat simulate`), or of the table that `tchat orbit` prints, segment by segment.

/// A part of a motion between two events.
struct RecordedRows {
  IndexVector index{no_function, no_function, no_function};  ///< what ended it; all zero where the table does not say
  std::vector<double> times;
  Eigen::MatrixXd states;  ///< n x times.size()
};

struct TrajectoryRows {
  std::vector<std::string> states;                         ///< names from the heading, blanks as underscores
  std::vector<std::pair<std::string, double>> parameters;  ///< of the heading: all of a simulation, PAR(1) first
  std::vector<RecordedRows> segments;
};

/// k of "PAR(k)", the name of a parameter that has none.
std::optional<int> unnamed_parameter(const std::string& name);

/// Does the heading of the file name such columns?
bool looks_like_trajectory(const std::string& path);

/// Throws UserError with the line for what is no trajectory, or holds no rows.
TrajectoryRows read_trajectory_rows(const std::string& path);

}  // namespace tchat
