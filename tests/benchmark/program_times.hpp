/// Table (j): whole programs. `tchat run -q` as users run it, on a plugin and its files, looks for all special points
/// that it knows; AUTO-07p's executable on the same orbit, mesh, tolerances and fixed step has its easiest work: no
/// special points (ILP = ISP = 0), derivatives by hand (JAC = 1). Both adapt the mesh every third step and write files.
///
/// The time of a further step is the difference of two lengths of a run, so that the start of the programs drops out.
/// Runs alternate; the middle one of all rounds counts.
///
/// Table (l): how that time grows with the number of segments. What else a machine does makes single runs longer, never
/// shorter: the least short run and the least long one count.
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

/// `intervals`: NTST.
void print_segment_times(const std::vector<int>& segments, int intervals, int rounds);

}  // namespace tchat::benchmark
