/// What becomes of a labelled orbit whose signature changes, and contacts that are born at a tangency.
#pragma once

#include <string>
#include <vector>

#include "files/solution_file.hpp"
#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"
#include "resegment/orbit_pieces.hpp"
#include "resegment/resegment.hpp"
#include "resegment/segment_list.hpp"
#include "run/orbit_start.hpp"
#include "settings/point_type.hpp"

namespace tchat {

// What becomes of a labelled orbit: its segments cut, joined, rotated or repeated, with their new index vectors.

/// The labelled orbit with the constants of its run.
struct LabelledOrbit {
  std::string name;  ///< "label 3 of q.S"
  RunSettings settings;
  LabelledSolution solution;
  std::vector<int> free_parameters;  ///< of the problem, at the label
  OrbitStart start;

  /// Of its states (orbit/orbit.hpp).
  Eigen::VectorXd sizes(const HybridSystem& system) const {
    return state_sizes(system, settings.signature(), start.orbit);
  }
};

/// The labelled orbit as x of these segments, whole: no special point any more, without direction.
LabelledOrbit with_segments(LabelledOrbit labelled, Orbit x, const SegmentList& segments, const HybridSystem& system);

/// What the next run is to continue.
struct NewOrbit {
  SegmentList segments;
  NewProblem problem;
  int type = static_cast<int>(PointType::end);
  UserPointKind kind = {};
  std::vector<UserPointKind> further = {};
  Birth birth = {};
  std::size_t contact = 0;                ///< of a grazing curve: the segment (from 0) that ends in contact
  std::vector<int> contact_jumps = {};    ///< jumps that change nothing there, one of which suits; empty: no choice
  std::vector<std::string> remarks = {};  ///< what the user may not expect, for the screen
};

/// Throws UserError when label, signature, jump and problem do not go together.
NewOrbit new_orbit(const ResegmentRequest& request, const LabelledOrbit& source, const HybridSystem& system);

// Contacts with a surface behind which another field holds, born at a tangency: which field that is, and whether its
// flow comes back.

/// The index vector that --contact gives. Throws UserError when it is none of the problem.
IndexVector given_contact(const std::string& text, const HybridSystem& system);

/// Throws UserError when contact k of the cut changes nothing: the state goes on with the field of before. Something
/// about it is not known then.
void require_change(const CutList& cut, std::size_t k, const LabelledOrbit& source, const HybridSystem& system);

/// Does a contact segment of no duration (model/events.hpp) follow contact k of the cut? Throws UserError
/// when no orbit with a short contact exists there: the field beyond the surface leads away from it, or back at once
/// (sliding).
bool is_contact_born(const CutList& cut, std::size_t k, const LabelledOrbit& source, const HybridSystem& system);

}  // namespace tchat
