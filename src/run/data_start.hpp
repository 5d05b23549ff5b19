/// Starts from data files, which families choose from: one state, or the segments of an orbit with their durations.
#pragma once

#include "run/start_selection.hpp"

namespace tchat {

/// The segments of the signature on a mesh of NTST intervals.
OrbitShape shape_of_segments(const RunSettings& settings);

/// An equilibrium at the state of the file. Throws UserError: no such file, or data that do not fit.
SelectedStart start_from_state(const std::string& path, const RunSettings& settings, const HybridSystem& system);

/// The segments of the signature, one after the other. Durations are those of the problem, of the file, or of the
/// command line; that of one segment may be the time that its rows span. Throws UserError: no such file, data that do
/// not fit, a duration that is not given.
SelectedStart start_from_orbit(const std::string& path, const RunSettings& settings, const HybridSystem& system);

}  // namespace tchat
