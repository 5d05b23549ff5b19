/// What a period that grows without bound tends to: an orbit that begins and ends at an equilibrium.
#pragma once

#include <string>

#include "continuation/orbit_trend.hpp"
#include "orbit/defining_system.hpp"

namespace tchat {

/// A sentence where `x`, the last orbit of a branch whose period has grown so, comes near an equilibrium of its field;
/// "" where it does not: then the period grows for another reason (the parameter scales time, a flight takes longer, a
/// conservative system has a family of orbits). The equilibrium is found by Newton's method from the slowest mesh
/// point.
std::string homoclinic_limit(const DefiningSystem& system, const Orbit& x, const PeriodGrowth& growth,
                             const std::string& parameter_name);

}  // namespace tchat
