/// What a problem says of itself: which function is conserved, where impacts accumulate. Checked at given states, not
/// along orbits.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/derivative_check.hpp"
#include "orbit/quantity.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

struct ModelCheck {
  bool is_fine = true;
  std::string text;  ///< a line for each function of the problem that was looked at
};

/// H_x f of the fields of the segments at `states`, and H(g(x)) - H(x) of their jumps where the event of the segment is
/// zero near them. A state where an event function of every segment with that field, terminal or monitored, is negative
/// is mirrored at that surface: H may be another function behind it, as the energy of a spring is without contact.
/// `par`: a ParameterVector. `name`: of H. H_x by central differences, so that what is below 1e-7 of |H_x| |f|, or of 1
/// + |H|, counts as zero.
ModelCheck check_conservation(const HybridSystem& system, const Quantity& conserved, const std::string& name,
                              const std::vector<SegmentSettings>& segments, const std::vector<Eigen::VectorXd>& states,
                              const Eigen::VectorXd& par);

/// Of each chatter mode: does its jump leave states with h = 0 on the surface, and those with h = 0 and v = h_x f = 0
/// where they are? Else its impacts have no limit, as where it uses another velocity of the surface than that with
/// which h moves. Shares of the states' sizes up to 1e-9 pass. Which restitution -v_x g_x d it has there, and whether
/// that is between 0 and 1, is said and is no fault.
ModelCheck check_chatter(const HybridSystem& system, const DerivativeCheckOptions& options);

}  // namespace tchat
