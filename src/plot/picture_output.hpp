/// A sheet of figures to where it is wanted: a file, a window, a script.
#pragma once

#include <string>

#include "plot/page.hpp"
#include "plot/picture_sheet.hpp"

namespace tchat {

struct PictureWish {
  std::string output;  ///< FILE.png, .svg, .pdf, .html; empty: a window, or NAME.png without a display
  std::string script;  ///< where the script is kept; empty: nowhere
  std::string name;    ///< NAME
  PageContents page;   ///< what a page shows besides the sheet
};

/// Draws the sheet; returns what the user is told ("" when it is in the file asked for). A file appears complete or
/// not at all, and without dates: equal sheets give equal files. A page takes no script. With a script and without an
/// output, and no display, only the script is written. Throws UserError (no gnuplot, a folder that cannot be written),
/// ComputationError.
std::string output_picture(const Sheet& sheet, const PictureWish& wish);

}  // namespace tchat
