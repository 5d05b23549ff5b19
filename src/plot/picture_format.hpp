/// The forms a picture can take: PNG, SVG and PDF files that gnuplot draws, a page (HTML) that a browser draws, or a
/// window.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tchat {

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

}  // namespace tchat
