/// Constants and plugin brought together: does the problem have what the constants ask for?
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "model/hybrid_system.hpp"
#include "settings/run_settings.hpp"

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

}  // namespace tchat
