/// Parameters named in constants (ICP, UZR, THL, HOLD): their indices are known when the problem is.
///
/// Constants are read twice where names occur: first with stand-ins, so that all other mistakes are told before a
/// plugin is compiled, then with the problem's own names.
#pragma once

#include "constants/settings_draft.hpp"
#include "hybrid/hybrid_system.hpp"

namespace tchat {

/// Stands in for names: each has an index of its own, from the end of PAR down, where neither parameters nor durations
/// are. `used` becomes true when a name occurs.
ParameterNames names_to_come(bool& used);

/// The problem's names, while it lives, T1, T2, ... for durations, and names of monitors (bvp/monitor.hpp). A name it
/// does not have throws UserError, with those it has.
ParameterNames names_of(const HybridSystem& system);

}  // namespace tchat
