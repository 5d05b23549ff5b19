#include "plot/picture_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <unordered_set>

#include "base/messages.hpp"

namespace tchat {

namespace {

constexpr double title_band = 2.2;  // in units of the font's size

/// The union of the ranges of all panels, wherever the user has not chosen an end.
void share_ranges(std::vector<PlacedFigure>& placed) {
  const auto share = [&placed](AxisSettings Panel::*axis, AxisScale PanelLayout::*scale) {
    std::optional<double> low, high;
    for (const PlacedFigure& one : placed)
      for (const PanelLayout& panel : one.layout.panels) {
        low = std::min(low.value_or((panel.*scale).low), (panel.*scale).low);
        high = std::max(high.value_or((panel.*scale).high), (panel.*scale).high);
      }
    for (PlacedFigure& one : placed)
      for (Panel& panel : one.figure.panels) {
        if (!(panel.*axis).low) (panel.*axis).low = low;
        if (!(panel.*axis).high) (panel.*axis).high = high;
      }
  };
  share(&Panel::x, &PanelLayout::x);
  share(&Panel::y, &PanelLayout::y);
}

void lay_out_each(std::vector<PlacedFigure>& placed) {
  for (PlacedFigure& one : placed) one.layout = lay_out(one.figure);
}

/// The widest margins of a row, and of a column, for all in it.
void align_frames(std::vector<PlacedFigure>& placed, std::size_t columns) {
  for (std::size_t k = 0; k < placed.size(); ++k)
    for (std::size_t other = 0; other < placed.size(); ++other) {
      const Box& frame = placed[other].layout.panels.front().frame;
      Figure& figure = placed[k].figure;
      if (other / columns == k / columns) figure.least_above = std::max(figure.least_above, figure.height - frame.top);
      if (other % columns == k % columns) figure.least_left = std::max(figure.least_left, frame.left);
    }
}

}  // namespace

std::size_t columns_for(std::size_t figures) {
  if (figures <= 3) return std::max<std::size_t>(figures, 1);
  return static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(figures))));
}

SheetLayout lay_out(const Sheet& sheet) {
  SheetLayout result;
  if (sheet.figures.size() == 1) {
    const Figure& figure = sheet.figures.front();
    result.figures.push_back({figure, lay_out(figure), 0.0, 0.0});
    result.width = figure.width;
    result.height = figure.height;
    result.font = result.figures.front().layout.font;
    return result;
  }
  const std::size_t rows = (sheet.figures.size() + sheet.columns - 1) / sheet.columns;
  result.title = sheet.title;
  result.width = sheet.width;
  result.height = sheet.height;
  const double width = sheet.width / static_cast<double>(sheet.columns);
  result.font = 27.0 * std::min(width / 1200.0, sheet.height / static_cast<double>(rows) / 700.0);
  const double above = sheet.title.empty() ? 0.0 : title_band * result.font;
  const double height = (sheet.height - above) / static_cast<double>(rows);
  for (std::size_t k = 0; k < sheet.figures.size(); ++k) {
    PlacedFigure one;
    one.figure = sheet.figures[k];
    if (one.figure.panels.front().z)
      throw UserError("a picture in space (-z of orbits) has no other panel beside it: leave --panel out");
    one.figure.width = static_cast<int>(width);
    one.figure.height = static_cast<int>(height);
    one.left = static_cast<double>(k % sheet.columns) * width;
    const std::size_t rows_down = k / sheet.columns + 1;
    one.bottom = sheet.height - above - static_cast<double>(rows_down) * height;
    result.figures.push_back(std::move(one));
  }
  lay_out_each(result.figures);
  if (sheet.same_ranges) {
    share_ranges(result.figures);
    lay_out_each(result.figures);
  }
  align_frames(result.figures, sheet.columns);
  lay_out_each(result.figures);
  result.font = result.figures.front().layout.font;
  return result;
}

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

std::vector<std::size_t> thinned_indices(const std::vector<PicturePoint>& points, const PanelLayout& panel, double side,
                                         std::size_t few) {
  std::vector<std::size_t> kept;
  std::unordered_set<std::uint64_t> taken;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const PicturePoint& point = points[k];
    if (!std::isfinite(point.x) || !std::isfinite(point.y)) continue;
    if (points.size() > few) {
      const PicturePoint at = panel.on_paper(point);
      if (!std::isfinite(at.x) || !std::isfinite(at.y) || !panel.frame.grown(side).contains(at)) continue;
      const auto column = static_cast<std::uint64_t>((at.x + side) / side);
      const auto row = static_cast<std::uint64_t>((at.y + side) / side);
      if (!taken.insert((column << 32U) | row).second) continue;
    }
    kept.push_back(k);
  }
  return kept;
}

std::vector<PicturePoint> thinned_points(const std::vector<PicturePoint>& points, const PanelLayout& panel, double side,
                                         std::size_t few) {
  std::vector<PicturePoint> kept;
  for (const std::size_t k : thinned_indices(points, panel, side, few)) kept.push_back(points[k]);
  return kept;
}

}  // namespace tchat
