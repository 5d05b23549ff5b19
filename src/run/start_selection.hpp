/// Which starting solution a run uses: D.dat or a label of q.S, and the parameter values that go with it (plugin
/// < comments in the .dat < q-file < command line).
#pragma once

#include <string>
#include <vector>

#include "files/run_request.hpp"
#include "model/hybrid_system.hpp"
#include "run/orbit_start.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

struct SelectedStart {
  OrbitStart start;
  std::optional<Orbit> second;      ///< the same data on another mesh, for when no correction of the first converges
  std::string source;               ///< the file it came from
  bool from_solution = false;       ///< a label of a q-file
  bool label_start = true;          ///< IRS = 0: the first point gets a label
  bool parameters_changed = false;  ///< the command line changed a value that the label had
  ParameterVector known_parameters = ParameterVector(ParameterLayout());  ///< without the command line's values
  int branch = 1;
  int last_label = 0;      ///< largest label in the start file
  int problem_type = 0;    ///< IPS of the label, 0 if unknown
  int label = 0;           ///< its number
  int type = 0;            ///< its type number, tens digit included
  UserPointKind kind;      ///< of a UZ label
  std::vector<int> types;  ///< basic types of a label that is several things at once, the one asked for first
  std::vector<std::string> warnings;
};

/// Throws UserError: no such file, no such label (listing those there are), data that do not fit.
SelectedStart select_start(const RunRequest& request, const RunSettings& settings, const HybridSystem& system,
                           const std::vector<int>& free_parameters);

}  // namespace tchat
