/// Where a labelled orbit is in grazing contact with an event surface, as its label says.
#pragma once

#include <string>

#include "files/solution_file.hpp"
#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

struct ContactPoint {
  enum Where {
    inside,         ///< between the ends of the segment, at tau
    section,        ///< at its end, which is a Poincare section: the jump there changes nothing
    impact,         ///< at its end, where an impact of velocity zero is about to be born or to vanish
    grazing_curve,  ///< at its end, which the problem type keeps in contact (IPS = 150)
  };
  Where where = inside;
  int segment = 0;  ///< from 0
  int event = 1;    ///< the event function in contact
  double tau = 1.0;
};

/// Throws UserError when the label is no grazing point, or when the contact is at the end of a segment whose own event
/// matters there too (its jump changes the state, or another field follows). `source` names label and file.
ContactPoint contact_point(const LabelledSolution& solution, const Orbit& x, const HybridSystem& system,
                           const RunSettings& settings, const std::string& source);

/// The jump that the contact would bring, by the index jump function after the segment before; GRJUMP when the problem
/// has none or it leaves a choice.
int jump_at_contact(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                    const ContactPoint& contact);

}  // namespace tchat
