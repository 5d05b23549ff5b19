/// Which index vectors a simulation watches: by the problem's index jump function, or those of a signature in turn.
#pragma once

#include <string>
#include <vector>

#include "motion/mode_rule.hpp"
#include "simulate/simulation_constants.hpp"
#include "simulate/simulation_request.hpp"

namespace tchat {

/// "1,2,1;1,3,2" of --mode, each once. Throws UserError when it is no list of triples.
std::vector<IndexVector> parse_modes(const std::string& text);
/// As parse_modes() reads them.
std::string modes_text(const std::vector<IndexVector>& modes);

/// The index jump function, where there is one and neither --signature nor --follow-signature is given, beginning at
/// --mode, at what it says of a start, or at the first index vector of gc.C. Otherwise the signature, cyclically, from
/// --mode on; a problem of one field, one event function and one jump has only {(1,1,1)}. Throws UserError.
ModeRule simulation_rule(const SimulationRequest& request, const SimulationConstants& constants,
                         const HybridSystem& system, const Eigen::VectorXd& x, const Eigen::VectorXd& par);

}  // namespace tchat
