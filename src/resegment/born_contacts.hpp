/// Contacts with a surface behind which another field holds, born at a tangency: which field that is, and whether its
/// flow comes back.
#pragma once

#include <string>

#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"
#include "resegment/new_orbit.hpp"
#include "resegment/segment_list.hpp"

namespace tchat {

/// The index vector that --contact gives. Throws UserError when it is none of the problem.
IndexVector given_contact(const std::string& text, const HybridSystem& system);

/// Throws UserError when contact k of the cut changes nothing: the state goes on with the field of before. Something
/// about it is not known then.
void require_change(const CutList& cut, std::size_t k, const LabelledOrbit& source, const HybridSystem& system);

/// Does a contact segment of no duration (model/contact_segment.hpp) follow contact k of the cut? Throws UserError
/// when no orbit with a short contact exists there: the field beyond the surface leads away from it, or back at once
/// (sliding).
bool is_contact_born(const CutList& cut, std::size_t k, const LabelledOrbit& source, const HybridSystem& system);

}  // namespace tchat
