/// Parameters named in constants (ICP, UZR, THL, HOLD): their indices are known when the problem is.
#pragma once

#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "orbit/monitor.hpp"
#include "settings/run_settings.hpp"
#include "settings/settings_check.hpp"

namespace tchat {

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

}  // namespace tchat
