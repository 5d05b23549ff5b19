/// A figure as a gnuplot script with its data inline: it needs no other file, can be edited and run again.
///
/// Equal figures give equal scripts, byte for byte. Texts are quoted (gnuplot_quoted), so that gnuplot substitutes
/// nothing.
#pragma once

#include <string>
#include <vector>

#include "plot/figure.hpp"
#include "plot/layout.hpp"
#include "plot/picture_sheet.hpp"

namespace tchat {

struct PictureTarget {
  PictureFormat format = PictureFormat::png;
  std::string path;    ///< of a file
  std::string window;  ///< terminal of a window
};

/// A script that prints the value of a formula of c1, c2, ... (`columns` of them) for every row, NaN where it has none.
std::string values_script(const std::string& formula, std::size_t columns,
                          const std::vector<std::vector<double>>& rows);

std::string gnuplot_script(const SheetLayout& sheet, const PictureTarget& target);

/// Of one figure that has the picture for itself.
std::string gnuplot_script(const Figure& figure, const FigureLayout& layout, const PictureTarget& target);

}  // namespace tchat
