/// The constants of a simulation: those of a file, if there is one, with the command line's, and the signature.
#pragma once

#include <string>

#include "model/hybrid_system.hpp"
#include "plugin/fortran_problem.hpp"
#include "settings/run_settings.hpp"
#include "settings/settings_draft.hpp"
#include "simulate/simulation_request.hpp"

namespace tchat {

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

}  // namespace tchat
