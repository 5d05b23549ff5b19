/// What every simulation starts from: request, constants, plugin, state, and the index vectors that are watched.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "base/levels.hpp"
#include "model/hybrid_system.hpp"
#include "model/parameter_vector.hpp"
#include "motion/hybrid_simulation.hpp"
#include "motion/settle.hpp"
#include "plugin/fortran_problem.hpp"
#include "plugin/problem_library.hpp"
#include "settings/run_settings.hpp"
#include "settings/settings_draft.hpp"

namespace tchat {

// One `tchat simulate`: what the command line says, before any file is read.

struct SimulationRequest {
  std::string name;
  std::optional<std::string> constants;  ///< -c
  std::optional<std::string> problem;    ///< -p
  std::optional<std::string> data;       ///< -d
  std::optional<std::string> start;      ///< -s
  std::optional<std::string> output;     ///< -o
  std::vector<std::string> overrides;    ///< KEY=VALUE

  std::optional<std::string> state;      ///< "0,0.1" or "x1=0.1,x2=3"
  std::optional<std::string> modes;      ///< "1,2,1;1,3,2"
  std::optional<std::string> signature;  ///< "1,1,1;2,2,2", followed cyclically
  bool follow_signature = false;         ///< of the constants file, even where there is an index jump function

  StartSide side;  ///< --after-event, --before-event; else of a label or .dat after, of other states not given

  SimulationPlan plan;
  double tolerance = level::converged;  ///< relative, of one integration step
  double wait = 1000.0;                 ///< longest time without an event
  long steps_without_event = 500'000;   ///< of the integrator, where the time has not been given
  double contact = 1e-3;
  int rows = 200;  ///< of the trajectory, for each segment
  bool stiff = false;
  bool quiet = false;

  std::optional<int> lyapunov;  ///< --lyapunov: how many exponents; 0 all
  int section = 0;              ///< --section: event function of a return map; 0: exponents of the flow
  double accuracy = 1e-3;       ///< of the exponents, where no length is given

  bool refine = false;                   ///< --refine: the motion recorded begins with about one period of an orbit
  bool hand_over = false;                ///< --dat: write the orbit for `tchat run`
  bool without_sections = false;         ///< Poincare sections end no segments of the orbit
  std::string orbit_name;                ///< its NAME2; empty: that of the output
  std::optional<std::string> parameter;  ///< --free: the continuation parameter
};

// The constants of a simulation: those of a file, if there is one, with the command line's, and the signature.

struct SimulationConstants {
  RunSettings settings;
  std::string path;            ///< empty: no constants file, all constants have their defaults
  bool has_signature = false;  ///< of the file, or of --signature
  int file_segments = 1;       ///< of the file, whatever --signature says: of data that go with it
  bool is_given() const { return !path.empty(); }
};

/// gc.C of -c, or gc.NAME if there is one, with the command line's constants, but not its signature. Throws UserError.
SimulationConstants read_simulation_constants(const SimulationRequest& request);
/// The signature of --signature, if it is given, replaces the file's. Throws UserError.
SimulationConstants with_signature(const SimulationRequest& request, SimulationConstants constants);

/// For a plugin that cannot say its sizes itself. Throws UserError without a constants file.
ProblemSizes sizes_of(const SimulationRequest& request, const SimulationConstants& constants);

/// What a constants file says goes for this problem; without one its numbers are the problem's. Throws UserError when
/// they do not fit.
void fit_to_problem(SimulationConstants& constants, const HybridSystem& system,
                    const std::vector<std::string>& overrides);

// Which index vectors a simulation watches: by the problem's index jump function, or those of a signature in turn.

/// "1,2,1;1,3,2" of --mode, each once. Throws UserError when it is no list of triples.
std::vector<IndexVector> parse_modes(const std::string& text);
/// As parse_modes() reads them.
std::string modes_text(const std::vector<IndexVector>& modes);

/// The index jump function, where there is one and neither --signature nor --follow-signature is given, beginning at
/// --mode, at what it says of a start, or at the first index vector of gc.C. Otherwise the signature, cyclically, from
/// --mode on; a problem of one field, one event function and one jump has only {(1,1,1)}. Throws UserError.
ModeRule simulation_rule(const SimulationRequest& request, const SimulationConstants& constants,
                         const HybridSystem& system, const Eigen::VectorXd& x, const Eigen::VectorXd& par);

// What every command that simulates begins with: the plugin loaded, the constants read and brought together with it.

struct LoadedProblem {
  std::string plugin;  ///< path of the shared library
  SimulationConstants constants;
  std::unique_ptr<ProblemLibrary> library;
};

/// Compiles the plugin where that is needed; `progress`, if given, is told about it. Throws UserError.
LoadedProblem load_for_simulation(const SimulationRequest& request, std::ostream* progress);

/// The integrator's method and tolerances, and what is noted, as the command line says.
SimulationSettings simulation_settings(const SimulationRequest& request, const std::function<bool()>& interrupted);

// Where a simulation starts: parameter values, state, and the rule of its modes.

struct SimulationStart {
  ParameterVector par;
  Eigen::VectorXd state;
  std::string source;  ///< of the state, for people: "the problem's starting state"
  ModeRule rule;
  StartSide side;
  std::vector<IndexVector> watched = {};  ///< first, after the orbit's last event; empty: the rule says it
};

/// Index of a state, from 1, by the problem's name for it or U(k). Throws UserError that begins with `where` and lists
/// the names.
int state_index(const HybridSystem& system, const std::string& name, const std::string& where);

/// Parameters: plugin < .dat or label < command line. State: --state, -d (first row), -s (start of segment 1 of label
/// IRS), the problem's starting state, zeros. A label or a .dat starts after the last event of its orbit, in the mode
/// that follows there; any other state on the side of a surface that the request gives. Throws UserError.
SimulationStart simulation_start(const SimulationRequest& request, const SimulationConstants& constants,
                                 const HybridSystem& system);

}  // namespace tchat
