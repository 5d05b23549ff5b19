/// Newton's method and Newton-chord iteration for a point of a branch, and their results.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "base/levels.hpp"
#include "linear/array_kernel.hpp"
#include "orbit/bordered_problem.hpp"

namespace tchat {

enum class NewtonStatus { converged, too_many_iterations, diverging, not_finite, singular, condition_lost };

/// One line of the Newton history.
struct NewtonIteration {
  int number = 0;
  double parameter = 0.0;         ///< the first free problem parameter after the correction
  double parameter_change = 0.0;  ///< largest |dp| / (s + |p|)
  double state_change = 0.0;      ///< max |du| / (1 + max |u|)
  double residual = 0.0;          ///< largest residual before the correction
  double larger() const { return std::max(parameter_change, state_change); }
};

struct NewtonResult {
  NewtonStatus status = NewtonStatus::too_many_iterations;
  int iterations = 0;
  double residual = 0.0;  ///< largest, at the last evaluation
  /// How far x has moved, in the measures of the convergence test, since the factors were computed.
  double change_since_factorization = 0.0;
  bool from_tangent = false;  ///< it began on the tangent of the last point
  bool converged() const { return status == NewtonStatus::converged; }
};

std::string describe(NewtonStatus status);

// Newton-chord iteration for a point of a branch: F(x) = 0, G(x) = 0 if there is a condition, row (x - base) = target
// (5.50-5.55).
//
// The first `full_iterations` (NWTN) iterations use a new Jacobian each, later ones the last one (chord), up to
// `max_iterations` (ITNW). With a condition every iteration is a full one. Converged when, for the correction just
// applied,
//     |dp| / (s + |p|) <= tolerance_parameters  for durations and free parameters (EPSL), and
//     max |du| / (1 + max |u|) < tolerance_states                                (EPSU),
// s the period or the size that the parameter is known to have (HybridSystem::parameter_size), u states in units of
// their own sizes.
// Given up at once when the larger of the two exceeds 20 times its value at the first iteration. Near a branch point
// the corrections are rounding, magnified by a nearly singular matrix, and do not get smaller: there a residual at
// rounding level is accepted, and such a correction not applied.

struct NewtonSettings {
  int max_iterations = 8;
  int full_iterations = 3;
  double tolerance_parameters = level::tolerance;
  double tolerance_states = level::tolerance;
  int threads = 1;  ///< that may share the linear algebra of a Newton matrix; results do not depend on it
};

/// Largest relative change of an orbit, as Newton's method measures corrections.
struct OrbitChange {
  double parameters = 0.0;  ///< |dp| / (s + |p|) of durations and free parameters
  double states = 0.0;      ///< max |du| / (1 + max |u|); NaN when they are not finite
  double larger() const { return parameters > states ? parameters : states; }
};
/// The change of x by dx. `range` is that of dx.states, `largest` is max |u| of x.
OrbitChange change_by(const DefiningSystem& system, const OrbitVector& dx, const Orbit& x, const ArrayRange& range,
                      double largest);
double largest_state(const Orbit& x);

/// Is a residual of this size zero but for rounding?
bool is_rounding(double residual, const Orbit& x);

class NewtonChord {
 public:
  /// Allocates all work space.
  NewtonChord(BorderedProblem& problem, const NewtonSettings& settings);

  /// Corrects x in place, so that the value of the dual vector `row` on it changes by `change_along_row`.
  NewtonResult correct(Orbit& x, const OrbitVector& row, double change_along_row);

  const std::vector<NewtonIteration>& history() const { return history_; }
  const OrbitResidual& residual() const { return residual_; }
  OrbitResidual& residual() { return residual_; }
  /// Space for what BorderedProblem::linearize() finds.
  OrbitResidual& linearized() { return linearized_; }

 private:
  OrbitChange apply(Orbit& x) const;

  BorderedProblem& problem_;
  NewtonSettings settings_;
  OrbitVector dx_;
  OrbitResidual residual_;    // of chord iterations
  OrbitResidual linearized_;  // of the others
  std::vector<NewtonIteration> history_;
};

}  // namespace tchat
