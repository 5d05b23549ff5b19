/// Large clouds without the dots that others hide.
#pragma once

#include <cstddef>
#include <vector>

#include "plot/layout.hpp"

namespace tchat {

/// Indices of the points of a cloud that are drawn. If the cloud has more than `few` points, only the first point in
/// each square of the paper with this side is drawn, and none outside the frame. Points that cannot be shown are left
/// out.
std::vector<std::size_t> thinned_indices(const std::vector<PicturePoint>& points, const PanelLayout& panel, double side,
                                         std::size_t few = 5000);

/// The same points themselves.
std::vector<PicturePoint> thinned_points(const std::vector<PicturePoint>& points, const PanelLayout& panel, double side,
                                         std::size_t few = 5000);

}  // namespace tchat
