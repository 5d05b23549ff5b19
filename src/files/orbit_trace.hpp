/// Labelled solutions as orbits in physical time.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "files/labelled_solution.hpp"
#include "files/line_kind.hpp"

namespace tchat {

/// One segment: states at times, counted from the start of segment 1.
struct TraceSegment {
  std::vector<double> times;
  Eigen::MatrixXd states;  ///< n x times.size()
};

struct OrbitTrace {
  std::string name;                                     ///< for the key: "PD1"
  std::vector<std::pair<int, double>> free_parameters;  ///< PAR index and value, durations left out
  std::vector<double> parameters;                       ///< PAR(1), PAR(2), ...
  int rotation_parameter = 0;                           ///< PAR index of a torus's rotation number
  std::vector<TraceSegment> segments;
  bool is_closed = true;  ///< periodic; a trajectory and the solution of a boundary value problem are not
  LineKind kind = LineKind::stable;
  int segments_per_return = 0;     ///< of a torus, whose returns do not follow each other; 0: of an orbit
  Eigen::MatrixXd section_points;  ///< of a torus: where its returns begin, n x N
  bool is_section = false;         ///< a torus by its curve on the section: one closed segment

  bool ends_return(std::size_t s) const {
    return segments_per_return > 0 && (s + 1) % static_cast<std::size_t>(segments_per_return) == 0;
  }
  int dimension() const { return static_cast<int>(segments.front().states.rows()); }
  double period() const { return segments.back().times.back(); }
  /// Does the state jump at the end of segment s (from 0)? Judged by the sizes of the states.
  bool jumps_after(std::size_t s) const;
  /// The same of state i alone.
  bool jumps_after(std::size_t s, Eigen::Index i) const;
  Eigen::VectorXd end_of(std::size_t s) const { return segments[s].states.rightCols(1); }
  Eigen::VectorXd start_after(std::size_t s) const { return segments[(s + 1) % segments.size()].states.leftCols(1); }
};

/// `dimension`: states of one segment when the file does not say (0: as the file says). Throws UserError when neither
/// tells, or when the states are no whole number of segments.
OrbitTrace orbit_trace(const LabelledSolution& solution, const std::string& name, int dimension,
                       const std::string& path);

}  // namespace tchat
