/// A figure with its layout as JSON, for the script of a page, which draws it in a window of any size.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "plot/picture_sheet.hpp"

namespace tchat {

/// Places of the figure's files in the page's lists of branches and sweeps.
struct FilePlaces {
  std::vector<std::size_t> branches, sweeps;
};

/// Texts, key, palette and panels. Throws UserError for a figure in space.
std::string figure_json(const PlacedFigure& placed, const FilePlaces& places);

}  // namespace tchat
