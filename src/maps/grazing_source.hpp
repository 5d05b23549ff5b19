/// Where `tchat grazing` finds its orbit or point: a label of a q-file, or a state given by hand.
#pragma once

#include <optional>
#include <string>

#include "files/solution_file.hpp"
#include "maps/cross_section.hpp"
#include "maps/grazing_orbit.hpp"
#include "maps/grazing_request.hpp"
#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

/// The labelled orbit cut at its contact. `jump`: the one that contact brings, where the user names it; otherwise the
/// problem or GRJUMP says. `parameter`: PAR index that moves the orbit; 0: the first free one of the run. Throws
/// UserError, beginning with `source`, for a label that is no grazing orbit, one with several contacts, and one whose
/// contact coincides with another event.
ContactTurn contact_turn(const LabelledSolution& solution, const RunSettings& settings, const HybridSystem& system,
                         std::optional<int> jump, int parameter, const std::string& source);

/// An event function by number or name ("3", "h3"), or a state by name. Throws UserError with what there is.
CrossSection cross_section(const HybridSystem& system, const std::string& text);

/// The orbit's own Poincare section, where x* lies on it and it is not P itself.
std::optional<CrossSection> own_section(const RunSettings& settings, const HybridSystem& system,
                                        const GrazingPoint& point);

}  // namespace tchat
