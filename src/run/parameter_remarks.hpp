/// What a user has to know of the free parameters and their bounds before a branch is computed.
#pragma once

#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "run/start_selection.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

/// RL0 and RL1 bound ICP(1): bounds that stand in the constants file for another parameter than the one that the
/// command line has made the first. "" when there are none. `in_file` are the constants before the command line.
std::string inherited_bounds(const HybridSystem& system, const RunSettings& in_file, const RunSettings& used,
                             const std::vector<std::string>& overrides, const std::string& file);

/// From a fold, period doubling or torus bifurcation with ISW = 1, parameters of ICP beyond the free one are mere
/// columns, where the curve in two parameters may have been meant. "" when there are none.
std::string idle_parameters(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start,
                            std::size_t free_count);

}  // namespace tchat
