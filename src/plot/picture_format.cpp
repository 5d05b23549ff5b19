#include "plot/picture_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

#include "base/user_error.hpp"

namespace tchat {

namespace {

constexpr double pixels_per_inch = 150.0;  // of a PDF: 1200 pixels become 8 inches
constexpr double points_per_inch = 72.0;

}  // namespace

PictureFormat picture_format(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".png") return PictureFormat::png;
  if (extension == ".svg") return PictureFormat::svg;
  if (extension == ".pdf") return PictureFormat::pdf;
  if (extension == ".html") return PictureFormat::html;
  throw UserError(fmt::format("-o {}: {}; pictures are .png, .svg, .pdf or .html files, as in -o branch.png", path,
                              extension.empty() ? "the name has no extension" : "no such form of picture"));
}

std::string window_terminal(const std::vector<std::string>& terminals) {
  for (const char* name : {"qt", "wxt", "x11", "aqua", "windows"})
    if (std::find(terminals.begin(), terminals.end(), name) != terminals.end()) return name;
  return "";
}

TerminalUnits terminal_units(PictureFormat format, int width, double font) {
  const double scale = width / 1200.0;
  switch (format) {
    case PictureFormat::svg:
      return {1.0, 1.0 / (0.375 * font), scale};
    case PictureFormat::pdf:
      return {0.75 * points_per_inch / pixels_per_inch, 1.0 / 6.5, 0.55 * scale};
    default:
      return {0.75, 1.0 / 3.1, scale};
  }
}

std::string terminal_line(PictureFormat format, const std::string& window, int width, int height, double font) {
  const double size = font * terminal_units(format, width, font).font;
  switch (format) {
    case PictureFormat::png:
      return fmt::format("set terminal pngcairo enhanced background '#ffffff' size {},{} font 'sans,{:.1f}'", width,
                         height, size);
    case PictureFormat::svg:
      return fmt::format("set terminal svg standalone enhanced background '#ffffff' size {},{} font 'sans,{:.1f}'",
                         width, height, size);
    case PictureFormat::pdf:
      return fmt::format("set terminal pdfcairo enhanced fontscale 1 size {:.3f}in,{:.3f}in font 'sans,{:.1f}'",
                         width / pixels_per_inch, height / pixels_per_inch, size);
    default:
      return fmt::format("set terminal {} enhanced persist size {},{} font 'sans,{:.1f}'", window, width, height, size);
  }
}

}  // namespace tchat
