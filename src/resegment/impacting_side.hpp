/// Which way a branch that begins at grazing leads to impacts.
#pragma once

#include "constants/run_settings.hpp"
#include "hybrid/hybrid_system.hpp"
#include "run/start_selection.hpp"

namespace tchat {

/// The sign of DS with which the run of `settings` from `start` arrives at impacts with the terminal event of segment
/// `impact` (from 0), whose end is in grazing contact: h_x f falls there along the tangent. 0 when the run finds no
/// first point or h_x f does not change along the tangent.
int impacting_side(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start, int impact);

}  // namespace tchat
