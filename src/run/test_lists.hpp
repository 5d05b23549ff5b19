/// The test functions that problem types put together, by what the constants ask for: ILP, ISP, UZR, GCIPSI, GRSTOP.
#pragma once

#include "orbit/defining_system.hpp"
#include "settings/run_settings.hpp"
#include "stability/test_function.hpp"

namespace tchat {

/// Impact velocities, the contacts that GCIPSI chooses, counted through the monitored events of all segments in order,
/// tangencies of the sections, and where crossings of a surface begin to slide.
TestList contact_tests(const DefiningSystem& system, const RunSettings& settings);

void add_impact_velocities(TestList& tests, const DefiningSystem& system, const RunSettings& settings);

/// Identity jumps: the section may become tangent to the orbit, and no orbit is cut by it beyond. Not of segment
/// `except` (from 0; -1: of all), whose contact is kept.
void add_section_tangencies(TestList& tests, const DefiningSystem& system, const RunSettings& settings, int except);

/// ILP and ISP: |ISP| = 2 all, 3 branch points only, 4 all but branch points; negative: stop at the first.
void add_bifurcations(TestList& tests, const DefiningSystem& system, const RunSettings& settings);

/// These come last: where something else vanishes too, it names the label.
void add_user_values(TestList& tests, const HybridSystem& system, const RunSettings& settings);

}  // namespace tchat
