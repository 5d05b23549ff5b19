/// What becomes of a labelled orbit: its segments cut, joined, rotated or repeated, with their new index vectors.
#pragma once

#include <string>
#include <vector>

#include "files/solution_file.hpp"
#include "resegment/branch_side.hpp"
#include "resegment/new_settings.hpp"
#include "resegment/resegment.hpp"
#include "run/orbit_start.hpp"
#include "settings/point_type.hpp"

namespace tchat {

/// The labelled orbit with the constants of its run.
struct LabelledOrbit {
  std::string name;  ///< "label 3 of q.S"
  RunSettings settings;
  LabelledSolution solution;
  std::vector<int> free_parameters;  ///< of the problem, at the label
  OrbitStart start;
};

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

}  // namespace tchat
