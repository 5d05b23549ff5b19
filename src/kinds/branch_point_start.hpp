/// Where curves of branch points of periodic orbits start. Conditions and counts: orbit/curve_conditions.hpp.
#pragma once

namespace tchat {

class HybridSystem;
struct RunSettings;
struct SelectedStart;

/// Branch points that persist in two parameters, as the symmetry breaking of a symmetric system does. Throws UserError
/// where the second parameter breaks the branch point.
void start_persistent_branch_points(const HybridSystem& system, const RunSettings& settings, SelectedStart& start);

/// Generic branch points in three parameters. Throws UserError where neither further parameter breaks the branch point,
/// so that such points are surfaces in three parameters.
void start_generic_branch_points(const HybridSystem& system, const RunSettings& settings, SelectedStart& start);

}  // namespace tchat
