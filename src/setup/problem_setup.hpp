/// Constants and plugin brought together: do they fit, and what do the constants mean for the solver.
#pragma once

#include <string>
#include <vector>

#include "bvp/weighted_norm.hpp"
#include "constants/run_settings.hpp"
#include "continuation/continuation_run.hpp"
#include "continuation/newton_chord.hpp"
#include "hybrid/hybrid_system.hpp"
#include "hybrid/identity_jump.hpp"

namespace tchat {

/// Where constants are from, for messages about them.
struct SettingsSource {
  std::string file;
  std::vector<std::string> overrides = {};  ///< KEY=VALUE of the command line

  /// "command line" or the file.
  std::string of(std::string_view keyword) const;
};

/// Throws UserError when the constants ask for what the problem does not have: another dimension, a field, event
/// function or jump that does not exist, a parameter beyond the problem's own (its value on the command line, a user
/// value of it, the run's free ones). Returns warnings: a GCSEGTYP that contradicts the jump, such a parameter printed
/// or weighted. What the Fortran interface reads of PAR is not known: any entry before the durations will do there.
std::vector<std::string> check_settings_against(const HybridSystem& system, const RunSettings& settings,
                                                const SettingsSource& source);

/// "PAR(1) to PAR(3): k, c, g", of very many the first and the last: for messages.
std::string parameter_list(const HybridSystem& system);
/// PAR index of a name given by the user: a number, or one of the problem's names. Throws UserError that begins with
/// `where` and lists the names.
int parameter_index(const HybridSystem& system, const std::string& name, const std::string& where);

/// THU as a vector of n weights, THL as one weight for each entry of PAR.
Eigen::VectorXd state_weights(const RunSettings& settings);
WeightedNorm weighted_norm(const RunSettings& settings);

NewtonSettings newton_settings(const RunSettings& settings);
/// Everything but the callbacks and label_start.
ContinuationSettings continuation_settings(const RunSettings& settings);

/// Throws UserError when the run would need more memory than the machine has free.
void check_memory(const OrbitShape& shape, int free_parameters);

}  // namespace tchat
