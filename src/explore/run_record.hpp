/// What the files of a run tell beside its points: which are admissible, why each direction ended, where a special
/// point may be missing, other fields at rest.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "files/diagnostics_file.hpp"
#include "files/solution_file.hpp"
#include "model/hybrid_system.hpp"

namespace tchat {

struct RunRecord {
  int points = 0;
  int inadmissible = 0;
  std::map<int, bool> admissible;  ///< by label
  bool only_at_start = false;      ///< there are points beyond the first one, and none of them is admissible
  std::vector<RecordedEnd> ends;   ///< of each direction
  std::vector<RecordedLoss> lost;  ///< special points that may be missing
};

/// By the d-file. Throws UserError where it cannot be read.
RunRecord run_record(const std::string& path);

/// The number of another field that is zero at the equilibrium of a solution, 0 where there is none. `field` is its
/// own.
int other_field_at_rest(const HybridSystem& system, const LabelledSolution& solution, int field);

}  // namespace tchat
