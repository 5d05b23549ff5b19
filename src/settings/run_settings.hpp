/// The contents of a constants file under names of their own, and where in the text they were read.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/levels.hpp"
#include "model/index_vector.hpp"
#include "model/parameter_vector.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

// A place in a constants file or on the command line.

struct Place {
  std::string source;
  int line = 0;             ///< 0: the source has no lines (the command line)
  bool positional = false;  ///< in the positional form: examples show whole records
  std::string text() const;
};

// What one run is asked to do: the contents of a constants file under names of their own.
//
// The keywords of the file (NTST, GCHGRZIND, ...) appear only in src/settings; each member below names its keyword.

/// A solution to restart from: label `number`, or the `number`-th solution of a type ("PD1": type "PD", number 1).
struct StartLabel {
  std::string type;  ///< empty: a label number
  int number = 0;    ///< 0 with empty type: start from data
  bool from_data() const { return type.empty() && number == 0; }
};

struct IndexedValue {
  int index = 0;  ///< PAR or U index, from 1
  double value = 0.0;
};

/// Stop or label when PAR(parameter) crosses a value (UZR); `stop` when the index was negative.
struct UserValue {
  int parameter = 0;
  double value = 0.0;
  bool stop = false;
};

/// A parameter, duration or monitor outside of whose bounds the branch ends (BOUNDS).
struct BoundedValue {
  int parameter = 0;
  double least = 0.0, most = 0.0;
};

/// A monitor or duration that keeps a value along the branch (HOLD); without one that of the start.
struct HeldValue {
  int parameter = 0;
  std::optional<double> value = {};
};

/// End the branch at the `count`-th point of a type (STOP = [PD1, GR2]).
struct StopRule {
  std::string type;
  int count = 1;
};

/// A name in ICP, UZR, THL, HOLD or BOUNDS, and where it was found first.
struct GivenName {
  std::string text;
  std::string keyword;
  Place place;
};

/// Where a constant with PAR indices was given. Which indices there are is checked when the problem is known.
struct GivenIndices {
  std::string keyword;
  Place place;
};

/// One segment of the orbit and the event functions monitored along it.
struct SegmentSettings {
  int type = 1;              ///< GCSEGTYP: 0 identity jump, 1 other jump, 2 ends in grazing contact
  IndexVector index;         ///< GCFIND, GCHIND, GCGIND
  std::vector<int> monitor;  ///< GCHNO, GCHGRZIND
};

struct RunSettings {
  int dimension = 1;                                     ///< NDIM, of one segment
  int problem_type = periodic_orbit.number;              ///< IPS
  StartLabel start;                                      ///< IRS
  std::vector<int> free_parameters;                      ///< ICP, as given
  int mesh_intervals = 50;                               ///< NTST
  int collocation_points = 4;                            ///< NCOL
  int adapt_mesh_every = 3;                              ///< IAD
  int detect_folds = 1;                                  ///< ILP
  int detect_bifurcations = 2;                           ///< ISP
  int branch_mode = periodic_orbit.branch_mode;          ///< ISW
  int measure = 0;                                       ///< IPLT
  int boundary_conditions = 0;                           ///< NBC, of boundary value problems
  int integral_conditions = 0;                           ///< NINT, likewise
  int max_points = 100;                                  ///< NMX
  double parameter_min = -1e300, parameter_max = 1e300;  ///< RL0, RL1
  double measure_min = -1e300, measure_max = 1e300;      ///< A0, A1
  int print_every = 0;                                   ///< NPR
  int max_bifurcations = 0;                              ///< MXBF, kept
  int diagnostics_level = 2;                             ///< IID
  int max_location_iterations = 9;                       ///< ITMX
  int max_newton = 8;                                    ///< ITNW
  int full_newton = 3;                                   ///< NWTN
  int jacobian = 0;                                      ///< JAC, kept
  int adapt_step_every = 1;                              ///< IADS
  double tolerance_parameters = level::tolerance;        ///< EPSL
  double tolerance_states = level::tolerance;            ///< EPSU
  double tolerance_special = level::tolerance;           ///< EPSS
  double step = 0.01;                                    ///< DS
  double step_min = 0.0;                                 ///< DSMIN
  double step_max = 0.1;                                 ///< DSMAX
  std::vector<IndexedValue> parameter_weights;           ///< THL
  std::vector<IndexedValue> state_weights;               ///< THU
  std::vector<UserValue> user_values;                    ///< UZR
  int grazing_start = 0;                                 ///< GCISTART, kept
  int derivative_order = 1;                              ///< GCIDIFF
  std::vector<int> test_functions;                       ///< GCIPSI
  std::vector<int> fixed;                                ///< GCIFIXED, kept
  std::vector<SegmentSettings> segments;

  double harmonic_tolerance = level::tolerance;  ///< HARMTOL, of the last harmonics of a torus; 0: their number stays
  double error_bound = 1e-2;         ///< ERRMAX, of the error between mesh points and of a known multiplier; 0: none
  bool own_meshes = false;           ///< OWNMESH, of each segment
  int harmonics = 0;                 ///< NHARM, of a torus; 0: as the start has
  int grazing_jump = 1;              ///< GRJUMP
  bool stop_at_grazing = true;       ///< GRSTOP
  bool stop_when_closed = true;      ///< CLSTOP
  bool start_may_move = false;       ///< ICPMOVE
  int threads = 1;                   ///< -j of the command line: no constant, results do not depend on it
  std::vector<StopRule> stop_rules;  ///< STOP
  std::vector<HeldValue> held;       ///< HOLD
  std::vector<BoundedValue> bounds;  ///< BOUNDS
  std::string conserved;             ///< CONSERVED, a function of the state that orbits keep; empty: none
  std::string curve;                 ///< CURVE, the name of its points; empty: that of the start
  int cubic_terms = 1;               ///< CUBIC, on curves of period doublings and of torus bifurcations
  int mode = 1;                      ///< MODE, of the oscillations about an equilibrium, from the slowest
  std::string problem;               ///< PROBLEM, from the folder of the constants file; empty: none is named
  ParameterLayout layout;            ///< of the problem's PAR; that of few parameters until resolve_names()
  /// Names of monitors in ICP, UZR, THL, HOLD and BOUNDS: PAR(first_monitor(segments)), ... stand for them in this
  /// order.
  std::vector<std::string> monitors;
  /// All names in these constants, until resolve_names() has replaced them: PAR(name_index(k)) stands for name k.
  std::vector<GivenName> names;
  /// Lists of PAR indices that resolve_names() has yet to check.
  std::vector<GivenIndices> unchecked;

  /// PAR(k) = v given on the command line, by index or by the problem's own name.
  struct ParameterValue {
    std::string name;  ///< "2" or "omega"
    double value = 0.0;
  };
  std::vector<ParameterValue> parameter_values;

  Signature signature() const {
    Signature s;
    for (const SegmentSettings& segment : segments) s.push_back(segment.index);
    return s;
  }
};

inline int first_monitor(const RunSettings& settings) {
  return settings.layout.first_monitor(static_cast<int>(settings.segments.size()));
}

/// Does PAR(k) stand for a monitor of this run?
inline bool is_monitor(const RunSettings& settings, int k) {
  return k >= first_monitor(settings) && k < first_monitor(settings) + static_cast<int>(settings.monitors.size());
}

/// The index that stands for the k-th name (from 0) of the settings, beyond all that PAR has.
inline constexpr int first_name = 10'000'000;
constexpr int name_index(std::size_t k) { return first_name + static_cast<int>(k); }
inline constexpr std::size_t max_names = 1000;

/// Does PAR(k) stand for a name that has not been resolved?
inline bool is_name(const RunSettings& settings, int k) {
  return k >= first_name && k < name_index(settings.names.size());
}

// The problem that constants name (PROBLEM), so that commands on the files of a run need no -p.

/// The problem as a name or path from the current folder; `constants`: path of the file that the settings are from.
/// Nothing where they name none.
std::optional<std::string> recorded_problem(const RunSettings& settings, const std::string& constants);

/// PROBLEM of constants that are written to the path `constants`, for a problem named from the current folder.
std::string problem_to_record(const std::string& problem, const std::string& constants);

}  // namespace tchat
