/// Predictors of the next point of a branch: along the tangent, and of higher order by earlier points.
#pragma once

#include <memory>
#include <vector>

#include "orbit/orbit.hpp"

namespace tchat {

class DefiningSystem;
struct PathPoint;

// A predictor has no memory of its own: what it needs of earlier points is in the trail of the point that it starts
// from, so that trial steps leave no trace. A new one is a class with its own file and a line in make_predictor().

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

/// The predictor of all branches of solutions of `system`, which outlives it.
std::unique_ptr<Predictor> make_predictor(const DefiningSystem& system);

// A predictor of higher order, by the points that the branch has come from.
//
// Near a point A with unit tangent v the branch is the graph y(s) = A + s v + w(s) over its tangent, <v, w> = 0,
// w(0) = w'(0) = 0. Of an earlier point B with unit tangent t
//
//     s_B = <v, B - A>,    w(s_B) = B - A - s_B v,    w'(s_B) = t / <v, t> - v
//
// are known without error but that of the points, so that Hermite's interpolation through K of them predicts the point
// at s = ds with an error of order ds^(2K + 2), in the plane <v, y - A> = ds that Newton's method corrects in. In
// Newton's form each point adds a term to the prediction along the tangent. The terms are added while they fall; where
// the first one is no small change of the step, the branch bends too much, and nothing is added.

class HermitePredictor final : public Predictor {
 public:
  explicit HermitePredictor(const DefiningSystem& system) : system_(system) {}
  Prediction predict(const PathPoint& from, double ds, Orbit& x) const override;

 private:
  const DefiningSystem& system_;
};

}  // namespace tchat
