/// The families there are. Problem types name theirs; nobody else needs to know them one by one.
#pragma once

#include "settings/family.hpp"

namespace tchat {

const SolutionFamily& periodic_orbit_family();
const SolutionFamily& torus_family();
const SolutionFamily& equilibrium_family();
const SolutionFamily& boundary_value_family();

}  // namespace tchat
