/// Where a labelled orbit is in grazing contact: at one place, at several at once, and without a section.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "files/solution_file.hpp"
#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// Where a labelled orbit is in grazing contact with an event surface, as its label says.

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

/// `own`, which the label names, and every further contact of a monitored event function (GCHGRZIND) inside a segment
/// or on a Poincare section; where `own` is an impact of velocity zero, further ones of these. In their order along the
/// orbit; the label's tolerance decides what is a contact.
std::vector<ContactPoint> simultaneous_contacts(const ContactPoint& own, const Orbit& x, const HybridSystem& system,
                                                const RunSettings& settings);

/// An event function other than `event` that falls through zero where segment s (from 0) ends: a Poincare section on
/// which an orbit can be cut there whether it touches or not. Nothing when the problem has none. `sizes`: of states.
std::optional<int> section_at_end(const Orbit& x, const Eigen::VectorXd& sizes, const HybridSystem& system, int s,
                                  int field, int event);

// Orbits without a section: one segment with event function 0, whose start a phase condition fixes (IPS = 180 from a
// Hopf bifurcation). At a grazing label the surface in contact becomes the section, and the orbit starts there.

bool has_section(const RunSettings& settings);

/// The orbit of a grazing label cut at its contact: one segment from the contact to itself, with the event function in
/// contact and the identity in place of a jump. Changes the signature of `settings` likewise. The solution has no
/// direction, and its kinds are those of the label with their places on the new segment. `source` names label and file.
/// Throws UserError when the label is no grazing point.
LabelledSolution cut_at_contact(const LabelledSolution& solution, RunSettings& settings, const HybridSystem& system,
                                const std::string& source);

/// Throws UserError, which says how to compute the orbit with a section, when the orbit has none. `what` cannot be done
/// to it; `problem` is what `tchat run` takes, `path` the q-file.
void require_section(const LabelledSolution& solution, const RunSettings& settings, const HybridSystem& system,
                     const std::string& what, const std::string& problem, const std::string& path);

}  // namespace tchat
