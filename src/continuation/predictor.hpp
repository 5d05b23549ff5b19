/// How the next point of a branch is predicted, before Newton's method corrects it.
///
/// A predictor has no memory of its own: what it needs of earlier points is in the trail of the point that it starts
/// from, so that trial steps leave no trace. A new one is a class with its own file and a line in make_predictor().
#pragma once

#include <memory>
#include <vector>

#include "orbit/orbit.hpp"

namespace tchat {

struct PathPoint;

struct Prediction {
  double change = 0.0;  ///< from the prediction along the tangent, measured as OrbitChange::larger()
  double error = 0.0;   ///< about how far it is from the branch; 0: it is that along the tangent
};

class Predictor {
 public:
  virtual ~Predictor() = default;

  /// `x` becomes a point of the plane <v, x - from> = ds near the branch, v the unit tangent of `from`. Where the
  /// result has error 0, `x` need not be set: the step is predicted along the tangent.
  virtual Prediction predict(const PathPoint& from, double ds, Orbit& x) const = 0;

  /// Newton's method has led a step from `from` to `to`, which the next prediction may start from: stores what it needs
  /// of `from` in to.trail.
  virtual void accepted(const PathPoint& from, const std::vector<int>& free_parameters, PathPoint& to) const;

  /// Newton's method has converged but moved the prediction by `correction`. True where the result is not to be
  /// trusted: it may be another branch's, and the step is made again along the tangent.
  virtual bool rejected(const Prediction& prediction, double correction) const;
};

/// The predictor of all branches. `free_parameters` are the PAR indices of the defining system.
std::unique_ptr<Predictor> make_predictor(const std::vector<int>& free_parameters);

}  // namespace tchat
