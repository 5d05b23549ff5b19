/// Extrema of a monitor that is ICP(1), along families of periodic orbits: curves of them, and gradients at labels.
/// Conditions and counts: orbit/monitor_gradient.hpp.
#pragma once

#include <functional>
#include <string>

#include "run/branch_setup.hpp"

namespace tchat {

class PeriodicOrbitSystem;

/// Is ICP(1) a monitor, and the start a label of an extremum, or a point of a curve of them?
bool starts_at_extremum(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start);
/// Throws UserError where ICP(1) is not stationary at the start in all parameters that the run frees but the last one.
void check_extremum(const HybridSystem& system, const RunSettings& settings, SelectedStart& start);

/// The curve on which it stays so.
BranchCurve extrema(const PeriodicOrbitSystem& system, const RunSettings& settings, const SelectedStart& start);

/// Says the gradient of ICP(1) in all parameters that ICP names, and what an extremum is; empty where ICP(1) is no
/// monitor or the orbits are a family in no parameter. `system` outlives it.
std::function<std::string(const Orbit&)> gradient_remark(const HybridSystem& system, const RunSettings& settings);

}  // namespace tchat
