#include "plot/multiplier_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "constants/user_error.hpp"
#include "plot/picture_styles.hpp"

namespace tchat {

namespace {

constexpr double farthest = 2.5;

Curve unit_circle() {
  constexpr int corners = 360;
  Curve circle;
  for (int k = 0; k <= corners; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / corners;
    circle.points.push_back({std::cos(angle), std::sin(angle)});
  }
  circle.stroke = {Dash::solid, 2.0, "#707070"};
  return circle;
}

Curve axis_line(PicturePoint from, PicturePoint to) { return {{from, to}, {Dash::solid, 1.0, "#b0b0b0"}, true}; }

/// Dark at the beginning of the branch, lighter towards its end.
std::string shade(double part) {
  const int level = static_cast<int>(std::lround(150.0 * part));
  return fmt::format("#{0:02x}{0:02x}{0:02x}", level);
}

}  // namespace

Figure multiplier_figure(const std::vector<MultiplierSeries>& series, const MultiplierFigureOptions& options) {
  Figure figure;
  figure.width = 1000;
  figure.height = 1000;
  Panel panel;
  panel.equal_scales = true;
  panel.x.label = plain_text("real part");
  panel.y.label = plain_text("imaginary part");
  panel.curves.push_back(axis_line({-1e3, 0.0}, {1e3, 0.0}));
  panel.curves.push_back(axis_line({0.0, -1e3}, {0.0, 1e3}));
  panel.curves.push_back(unit_circle());
  std::size_t far = 0, shown = 0;
  for (std::size_t s = 0; s < series.size(); ++s) {
    const auto& points = series[s].points;
    for (std::size_t k = 0; k < points.size(); ++k) {
      bool labelled = false;
      for (const auto& mu : points[k].multipliers) {
        if (std::abs(mu) > farthest) {
          ++far;
          continue;
        }
        ++shown;
        Marker marker;
        marker.at = {mu.real(), mu.imag()};
        marker.size = options.labelled_points ? 0.9 : 0.6;
        marker.filled = points[k].point < 0;
        marker.colour =
            series.size() > 1 || options.labelled_points
                ? series_colour(s)
                : shade(static_cast<double>(k) / static_cast<double>(std::max<std::size_t>(points.size(), 2) - 1));
        const bool critical = std::abs(std::abs(mu) - 1.0) < 1e-4 && mu.imag() >= 0.0;
        if (critical && !labelled && is_labelled_by_default(points[k].type)) {
          marker.label = plain_text(points[k].type);
          labelled = true;
        }
        panel.markers.push_back(std::move(marker));
      }
    }
    if (series.size() > 1 || !options.legend.empty()) {
      Marker sample;
      sample.colour = series_colour(s);
      figure.key.push_back(
          {plain_text(s < options.legend.size() ? options.legend[s] : series[s].name), std::nullopt, sample});
    }
  }
  if (shown + far == 0)
    throw UserError("there are no multipliers in the d-file; a run with ISP = 1 or 2 computes them");
  if (far > 0)
    figure.note =
        plain_text(fmt::format("{} multiplier{} with modulus above {} not shown", far, far == 1 ? "" : "s", farthest));
  figure.panels.push_back(std::move(panel));
  return figure;
}

}  // namespace tchat
