/// Orbits without a section: one segment with event function 0, whose start a phase condition fixes. They cannot be cut
/// at a contact, for each of several segments needs an event function that ends it.
#pragma once

#include <string>

#include "constants/run_settings.hpp"
#include "files/labelled_solution.hpp"
#include "hybrid/hybrid_system.hpp"

namespace tchat {

/// Throws UserError, which says how to compute the orbit with a section, when the label is of an orbit without one.
/// `what` cannot be done to it, as "tchat grazing"; `problem` is what `tchat run` takes, `path` the q-file.
void require_section(const LabelledSolution& solution, const RunSettings& settings, const HybridSystem& system,
                     const std::string& what, const std::string& problem, const std::string& path);

}  // namespace tchat
