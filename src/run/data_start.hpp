/// Starts from data files and trajectories of simulations, and their conversion to labelled solutions.
#pragma once

#include <ostream>
#include <string>

#include "files/dat_file.hpp"
#include "files/run_files.hpp"
#include "run/orbit_start.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// Starts from data files, which families choose from: one state, or the segments of an orbit with their durations.

/// The segments of the signature on a mesh of NTST intervals.
OrbitShape shape_of_segments(const RunSettings& settings);

/// An equilibrium at the state of the file. Throws UserError: no such file, or data that do not fit.
SelectedStart start_from_state(const std::string& path, const RunSettings& settings, const HybridSystem& system);

/// The segments of the signature, one after the other. Durations are those of the problem, of the file, or of the
/// command line; that of one segment may be the time that its rows span. Throws UserError: no such file, data that do
/// not fit, a duration that is not given.
SelectedStart start_from_orbit(const std::string& path, const RunSettings& settings, const HybridSystem& system);

// Starting data from the trajectory of a simulation: the period in it that closes best.

/// Of NAME.trajectory: the segments of the signature, one after the other, after which the state is nearest to that at
/// their start, as a share of the motion's range; of a signature without a section the last return to the final state.
/// Of the table that `tchat orbit` prints: its segments. Parameters are those of the heading. Throws UserError, naming
/// `path`, when the motion has no such segments.
DatFile data_of_trajectory(const std::string& path, const RunSettings& settings);

// `tchat dat NAME`: starting data as a labelled solution, what TC-HAT's @gmdat does.

/// Reads the constants (dimension, signature, mesh), the plugin (parameter values) and D.dat, fits the mesh and writes
/// q.O with the data as label 1, uncorrected and without direction. An existing q.O is kept as q.O~. Returns the path
/// written. `notices` is told which plugin of another folder is loaded. Throws UserError, and ComputationError when the
/// file cannot be written.
std::string convert_data(const RunRequest& request, std::ostream& notices);

}  // namespace tchat
