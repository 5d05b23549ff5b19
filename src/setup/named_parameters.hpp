/// Parameters named in constants (ICP, UZR, THL, HOLD): their indices are known when the problem is.
#pragma once

#include "constants/settings_names.hpp"
#include "hybrid/hybrid_system.hpp"

namespace tchat {

/// Replaces names in the settings by PAR indices: those of the problem's parameters, of durations (T1, T2, ...) and of
/// monitors (bvp/monitor.hpp). Throws UserError for a name that the problem does not have, with those it has.
void resolve_names(RunSettings& settings, const HybridSystem& system);

}  // namespace tchat
