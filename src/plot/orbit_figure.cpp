#include "plot/orbit_figure.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "constants/constant_value.hpp"
#include "constants/user_error.hpp"
#include "plot/event_surface.hpp"
#include "plot/picture_styles.hpp"

namespace tchat {

namespace {

constexpr double orbit_width = 2.5;
constexpr double jump_width = 1.3;

Marker impact_marker(const PicturePoint& at, bool before, const std::string& colour) {
  Marker marker;
  marker.at = at;
  marker.filled = before;
  marker.size = 0.8;
  marker.colour = colour;
  return marker;
}

/// Rectangle around all orbits, half as large again on each side, and what the user's ranges may ask for is cut there.
StateWindow window_of(const std::vector<OrbitTrace>& orbits, int a, int b) {
  const auto range = [&orbits](int i) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const OrbitTrace& orbit : orbits)
      for (const TraceSegment& segment : orbit.segments) {
        low = std::min(low, segment.states.row(i).minCoeff());
        high = std::max(high, segment.states.row(i).maxCoeff());
      }
    const double more = high > low ? 0.5 * (high - low) : std::max(1.0, std::abs(high));
    return std::pair(low - more, high + more);
  };
  const auto [low_x, high_x] = range(a);
  const auto [low_y, high_y] = range(b);
  return {low_x, high_x, low_y, high_y};
}

/// In the middle of a segment's way in the picture, unless that way is short.
void add_arrow(Panel& panel, const Curve& curve, const StateWindow& window) {
  constexpr double shortest = 0.08;  // parts of the window
  const double width = window.high_x - window.low_x, height = window.high_y - window.low_y;
  double total = 0.0;
  std::vector<double> length{0.0};
  for (std::size_t k = 1; k < curve.points.size(); ++k) {
    total += std::hypot((curve.points[k].x - curve.points[k - 1].x) / width,
                        (curve.points[k].y - curve.points[k - 1].y) / height);
    length.push_back(total);
  }
  if (!(total > shortest)) return;
  const auto middle = std::upper_bound(length.begin(), length.end(), 0.5 * total);
  const auto k = std::clamp<std::size_t>(static_cast<std::size_t>(middle - length.begin()), 1, length.size() - 1);
  panel.arrows.push_back({curve.points[k - 1], curve.points[k], curve.stroke.colour});
}

void check_dimensions(const std::vector<OrbitTrace>& orbits) {
  for (const OrbitTrace& orbit : orbits)
    if (orbit.dimension() != orbits.front().dimension())
      throw UserError(fmt::format("the orbits have {} and {} states; one picture shows orbits of one problem",
                                  orbits.front().dimension(), orbit.dimension()));
}

}  // namespace

std::string state_name(int state, const OrbitFigureOptions& options) {
  const auto index = static_cast<std::size_t>(state);
  return index < options.states.size() ? options.states[index] : fmt::format("U({})", state + 1);
}

int find_state(const std::string& wanted, int dimension, const OrbitFigureOptions& options, const char* option) {
  std::vector<std::string> names;
  for (int k = 0; k < dimension; ++k) {
    names.push_back(state_name(k, options));
    if (wanted == names.back() || wanted == fmt::format("U({})", k + 1) || wanted == std::to_string(k + 1)) return k;
  }
  throw UserError(fmt::format("no state {} for {}; the states are {} (or numbers 1..{})", in_quotes(wanted), option,
                              fmt::join(names, ", "), dimension));
}

bool is_in_key(const std::vector<OrbitTrace>& orbits, const OrbitFigureOptions& options) {
  return orbits.size() > 1 || orbits.front().is_closed || !options.legend.empty();
}

LabelText orbit_name(const std::vector<OrbitTrace>& orbits, std::size_t k, const OrbitFigureOptions& options) {
  if (k < options.legend.size()) return plain_text(options.legend[k]);
  const OrbitTrace& orbit = orbits[k];
  LabelText text = plain_text(orbit.name);
  bool first = true;
  for (const auto& [index, value] : orbit.free_parameters) {
    const auto position = static_cast<std::size_t>(index - 1);
    const std::string name =
        position < options.parameters.size() ? options.parameters[position] : fmt::format("PAR({})", index);
    text = joined(joined(text, plain_text(first ? ": " : ", ")),
                  joined(mathematical_name(name), joined(plain_text(" = "), number_text(value))));
    first = false;
  }
  return text;
}

KeyEntry surface_entry(const std::string& name, std::size_t number) {
  static constexpr std::array<Dash, 3> dashes = {Dash::solid, Dash::dash_dot, Dash::dotted};
  return {plain_text(name), Stroke{dashes[number % dashes.size()], 4.0, "#a0a0a0"}, std::nullopt};
}

Figure phase_portrait(const std::vector<OrbitTrace>& orbits, const OrbitFigureOptions& options) {
  check_dimensions(orbits);
  const int n = orbits.front().dimension();
  if (options.y.size() > 1)
    throw UserError("a phase portrait has one state along y; several of them are for --time, as in --time -y x1,x2");
  const int a = options.x.empty() ? 0 : find_state(options.x, n, options, "-x");
  const int b = options.y.empty() ? std::min(a == 1 ? 0 : 1, n - 1) : find_state(options.y.front(), n, options, "-y");
  const StateWindow window = window_of(orbits, a, b);
  Figure figure;
  Panel panel;
  panel.x.label = mathematical_name(state_name(a, options));
  panel.y.label = mathematical_name(state_name(b, options));
  if (options.system != nullptr && options.surfaces) {
    const EventSurfaces surfaces(*options.system, orbits, options.events);
    std::size_t number = 0;
    for (auto& line : surfaces.in_plane(a, b, window)) {
      const KeyEntry entry = surface_entry(line.name, number++);
      for (auto& piece : line.pieces) panel.curves.push_back({std::move(piece), *entry.stroke, true});
      figure.key.push_back(entry);
    }
  }
  std::vector<KeyEntry> entries;
  for (std::size_t k = 0; k < orbits.size(); ++k) {
    const OrbitTrace& orbit = orbits[k];
    const Stroke stroke = series_stroke(k, orbit_width);
    const auto point = [a, b](const Eigen::VectorXd& x) { return PicturePoint{x(a), x(b)}; };
    for (std::size_t s = 0; s < orbit.segments.size(); ++s) {
      Curve curve;
      curve.stroke = stroke;
      const Eigen::MatrixXd& states = orbit.segments[s].states;
      for (Eigen::Index i = 0; i < states.cols(); ++i) curve.points.push_back(point(states.col(i)));
      add_arrow(panel, curve, window);
      panel.curves.push_back(std::move(curve));
      if (!orbit.jumps_after(s)) continue;
      const PicturePoint before = point(orbit.end_of(s)), after = point(orbit.start_after(s));
      panel.curves.push_back({{before, after}, {Dash::dashed, jump_width, stroke.colour}, false});
      panel.markers.push_back(impact_marker(after, false, stroke.colour));
      panel.markers.push_back(impact_marker(before, true, stroke.colour));
    }
    if (is_in_key(orbits, options)) entries.push_back({orbit_name(orbits, k, options), stroke, std::nullopt});
  }
  figure.key.insert(figure.key.begin(), entries.begin(), entries.end());
  figure.panels.push_back(std::move(panel));
  return figure;
}

}  // namespace tchat
