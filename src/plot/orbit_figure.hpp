/// Pictures of orbits: phase portraits and time series, of labels and of trajectories of simulations.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "files/orbit_trace.hpp"
#include "model/hybrid_system.hpp"
#include "plot/figure.hpp"

namespace tchat {

// Pictures of labelled orbits: phase portraits in the plane and in space, and time series in panels one below the
// other or in one.
//
// Each orbit has a colour and a symbol; a stable one is solid, an unstable one dashed, an inadmissible one dotted, and
// the key says so. Jumps are thin pale lines, from a filled symbol (before) to an open one (after). An arrowhead shows
// the direction of time. Event surfaces are grey lines.

struct OrbitFigureOptions {
  std::vector<std::string> states;      ///< names, element k - 1 of state k; U(k) for what is missing
  std::vector<std::string> parameters;  ///< likewise PAR(k)
  std::string x;                        ///< state along x of a phase portrait: name, U(k) or number; empty: the first
  std::vector<std::string> y;  ///< states along y; one for a phase portrait; empty: the second, or the first two
  std::string z;               ///< state along z; empty: a portrait in the plane
  bool one_panel = false;      ///< time series of all states in one panel
  const HybridSystem* system = nullptr;  ///< for event surfaces
  bool surfaces = true;
  std::vector<int> events;          ///< these event surfaces; empty: chosen, see EventSurfaces
  std::vector<std::string> legend;  ///< a text for each entry of the key: orbit, or state of an orbit in one panel
};

/// Throws UserError for states that there are not, and for orbits of different dimensions.
/// Three states need `z`.
Figure phase_portrait(const std::vector<OrbitTrace>& orbits, const OrbitFigureOptions& options);
Figure time_series(const std::vector<OrbitTrace>& orbits, const OrbitFigureOptions& options);

/// State (from 0) by its name, as U(k) or as a number.
int find_state(const std::string& wanted, int dimension, const OrbitFigureOptions& options, const char* option);
std::string state_name(int state, const OrbitFigureOptions& options);

/// The key's entry of an orbit: "PD1: alpha = 3.0362".
LabelText orbit_name(const std::vector<OrbitTrace>& orbits, std::size_t k, const OrbitFigureOptions& options);

/// A single trajectory needs no name in the key.
bool is_in_key(const std::vector<OrbitTrace>& orbits, const OrbitFigureOptions& options);

/// The line of an orbit.
Stroke orbit_stroke(const std::vector<OrbitTrace>& orbits, std::size_t k);

/// The symbol of the k-th orbit at the ends of its jumps, filled before them.
Marker jump_marker(std::size_t k, const PicturePoint& at, bool before);

struct StateRange {
  double low = 0.0, high = 0.0;
};

/// Of one state along all orbits, and this part of its size more at both ends.
StateRange range_along(const std::vector<OrbitTrace>& orbits, int state, double margin = 0.0);

/// Where a picture shows a state at a time.
using StatePlace = std::function<PicturePoint(double time, const Eigen::VectorXd& state)>;

Curve segment_curve(const TraceSegment& segment, const StatePlace& place, const Stroke& stroke);

/// The jump behind segment s (from 0), in the marker's colour.
void add_jump(Panel& panel, const OrbitTrace& orbit, std::size_t s, const StatePlace& place, Marker marker);

/// The orbit's line and, if it jumps, its symbol with its name.
KeyEntry orbit_entry(const std::vector<OrbitTrace>& orbits, std::size_t k, const OrbitFigureOptions& options);

/// What dashes mean, for the key whose other entries do not say it.
void explain_dashes(Figure& figure, const std::vector<OrbitTrace>& orbits);

/// Key entry of an event surface, the number-th in the picture (from 0).
KeyEntry surface_entry(const std::string& name, std::size_t number);

// NAME.trajectory of `tchat simulate`, or the table that `tchat orbit` prints, as an orbit that need not close.

struct TrajectoryFile {
  OrbitTrace trace;                 ///< named NAME; its parameters are those of the heading
  std::vector<std::string> states;  ///< from the heading, blanks as underscores
};

/// Throws UserError with the line for what is no trajectory, or holds no rows.
TrajectoryFile read_trajectory_file(const std::string& path);

}  // namespace tchat
