/// A figure with its layout as JSON, for the script of a page, which draws it in a window of any size.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "plot/picture_sheet.hpp"

namespace tchat {

/// Texts, key, palette and panels. `branches` are the places of the figure's files in the page's list of
/// branches. Throws UserError for a figure in space.
std::string figure_json(const PlacedFigure& placed, const std::vector<std::size_t>& branches);

}  // namespace tchat
