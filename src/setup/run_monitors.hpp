/// Monitors as a run's constants name them (ICP, UZR, HOLD).
#pragma once

#include <memory>
#include <string>

#include "constants/run_settings.hpp"
#include "continuation/path_follower.hpp"
#include "setup/problem_setup.hpp"

namespace tchat {

/// The name of PAR(k), or of the monitor that it stands for.
std::string parameter_name(const HybridSystem& system, const RunSettings& settings, int k);
/// The names of what HOLD lists, with commas between.
std::string held_text(const HybridSystem& system, const RunSettings& settings);

/// Throws UserError where a monitor names a segment that there is none of, or is held, or is ICP(1), and cannot be.
void check_monitors(const HybridSystem& system, const RunSettings& settings, const SettingsSource& source);

/// The monitor that ICP(1) is; null where it is none. `system` outlives it.
std::shared_ptr<const Monitor> principal_monitor(const DefiningSystem& system, const RunSettings& settings);

/// For a branch from `start`, whose values those keep that HOLD gives none. `system` outlives them.
BranchMonitors branch_monitors(const DefiningSystem& system, const RunSettings& settings, const Orbit& start);

}  // namespace tchat
