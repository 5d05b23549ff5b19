/// Monitors as a run's constants name them (ICP, UZR, HOLD).
#pragma once

#include <memory>

#include "continuation/path_follower.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

/// The monitor that ICP(1) is; null where it is none. `system` outlives it.
std::shared_ptr<const Monitor> principal_monitor(const DefiningSystem& system, const RunSettings& settings);

/// For a branch from `start`, whose values those keep that HOLD gives none. `system` outlives them.
BranchMonitors branch_monitors(const DefiningSystem& system, const RunSettings& settings, const Orbit& start);

}  // namespace tchat
