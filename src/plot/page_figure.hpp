/// A figure with its layout as JSON, for the script of a page, which draws it in a window of any size.
#pragma once

#include <cstddef>
#include <string>

#include "plot/picture_sheet.hpp"

namespace tchat {

/// Texts, key, palette and panels. `first_branch` is the place of the figure's first file in the page's list of
/// branches. Throws UserError for a figure in space.
std::string figure_json(const PlacedFigure& placed, std::size_t first_branch);

}  // namespace tchat
