/// Labels of invariant tori as pictures show them: the bundle of returns, and the closed curve on the section.
#pragma once

#include <string>

#include "files/labelled_solution.hpp"
#include "files/orbit_trace.hpp"

namespace tchat {

/// How many segments one return has: from the constants of the run that wrote a q-file, r.NAME, or gc.NAME. Throws
/// UserError where there are none, or the orbits of the label are no such returns.
int segments_of_return(const LabelledSolution& solution, const std::string& solution_path);

/// The returns from equal phases, those of the label and as many between them as make the torus seen. `dimension` as
/// for orbit_trace().
OrbitTrace torus_bundle(const LabelledSolution& solution, const std::string& name, int dimension,
                        const std::string& path);

/// u(phi), the trigonometric polynomial through the states in which the returns of the label begin, as one closed
/// segment; and these states.
OrbitTrace section_trace(const LabelledSolution& solution, const std::string& name, int dimension,
                         const std::string& path);

}  // namespace tchat
