/// Large clouds without the dots that others hide.
#pragma once

#include <cstddef>
#include <vector>

#include "plot/layout.hpp"

namespace tchat {

/// Which points of a cloud are drawn. Of a cloud with more than `few` points one in each square of the paper with that
/// side, the first, in their order; and none outside the frame. A small cloud is left as it is, but for points that
/// cannot be shown.
std::vector<std::size_t> thinned_indices(const std::vector<PicturePoint>& points, const PanelLayout& panel, double side,
                                         std::size_t few = 5000);

/// The same points themselves.
std::vector<PicturePoint> thinned_points(const std::vector<PicturePoint>& points, const PanelLayout& panel, double side,
                                         std::size_t few = 5000);

}  // namespace tchat
