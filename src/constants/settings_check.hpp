/// What must hold between several constants, whatever text they came from. Each constant's own limits are in the table.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "constants/constant_value.hpp"
#include "constants/run_settings.hpp"
#include "hybrid/parameter_vector.hpp"

namespace tchat {

/// Checks: ICP not empty, without repetition, with the free parameters that problem type and branch mode need; indices
/// of ICP, THL, UZR, PAR either 1..60 or a duration 61..60+m (THL and UZR up to 60+2m for the doubled orbit of a branch
/// switch); THU <= NDIM; RL0 < RL1; A0 < A1; DSMIN <= DSMAX > 0 unless IADS = 0; IPLT from -NDIM to
/// 3 NDIM; GCIPSI within the GCHGRZIND lists (IPS 180);
/// one grazing segment (IPS 150). Indices that stand for names and monitors may be among those of ICP, THL and UZR.
/// Throws UserError; `place` tells where a constant was given.
void check_settings(const RunSettings& settings, const std::function<Place(std::string_view keyword)>& place);

/// The part of check_settings() that concerns ICP, THL, UZR and HOLD.
void check_parameter_indices(const RunSettings& settings, const std::function<Place(std::string_view keyword)>& place);

/// What is accepted without effect, in sentences beginning with `source`.
std::vector<std::string> settings_warnings(const RunSettings& settings, const std::string& source);

/// New monitored events whose contacts GCIPSI, as it was `before`, does not choose: a sentence that numbers them. Empty
/// when there are none, and when none were chosen before.
std::string unlocated_contacts(const RunSettings& before, const RunSettings& now);

}  // namespace tchat
