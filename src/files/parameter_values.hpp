/// Values of PAR before a run: the plugin's, and the command line's, which has the last word.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "files/dat_file.hpp"
#include "model/hybrid_system.hpp"
#include "model/parameter_vector.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

/// The plugin's starting values; zero where it has none.
ParameterVector initial_parameters(const HybridSystem& system);

/// The lines `# PAR(k) = v` of starting data, names replaced by indices of `par`, in the order in which they apply.
/// Throws UserError, beginning with `path`, for a name that the problem does not have and an index beyond PAR.
std::vector<std::pair<int, double>> given_parameters(const DatFile& data, const HybridSystem& system,
                                                     const std::string& path, const ParameterVector& par);

/// PAR(2)=0.8 and PAR(omega)=0.8 of the command line. True when any differs from what was there. Throws UserError for a
/// name that the problem does not have.
bool apply_command_line(const HybridSystem& system, const RunSettings& settings, ParameterVector& par);

/// Lines "# PAR(k) = v" of a .dat file: the problem's parameters, and further entries before the durations that are not
/// zero, which the Fortran interface may read without saying so.
std::string parameter_lines(const HybridSystem& system, const Eigen::VectorXd& par);

}  // namespace tchat
