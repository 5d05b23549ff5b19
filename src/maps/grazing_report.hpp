/// The local analysis of grazing in words and tables.
#pragma once

#include <string>
#include <vector>

#include "maps/born_orbits.hpp"
#include "maps/discontinuity_map.hpp"
#include "maps/grazing_orbit.hpp"
#include "maps/grazing_verdict.hpp"
#include "maps/map_comparison.hpp"
#include "model/hybrid_system.hpp"

namespace tchat {

/// What is in contact with what; x*, h_{D,x}, h_{P,x}, f, beta, B; a*.
std::string point_report(const HybridSystem& system, const GrazingPoint& point);
/// The orbit's segments and period, A with its eigenvalues, xi_n.
std::string orbit_report(const HybridSystem& system, const GrazingOrbit& orbit, const std::vector<ImpactReturn>& xi);
/// Coefficients, and the expansion beside the exact map.
std::string map_report(const HybridSystem& system, const DiscontinuityMap& map, const MapComparison& comparison);
std::string verdict_report(const GrazingVerdict& verdict);
std::string born_report(const HybridSystem& system, const GrazingOrbit& orbit, const BornOrbits& born);

}  // namespace tchat
