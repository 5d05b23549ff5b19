/// How many states and functions a problem has, for plugins that cannot say it themselves (Fortran): the constants file
/// knows.
#pragma once

#include <vector>

#include "settings/run_settings.hpp"

namespace tchat {

struct ProblemSizes {
  int dimension = 1;            ///< n
  int parameters = 0;           ///< largest PAR index of a free parameter that is no duration
  int segments = 1;             ///< of the orbit; starting values are asked for each
  int derivative_order = 0;     ///< of the derivatives coded by hand: 0, 1 or 2
  int boundary_conditions = 0;  ///< of boundary value problems: NBC
  int integral_conditions = 0;  ///< and NINT
  /// Indices that the orbit uses, ascending; the plugin has functions 1 .. the last of them.
  std::vector<int> fields, events, jumps;

  /// Adds the functions of an index vector.
  void add(const IndexVector& index);
  void add_jump(int k);
};

/// NDIM, ICP, GCIDIFF, NBC and NINT where the problem type reads them, and the indices in GCFIND, GCHIND, GCHGRZIND,
/// GCGIND; GRJUMP where the problem type reads it.
ProblemSizes problem_sizes(const RunSettings& settings);

}  // namespace tchat
