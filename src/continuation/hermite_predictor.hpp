/// A predictor of higher order, by the points that the branch has come from.
///
/// Near a point A with unit tangent v the branch is the graph y(s) = A + s v + w(s) over its tangent, <v, w> = 0,
/// w(0) = w'(0) = 0. Of an earlier point B with unit tangent t
///
///     s_B = <v, B - A>,    w(s_B) = B - A - s_B v,    w'(s_B) = t / <v, t> - v
///
/// are known without error but that of the points, so that Hermite's interpolation through K of them predicts the point
/// at s = ds with an error of order ds^(2K + 2), in the plane <v, y - A> = ds that Newton's method corrects in. In
/// Newton's form each point adds a term to the prediction along the tangent. The terms are added while they fall; where
/// the first one is no small change of the step, the branch bends too much, and nothing is added.
#pragma once

#include <vector>

#include "continuation/predictor.hpp"

namespace tchat {

class HermitePredictor final : public Predictor {
 public:
  /// PAR indices of the free parameters of the defining system.
  explicit HermitePredictor(std::vector<int> free_parameters);
  Prediction predict(const PathPoint& from, double ds, Orbit& x) const override;

 private:
  std::vector<int> free_parameters_;
};

}  // namespace tchat
