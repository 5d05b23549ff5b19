/// What the constants of a run mean for the solver.
#pragma once

#include <Eigen/Core>

#include "continuation/continuation_run.hpp"
#include "continuation/newton_chord.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/orbit.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

/// THU as a vector of n weights, THL as one weight for each entry of PAR.
Eigen::VectorXd state_weights(const RunSettings& settings);
WeightedNorm weighted_norm(const RunSettings& settings);

NewtonSettings newton_settings(const RunSettings& settings);
/// Everything but the callbacks and label_start.
ContinuationSettings continuation_settings(const RunSettings& settings);

/// Throws UserError when the run would need more memory than the machine has free.
void check_memory(const OrbitShape& shape, int free_parameters);

}  // namespace tchat
