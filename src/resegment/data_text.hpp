/// An orbit as a NAME.dat file: parameter values and durations in comments, then rows of the states at the mesh points
/// and between them.
#pragma once

#include <string>

#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

std::string data_text(const Orbit& x, const HybridSystem& system);

}  // namespace tchat
