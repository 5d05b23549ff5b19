/// What an exploration reads of its runs: why branches ended, admissible points, and boundary equilibria.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "files/solution_file.hpp"
#include "model/hybrid_system.hpp"

namespace tchat {

// Why the directions of a branch ended, as `tchat run` reports it.

/// The sentences behind "stopped:" in the summaries of a log, one for each direction, each in one line.
std::vector<std::string> branch_ends(const std::string& log);

/// The last message of a command that has failed, without its "tchat:" and long explanations; the last line of a log
/// without one.
std::string failure_text(const std::string& log);

// Which points of a run are orbits of the model.

struct AdmissiblePoints {
  int points = 0, inadmissible = 0;
  /// Are all points inadmissible but the first one of each direction?
  bool only_at_start = false;
  std::map<int, bool> labels;  ///< is the orbit of a label admissible?
};

/// Of a d-file. Throws UserError where it cannot be read.
AdmissiblePoints admissible_points(const std::string& path);

// Where an equilibrium meets an event surface (label BE), and the field on its other side is zero there as well.

/// Another field than `field` whose equilibrium the labelled state is too: in a continuous system the branch goes on
/// with it. 0 where there is none.
int other_field_at_rest(const HybridSystem& system, const LabelledSolution& solution, int field);

}  // namespace tchat
