/// The curves h(x, y) = 0 in a rectangle, as polylines.
#pragma once

#include <functional>
#include <vector>

#include "plot/figure.hpp"

namespace tchat {

/// Marching squares on `cells` x `cells` cells, with zeros on their edges by linear interpolation; straight lines come
/// out with their two ends only. Where h is not finite there is no curve.
std::vector<std::vector<PicturePoint>> zero_contour(const std::function<double(double, double)>& h, PicturePoint low,
                                                    PicturePoint high, int cells);

}  // namespace tchat
