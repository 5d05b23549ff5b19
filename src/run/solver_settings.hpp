/// What the constants of a run mean for its computation: settings of the solver, monitors and test functions.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "continuation/continuation_run.hpp"
#include "continuation/newton_chord.hpp"
#include "continuation/path_follower.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/orbit.hpp"
#include "settings/run_settings.hpp"
#include "stability/test_function.hpp"

namespace tchat {

// Monitors as a run's constants name them (ICP, UZR, HOLD).

/// The monitor that ICP(1) is; null where it is none. `system` outlives it.
std::shared_ptr<const Monitor> principal_monitor(const DefiningSystem& system, const RunSettings& settings);

/// For a branch from `start`, whose values those keep that HOLD gives none. `system` outlives them.
BranchMonitors branch_monitors(const DefiningSystem& system, const RunSettings& settings, const Orbit& start);

// The test functions that problem types put together, by what the constants ask for: ILP, ISP, UZR, GCIPSI, GRSTOP.

/// Impact velocities, the contacts that GCIPSI chooses, counted through the monitored events of all segments in order,
/// tangencies of the sections, and where crossings of a surface begin to slide.
TestList contact_tests(const DefiningSystem& system, const RunSettings& settings);

void add_impact_velocities(TestList& tests, const DefiningSystem& system, const RunSettings& settings);

/// Identity jumps: the section may become tangent to the orbit, and no orbit is cut by it beyond. Not of segment
/// `except` (from 0; -1: of all), whose contact is kept.
void add_section_tangencies(TestList& tests, const DefiningSystem& system, const RunSettings& settings, int except);

/// ILP, on a curve in two or more parameters: turns in ICP(1), where that is a parameter of the problem. `type`: as of
/// turning_test().
void add_turning_points(TestList& tests, const DefiningSystem& system, const RunSettings& settings,
                        PointType type = PointType::user);

/// ILP and ISP: |ISP| = 2 all, 3 branch points only, 4 all but branch points; negative: stop at the first.
void add_bifurcations(TestList& tests, const DefiningSystem& system, const RunSettings& settings);

/// These come last: where something else vanishes too, it names the label.
void add_user_values(TestList& tests, const HybridSystem& system, const RunSettings& settings);

// The test functions of equilibria, by what the constants ask for: ILP, ISP, GCHGRZIND, GRSTOP.

/// Contact with every monitored event function but `except`.
TestList boundary_equilibrium_tests(const DefiningSystem& system, const RunSettings& settings, int except = 0);

/// |ISP| = 2 all, 3 branch points only, 4 Hopf bifurcations only; negative: stop at the first. Folds by ILP.
void add_equilibrium_bifurcations(TestList& tests, const RunSettings& settings);

/// On a curve of boundary equilibria: Hopf bifurcations by ISP, the eigenvalue 0 by ILP.
void add_boundary_bifurcations(TestList& tests, const DefiningSystem& system, const RunSettings& settings);

/// THU as a vector of n weights, THL as one weight for each entry of PAR.
Eigen::VectorXd state_weights(const RunSettings& settings);
/// Durations whose weight is not given have default_weight() of the period of `start`.
WeightedNorm weighted_norm(const RunSettings& settings, const Orbit& start);

NewtonSettings newton_settings(const RunSettings& settings);
/// Everything but the callbacks and label_start.
ContinuationSettings continuation_settings(const RunSettings& settings);

/// Throws UserError when the run would need more memory than the machine has free.
void check_memory(const OrbitShape& shape, int free_parameters);

}  // namespace tchat
