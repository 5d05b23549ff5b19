#include "plot/multiplier_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "files/orbit_trace.hpp"
#include "plot/figure.hpp"

namespace tchat {

namespace {

constexpr double farthest = 2.5;
constexpr double critical_width = level::visible;  // of what has a label on the circle

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
  const int level = static_cast<int>(std::lround(170.0 * part));
  return fmt::format("#{0:02x}{0:02x}{0:02x}", level);
}

KeyEntry dot(const std::string& text, const std::string& colour, bool filled) {
  return {plain_text(text), std::nullopt, Marker{{}, Symbol::circle, filled, 0.8, colour}};
}

/// What filled and open circles mean, and, where shades tell it, which way the branch goes.
void explain_dots(Figure& figure, bool stable, bool unstable, bool shaded) {
  const std::string colour = figure.key.empty() ? "#000000" : "#606060";
  if (stable) figure.key.push_back(dot("stable orbit", colour, true));
  if (unstable) figure.key.push_back(dot("unstable orbit", colour, false));
  if (!shaded) return;
  figure.key.push_back(dot("black: start of the branch", shade(0.0), stable));
  figure.key.push_back(dot("grey: its end", shade(1.0), stable));
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
  const bool shaded = series.size() == 1 && !options.labelled_points;
  bool stable = false, unstable = false;
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
        marker.filled = options.labelled_points ? !has_multiplier_outside(points[k]) : points[k].point < 0;
        marker.colour =
            shaded ? shade(static_cast<double>(k) / static_cast<double>(std::max<std::size_t>(points.size(), 2) - 1))
                   : series_colour(s);
        (marker.filled ? stable : unstable) = true;
        const bool critical = std::abs(std::abs(mu) - 1.0) < critical_width && mu.imag() >= 0.0;
        if (critical && !labelled && is_labelled_by_default(points[k].type)) {
          marker.label = plain_text(points[k].type);
          labelled = true;
        }
        panel.markers.push_back(std::move(marker));
      }
    }
    if (series.size() > 1 || !options.legend.empty())
      figure.key.push_back(dot(s < options.legend.size() ? options.legend[s] : series[s].name, series_colour(s), true));
  }
  if (shown + far == 0)
    throw UserError("there are no multipliers in the d-file; a run with ISP = 1 or 2 computes them");
  explain_dots(figure, stable && !options.labelled_points, unstable, shaded && series.front().points.size() > 1);
  if (far > 0)
    figure.note =
        plain_text(fmt::format("{} multiplier{} with modulus above {} not shown", far, far == 1 ? "" : "s", farthest));
  figure.panels.push_back(std::move(panel));
  return figure;
}

}  // namespace tchat
