/// `tchat grazing`: the local analysis of a grazing orbit or point (2.5, 2.7; src/docs/grazing.md).
#pragma once

#include <ostream>

#include "maps/grazing_request.hpp"

namespace tchat {

/// Prints what is known of it on `screen`. Throws UserError for what the user can mend, ComputationError where the
/// orbit cannot be integrated or the map not be computed.
void analyse_grazing(const GrazingRequest& request, std::ostream& screen, std::ostream& warnings);

}  // namespace tchat
