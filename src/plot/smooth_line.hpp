/// A smooth line through the computed points of a branch, for the eye only: it passes through every point.
#pragma once

#include <vector>

#include "plot/figure.hpp"

namespace tchat {

/// Points between consecutive points: element k holds what lies from points[k] to points[k + 1], both ends included.
/// Catmull-Rom splines with the distances (in the units `scale`) as parameters; a straight line where the branch has a
/// corner or a point that cannot be shown, and where points are close already.
std::vector<std::vector<PicturePoint>> smooth_intervals(const std::vector<PicturePoint>& points,
                                                        const PicturePoint& scale);

}  // namespace tchat
