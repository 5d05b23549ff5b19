/// Several figures side by side in one picture: each is laid out by itself, in its part of the sheet; frames of figures
/// in a row have one height, those in a column one left edge.
#pragma once

#include <cstddef>
#include <vector>

#include "plot/figure.hpp"
#include "plot/layout.hpp"

namespace tchat {

/// One figure keeps its own size; more share the sheet.
struct Sheet {
  std::vector<Figure> figures;  ///< at least one, in the order of reading
  std::size_t columns = 1;
  int width = 1200, height = 900;
  LabelText title;           ///< above all of them
  bool same_ranges = false;  ///< of all axes along x, and of all along y
};

struct PlacedFigure {
  Figure figure;
  FigureLayout layout;
  double left = 0.0, bottom = 0.0;  ///< of its part, in pixels of the sheet
};

struct SheetLayout {
  std::vector<PlacedFigure> figures;
  LabelText title;
  int width = 1200, height = 900;
  double font = 27.0;
};

/// Columns for so many figures: one row up to three, then as square as it can be.
std::size_t columns_for(std::size_t figures);

/// Throws UserError for axes that cannot show the data, and for a picture in space beside another one.
SheetLayout lay_out(const Sheet& sheet);

}  // namespace tchat
