#include "plot/picture_sheet.hpp"

#include <algorithm>
#include <cmath>

#include "base/user_error.hpp"

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

}  // namespace tchat
