/// The command `tchat grazing`: the local analysis, and its report in words and tables.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "maps/discontinuity_map.hpp"
#include "maps/grazing_orbit.hpp"
#include "maps/grazing_source.hpp"
#include "model/hybrid_system.hpp"

namespace tchat {

// `tchat grazing`: the local analysis of a grazing orbit or point (2.5, 2.7; src/docs/grazing.md).

/// Prints what is known of it on `screen`. Throws UserError for what the user can mend, ComputationError where the
/// orbit cannot be integrated or the map not be computed.
void analyse_grazing(const GrazingRequest& request, std::ostream& screen, std::ostream& warnings);

/// What is in contact with what; x*, h_{D,x}, h_{P,x}, f, beta, B; a*.
std::string point_report(const HybridSystem& system, const GrazingPoint& point);
/// The orbit's segments and period, A with its eigenvalues, xi_n.
std::string orbit_report(const HybridSystem& system, const GrazingOrbit& orbit, const std::vector<ImpactReturn>& xi);
/// Coefficients, and the expansion beside the exact map.
std::string map_report(const HybridSystem& system, const DiscontinuityMap& map, const MapComparison& comparison);
std::string verdict_report(const GrazingVerdict& verdict);
std::string born_report(const HybridSystem& system, const GrazingOrbit& orbit, const BornOrbits& born);

}  // namespace tchat
