/// Table (j): whole programs as users run them. `tchat run -q` on a plugin and its files, and AUTO-07p's executable on
/// the same orbit, mesh, tolerances and fixed step: each looks for the special points that it looks for unless told
/// otherwise, adapts its mesh every third step and writes what it writes.
///
/// The time of a further step is the difference of two lengths of a run, so that the start of the programs drops out.
/// Runs alternate; the middle one of all rounds counts.
#pragma once

#include <vector>

namespace tchat::benchmark {

struct ProgramSize {
  int segments;
  int intervals;      ///< NTST
  int dimension;      ///< n; above 4 with one segment
  int further;        ///< how many steps the long run makes more than the short one
  double wanted = 0;  ///< how many times AUTO's step is to take ours; 0: nothing is
};

/// With AUTO, or of this program alone.
void print_program_times(const std::vector<ProgramSize>& sizes, int rounds, bool with_auto);

}  // namespace tchat::benchmark
