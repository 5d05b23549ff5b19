/// Conditions that tie several constants together, before and after the problem is known.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "settings/constant_value.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// What must hold between several constants, whatever text they came from. Each constant's own limits are in the table.

/// Checks what does not depend on the problem: ICP not empty, without repetition; THU <= NDIM; RL0 < RL1; A0 < A1;
/// DSMIN <= DSMAX > 0 unless IADS = 0; IPLT from -NDIM to 3 NDIM; GCIPSI within the GCHGRZIND lists (IPS 180); one
/// grazing segment (IPS 150). Throws UserError; `place` tells where a constant was given.
void check_settings(const RunSettings& settings, const std::function<Place(std::string_view keyword)>& place);

/// Checks what depends on where the durations begin, which is known with the problem: ICP without repetition,
/// with the free parameters that problem type and branch mode need; indices of ICP, THL, UZR, HOLD, BOUNDS and PAR
/// name parameters or durations of the m segments (2m for the doubled orbit of a branch switch, except in ICP).
/// Indices that stand for names and monitors may be among them, but not among those of PAR. Throws UserError.
void check_parameter_indices(const RunSettings& settings, const std::function<Place(std::string_view keyword)>& place);

/// What is accepted without effect, in sentences beginning with `source`.
std::vector<std::string> settings_warnings(const RunSettings& settings, const std::string& source);

/// New monitored events whose contacts GCIPSI, as it was `before`, does not choose: a sentence that numbers them. Empty
/// when there are none, and when none were chosen before.
std::string unlocated_contacts(const RunSettings& before, const RunSettings& now);

// What constants say of PAR, once the problem is known: the indices of names, and which indices there are.

/// What ParameterNames gives for the name of a monitor, to which the settings give an index.
inline constexpr int names_a_monitor = 0;

/// PAR index of a name. `where`, the place and the constant, begins the message when there is no such name.
using ParameterNames = std::function<int(const std::string& name, const std::string& where)>;

/// Replaces the stand-ins of all names by PAR indices and checks all indices for a problem of this layout. Throws
/// UserError.
void resolve_names(RunSettings& settings, const ParameterLayout& layout, const ParameterNames& names);

}  // namespace tchat
