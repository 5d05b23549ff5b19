/// `tchat dat NAME`: starting data as a labelled solution, what TC-HAT's @gmdat does.
#pragma once

#include <ostream>
#include <string>

#include "files/run_request.hpp"

namespace tchat {

/// Reads the constants (dimension, signature, mesh), the plugin (parameter values) and D.dat, fits the mesh and writes
/// q.O with the data as label 1, uncorrected and without direction. An existing q.O is kept as q.O~. Returns the path
/// written. `notices` is told which plugin of another folder is loaded. Throws UserError, and ComputationError when the
/// file cannot be written.
std::string convert_data(const RunRequest& request, std::ostream& notices);

}  // namespace tchat
