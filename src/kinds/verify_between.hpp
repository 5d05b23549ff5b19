/// What `tchat verify` looks at between the labels of a run: its d-file has the multipliers of every point.
#pragma once

#include <string>
#include <vector>

#include "files/diagnostics_file.hpp"
#include "files/solution_file.hpp"

namespace tchat {

// Points without a label have no orbit in the q-file. Of each the d-file has the multipliers, and whether its orbit is
// one of the model. On a curve of folds or branch points each must have the multiplier +1, on one of period doublings
// -1, on one of torus bifurcations two of product 1: a branch that has gone on behind the end of such a curve has not.

struct PointsBetween {
  int points = 0;            ///< without a label
  int on_curves = 0;         ///< of them: of a curve, with multipliers that are known
  int inadmissible = 0;      ///< of them: orbits that the model does not have
  std::vector<int> strange;  ///< numbers of the points that have not the multiplier of their curve
  double largest = 0.0;      ///< distance from it, of all
  int where = 0;             ///< the point that has that
  std::vector<RecordedLoss> lost;

  bool are_right() const { return strange.empty(); }
};

/// `solutions` tell which curve a branch is. `has_trivial`: one multiplier is 1 along the flow, as no section ends the
/// orbit's only segment. `tolerance`: of multipliers; the root of it is allowed, as two of them meet
/// somewhere along most curves.
PointsBetween look_between_labels(const std::vector<DiagnosticPoint>& points,
                                  const std::vector<LabelledSolution>& solutions, bool has_trivial, double tolerance);

/// Lines for the screen; "" where there is nothing to say of these points.
std::string describe(const PointsBetween& between, double tolerance);

}  // namespace tchat
