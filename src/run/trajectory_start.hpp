/// Starting data from the trajectory of a simulation: the period in it that closes best.
#pragma once

#include <string>

#include "files/dat_file.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

/// Of NAME.trajectory: the segments of the signature, one after the other, after which the state is nearest to that at
/// their start, as a share of the motion's range; of a signature without a section the last return to the final state.
/// Of the table that `tchat orbit` prints: its segments. Parameters are those of the heading. Throws UserError, naming
/// `path`, when the motion has no such segments.
DatFile data_of_trajectory(const std::string& path, const RunSettings& settings);

}  // namespace tchat
