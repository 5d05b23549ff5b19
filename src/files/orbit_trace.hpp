/// Labelled solutions as lines in physical time, and how pictures draw them.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "files/diagnostics_file.hpp"
#include "files/solution_file.hpp"

namespace tchat {

// Stability and admissibility of an orbit, or of a piece of a branch, as pictures show them.

enum class LineKind { stable, unstable, inadmissible };

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

// Labels of invariant tori as pictures show them: the bundle of returns, and the closed curve on the section.

/// How many segments one return has: from the constants of the run that wrote a q-file, r.NAME, or gc.NAME. Throws
/// UserError where there are none, or the orbits of the label are no such returns.
int segments_of_return(const LabelledSolution& solution, const std::string& solution_path);

/// The returns from equal phases, those of the label and as many between them as make the torus seen. `dimension` as
/// for orbit_trace().
OrbitTrace torus_bundle(const LabelledSolution& solution, const std::string& name, int dimension,
                        const std::string& path);

/// u(phi), the trigonometric polynomial through the states in which the returns of the label begin, as one closed
/// segment; and these states.
OrbitTrace section_trace(const LabelledSolution& solution, const std::string& name, int dimension,
                         const std::string& path);

// How the orbits of labels are drawn: what the d-file, or else the p-file, says of them.

/// Is a multiplier outside the unit circle, by more than 1e-4? At a located bifurcation PT has the sign of the point
/// before, so the multipliers tell more; that of the bifurcation itself does not count.
bool has_multiplier_outside(const DiagnosticPoint& point);

/// Inadmissible as the file says; unstable with a multiplier outside.
LineKind line_kind(const DiagnosticPoint& point);

/// The labels of q.NAME that are unstable or inadmissible by d.NAME; without d-file unstable by the sign of PT in
/// p.NAME. Empty when neither is there and can be read.
std::map<int, LineKind> label_kinds(const std::string& solution_path);
/// Of tori, whose trivial multiplier is known to the accuracy of the torus alone: stability by the sign of PT in the
/// p-file, admissibility by the d-file.
std::map<int, LineKind> torus_label_kinds(const std::string& solution_path);

}  // namespace tchat
