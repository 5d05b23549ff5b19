/// Constants and plugin brought together: names of parameters, and whether the problem has what the constants ask for.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "model/hybrid_system.hpp"
#include "orbit/monitor.hpp"
#include "settings/run_settings.hpp"
#include "settings/settings_check.hpp"

namespace tchat {

// Parameters named in constants (ICP, UZR, THL, HOLD): their indices are known when the problem is.

/// May the problem read entries of PAR beyond its parameters? The Fortran interface, which alone knows durations, need
/// not say how many parameters it has; entries that are set for output stand before the durations too.
bool has_further_parameters(const HybridSystem& system);
/// Is PAR(k) a parameter of the problem, a duration, or an entry that the problem may read?
bool is_own_parameter(const HybridSystem& system, int k);

/// "PAR(1) to PAR(3): k, c, g", of very many the first and the last: for messages.
std::string parameter_list(const HybridSystem& system);
/// PAR index of a name given by the user: a number, or one of the problem's names. Throws UserError that begins with
/// `where` and lists the names.
int parameter_index(const HybridSystem& system, const std::string& name, const std::string& where);

/// The name of PAR(k), or of the monitor that it stands for.
std::string parameter_name(const HybridSystem& system, const RunSettings& settings, int k);
/// The names of what HOLD lists, with commas between.
std::string held_text(const HybridSystem& system, const RunSettings& settings);
/// The monitors that the constants name, in the order of their indices.
std::vector<MonitorName> monitor_names(const HybridSystem& system, const RunSettings& settings);

/// Replaces names in the settings by PAR indices: those of the problem's parameters, of durations (T1, T2, ...) and of
/// monitors (orbit/monitor.hpp). Throws UserError for a name that the problem does not have, with those it has.
void resolve_names(RunSettings& settings, const HybridSystem& system);

// Names of parameters as a problem's source spells them. Nothing is compiled or loaded, so that whoever asks runs none
// of the code in the folder.

/// The parameters of the problem that a name or path stands for (plugin_build.hpp): statements `par NAME = ...` of
/// formulas, the list `parameter_names` of C++. Empty where the source has no names, or there is none.
std::vector<std::string> parameter_names_in_source(const std::string& name_or_path);

/// The strings of the first list `parameter_names[] = {"a", "b"}` of a C++ text outside of comments; empty
/// when it is not a list of plain strings.
std::vector<std::string> parameter_names_in_cpp(std::string_view text);

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
