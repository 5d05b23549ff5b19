/// Is a function of the state conserved? Checked at given states, not along orbits.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "orbit/quantity.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

struct ConservationCheck {
  bool is_conserved = true;
  std::string text;  ///< a line for each function of the problem that was looked at
};

/// H_x f of the fields of the segments at `states`, and H(g(x)) - H(x) of their jumps where the event of the segment is
/// zero near them. A state where an event function of every segment with that field, terminal or monitored, is negative
/// is mirrored at that surface: H may be another function behind it, as the energy of a spring is without contact.
/// `par`: a ParameterVector. `name`: of H. H_x by central differences, so that what is below 1e-7 of |H_x| |f|, or of 1
/// + |H|, counts as zero.
ConservationCheck check_conservation(const HybridSystem& system, const Quantity& conserved, const std::string& name,
                                     const std::vector<SegmentSettings>& segments,
                                     const std::vector<Eigen::VectorXd>& states, const Eigen::VectorXd& par);

}  // namespace tchat
