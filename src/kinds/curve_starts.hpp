/// Where curves in two parameters start: at branch points, double events, torus bifurcations and extrema of a monitor.
#pragma once

#include <complex>
#include <functional>
#include <memory>
#include <string>

#include "run/branch_setup.hpp"

namespace tchat {

// Where curves of branch points of periodic orbits start. Conditions and counts: orbit/curve_conditions.hpp.

class HybridSystem;
struct RunSettings;
struct SelectedStart;

/// Branch points that persist in two parameters, as the symmetry breaking of a symmetric system does. Throws UserError
/// where the second parameter breaks the branch point.
void start_persistent_branch_points(const HybridSystem& system, const RunSettings& settings, SelectedStart& start);

/// Generic branch points in three parameters. Throws UserError where neither further parameter breaks the branch point,
/// so that such points are surfaces in three parameters.
void start_generic_branch_points(const HybridSystem& system, const RunSettings& settings, SelectedStart& start);

// Periodic orbits at which two events come at once (orbit/curve_conditions.hpp): where sliding begins or ends
// (crossing- and switching-sliding), or where an impact meets another surface.

class DefiningSystem;
class OrbitCondition;
struct SelectedStart;

/// The second event function vanishes where the GR label of the start says. Throws UserError where no such curve
/// starts.
std::unique_ptr<OrbitCondition> double_event_condition(const DefiningSystem& defining, const SelectedStart& start);

// The pair of multipliers that a torus curve begins with.

class DefiningSystem;
struct SelectedStart;

/// The complex multiplier of the uncorrected start that is nearest to the unit circle; at a 1:1 or 1:2 resonance, where
/// the pair may have become real by rounding, one beside it. Throws UserError where there is none.
std::complex<double> pair_at(const DefiningSystem& defining, const SelectedStart& selected);

/// The cosine of its angle, which a curve in three parameters keeps; at a strong resonance its exact value.
///
/// Count. N unknowns and N equations of the orbit, as ever, three parameters: N + 3 unknowns. Product one, the cosine
/// of the angle, and pseudo-arclength: N + 3 equations. Throws UserError at a 1:1 or 1:2 resonance, where the pair has
/// no angle to keep.
double fixed_cosine(const DefiningSystem& defining, const SelectedStart& start);

// Extrema of a monitor that is ICP(1), along families of periodic orbits: curves of them, and gradients at labels.
// Conditions and counts: orbit/monitor_gradient.hpp.

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
