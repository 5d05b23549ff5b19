/// From a torus that touches a surface (GR on a run of type 182) to the curve of such tori in two parameters (type
/// 152): the orbits stay what they are, the constants ask for the contact and free one parameter more.
#pragma once

#include "files/solution_file.hpp"
#include "model/hybrid_system.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

/// The constants of the run of type 152. `icp_is_given`: the command line names its parameters; else the first
/// parameter of the problem that is not free yet becomes free. Throws UserError, `name` in front, where the label is no
/// contact of a torus, or all parameters are free already.
RunSettings grazing_torus_settings(const RunSettings& settings, const LabelledSolution& solution,
                                   const std::string& name, const HybridSystem& system, bool icp_is_given);

/// The label as the start of that run: without its direction, which is that of another problem.
LabelledSolution grazing_torus_start(LabelledSolution solution);

}  // namespace tchat
