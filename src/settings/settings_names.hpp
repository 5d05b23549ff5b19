/// What constants say of PAR, once the problem is known: the indices of names, and which indices there are.
#pragma once

#include <functional>
#include <string>

#include "settings/run_settings.hpp"

namespace tchat {

/// What ParameterNames gives for the name of a monitor, to which the settings give an index.
inline constexpr int names_a_monitor = 0;

/// PAR index of a name. `where`, the place and the constant, begins the message when there is no such name.
using ParameterNames = std::function<int(const std::string& name, const std::string& where)>;

/// Replaces the stand-ins of all names by PAR indices and checks all indices for a problem of this layout. Throws
/// UserError.
void resolve_names(RunSettings& settings, const ParameterLayout& layout, const ParameterNames& names);

}  // namespace tchat
