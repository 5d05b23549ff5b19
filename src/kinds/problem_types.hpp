/// The problem types of each family, in the order in which help and messages name them.
#pragma once

#include <vector>

#include "settings/problem_type.hpp"

namespace tchat {

std::vector<const ProblemType*> periodic_orbit_types();
std::vector<const ProblemType*> grazing_types();
std::vector<const ProblemType*> torus_types();
std::vector<const ProblemType*> boundary_value_types();
std::vector<const ProblemType*> equilibrium_types();

}  // namespace tchat
