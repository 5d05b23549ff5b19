/// Orbits without a section: one segment with event function 0, whose start a phase condition fixes (IPS = 180 from a
/// Hopf bifurcation). At a grazing label the surface in contact becomes the section, and the orbit starts there.
#pragma once

#include <string>

#include "files/solution_file.hpp"
#include "model/hybrid_system.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

bool has_section(const RunSettings& settings);

/// The orbit of a grazing label cut at its contact: one segment from the contact to itself, with the event function in
/// contact and the identity in place of a jump. Changes the signature of `settings` likewise. The solution has no
/// direction, and its kinds are those of the label with their places on the new segment. `source` names label and file.
/// Throws UserError when the label is no grazing point.
LabelledSolution cut_at_contact(const LabelledSolution& solution, RunSettings& settings, const HybridSystem& system,
                                const std::string& source);

/// Throws UserError, which says how to compute the orbit with a section, when the orbit has none. `what` cannot be done
/// to it; `problem` is what `tchat run` takes, `path` the q-file.
void require_section(const LabelledSolution& solution, const RunSettings& settings, const HybridSystem& system,
                     const std::string& what, const std::string& problem, const std::string& path);

}  // namespace tchat
