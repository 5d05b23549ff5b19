/// Figures side by side on one sheet, the formats of picture files, and the thinning of large clouds of points.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "plot/figure.hpp"
#include "plot/layout.hpp"

namespace tchat {

// Several figures side by side in one picture: each is laid out by itself, in its part of the sheet; frames of figures
// in a row have one height, those in a column one left edge.

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

// The forms a picture can take: PNG, SVG and PDF files that gnuplot draws, a page (HTML) that a browser draws, or a
// window.

enum class PictureFormat { png, svg, pdf, html, window };

/// By the extension of the file's name, in any case. Throws UserError for other extensions and for none.
PictureFormat picture_format(const std::string& path);

/// The window terminal to use of those that gnuplot has, the most comfortable first; "" for none.
std::string window_terminal(const std::vector<std::string>& terminals);

/// How one unit of length is told to gnuplot: its terminals measure fonts and points differently.
struct TerminalUnits {
  double font = 1.0;        ///< font size to give for one pixel
  double point_size = 1.0;  ///< pointsize for a marker with a radius of one pixel
  double line_width = 1.0;  ///< linewidth for a line of width one in a picture 1200 pixels wide
};

/// For a picture `width` pixels wide with a font of that size in pixels.
TerminalUnits terminal_units(PictureFormat format, int width, double font);

/// The `set terminal` line. `window`: name of the window terminal.
std::string terminal_line(PictureFormat format, const std::string& window, int width, int height, double font);

// Large clouds without the dots that others hide.

/// Indices of the points of a cloud that are drawn. If the cloud has more than `few` points, only the first point in
/// each square of the paper with this side is drawn, and none outside the frame. Points that cannot be shown are left
/// out.
std::vector<std::size_t> thinned_indices(const std::vector<PicturePoint>& points, const PanelLayout& panel, double side,
                                         std::size_t few = 5000);

/// The same points themselves.
std::vector<PicturePoint> thinned_points(const std::vector<PicturePoint>& points, const PanelLayout& panel, double side,
                                         std::size_t few = 5000);

}  // namespace tchat
