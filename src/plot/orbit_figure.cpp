#include "plot/orbit_figure.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "files/simulation_files.hpp"
#include "model/parameter_vector.hpp"
#include "plot/event_surface.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

constexpr double orbit_width = 2.5;

/// Rectangle around all orbits, half as large again on each side; what the user's ranges may ask for is cut there.
StateWindow window_of(const std::vector<OrbitTrace>& orbits, int a, int b) {
  const StateRange x = range_along(orbits, a, 0.5), y = range_along(orbits, b, 0.5);
  return {x.low, x.high, y.low, y.high};
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
    const bool is_rotation = index == orbit.rotation_parameter && orbit.section_points.cols() > 0;
    const std::string name = is_rotation                            ? "rho"
                             : position < options.parameters.size() ? options.parameters[position]
                                                                    : fmt::format("PAR({})", index);
    text = joined(joined(text, plain_text(first ? ": " : ", ")),
                  joined(mathematical_name(name), joined(plain_text(" = "), number_text(value))));
    first = false;
  }
  if (orbit.kind == LineKind::unstable) text = joined(text, plain_text(first ? ": unstable" : ", unstable"));
  if (orbit.kind == LineKind::inadmissible)
    text = joined(text, plain_text(first ? ": inadmissible" : ", inadmissible"));
  return text;
}

Stroke orbit_stroke(const std::vector<OrbitTrace>& orbits, std::size_t k) {
  return line_stroke(orbits[k].kind, series_colour(k), orbit_width);
}

Marker jump_marker(std::size_t k, const PicturePoint& at, bool before) {
  return {at, series_symbol(k), before, 0.8, series_colour(k)};
}

StateRange range_along(const std::vector<OrbitTrace>& orbits, int state, double margin) {
  StateRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const OrbitTrace& orbit : orbits)
    for (const TraceSegment& segment : orbit.segments) {
      range.low = std::min(range.low, segment.states.row(state).minCoeff());
      range.high = std::max(range.high, segment.states.row(state).maxCoeff());
    }
  const double size = range.high > range.low ? range.high - range.low : 2.0 * std::max(1.0, std::abs(range.high));
  return {range.low - margin * size, range.high + margin * size};
}

Curve segment_curve(const TraceSegment& segment, const StatePlace& place, const Stroke& stroke) {
  Curve curve{{}, stroke};
  for (std::size_t k = 0; k < segment.times.size(); ++k)
    curve.points.push_back(place(segment.times[k], segment.states.col(static_cast<Eigen::Index>(k))));
  return curve;
}

void add_jump(Panel& panel, const OrbitTrace& orbit, std::size_t s, const StatePlace& place, Marker marker) {
  const double time = orbit.segments[s].times.back();
  const PicturePoint before = place(time, orbit.end_of(s)), after = place(time, orbit.start_after(s));
  panel.curves.push_back({{before, after}, jump_stroke(marker.colour), false});
  for (const bool filled : {false, true}) {
    marker.at = filled ? before : after;
    marker.filled = filled;
    panel.markers.push_back(marker);
  }
}

KeyEntry orbit_entry(const std::vector<OrbitTrace>& orbits, std::size_t k, const OrbitFigureOptions& options) {
  KeyEntry entry{orbit_name(orbits, k, options), orbit_stroke(orbits, k), std::nullopt};
  const bool is_bundle = orbits[k].segments_per_return > 0;  // whose lines are many
  for (std::size_t s = 0; s < orbits[k].segments.size() && !entry.marker && !is_bundle; ++s)
    if (orbits[k].jumps_after(s)) entry.marker = jump_marker(k, {}, true);
  return entry;
}

void explain_dashes(Figure& figure, const std::vector<OrbitTrace>& orbits) {
  std::set<LineKind> kinds;
  for (const OrbitTrace& orbit : orbits)
    if (orbit.kind != LineKind::stable) kinds.insert(orbit.kind);
  for (KeyEntry& entry : line_kind_entries(kinds, "#606060", orbit_width)) figure.key.push_back(std::move(entry));
}

KeyEntry surface_entry(const std::string& name, std::size_t number) {
  static constexpr std::array<const char*, 4> greys = {"#a0a0a0", "#d0c4b0", "#b8c8d8", "#808080"};
  return {plain_text(name), Stroke{Dash::solid, 4.0, greys[number % greys.size()]}, std::nullopt};
}

namespace {

/// The states along the axes, from 0; two of them in the plane.
std::vector<int> states_along(const std::vector<OrbitTrace>& orbits, const OrbitFigureOptions& options) {
  const int n = orbits.front().dimension();
  if (options.y.size() > 1)
    throw UserError("a phase portrait has one state along y; several of them are for --time, as in --time -y x1,x2");
  const int a = options.x.empty() ? 0 : find_state(options.x, n, options, "-x");
  const int b = options.y.empty() ? std::min(a == 1 ? 0 : 1, n - 1) : find_state(options.y.front(), n, options, "-y");
  if (options.z.empty()) return {a, b};
  return {a, b, find_state(options.z, n, options, "-z")};
}

StatePlace place_of(const std::vector<int>& states) {
  return [states](double, const Eigen::VectorXd& x) {
    return PicturePoint{x(states[0]), x(states[1]), states.size() > 2 ? x(states[2]) : 0.0};
  };
}

constexpr double bundle_width = 1.2;

/// Of one torus the colours are those of the angle, of several each has its own.
bool shows_phase(const std::vector<OrbitTrace>& orbits) {
  return orbits.size() == 1 && orbits.front().segments_per_return > 0;
}

/// The points where returns begin, as dots.
void add_section_points(Panel& panel, const OrbitTrace& torus, const std::string& colour, const StatePlace& place) {
  for (Eigen::Index i = 0; i < torus.section_points.cols(); ++i)
    panel.markers.push_back({place(0.0, torus.section_points.col(i)), Symbol::circle, true, 0.45, colour});
}

/// Returns of a torus as thin lines.
void add_torus(Panel& panel, const std::vector<OrbitTrace>& orbits, std::size_t k, const StatePlace& place) {
  const OrbitTrace& torus = orbits[k];
  const std::size_t count = torus.segments.size();
  for (std::size_t s = 0; s < count; ++s) {
    Stroke stroke = orbit_stroke(orbits, k);
    stroke.width = bundle_width;
    if (shows_phase(orbits))
      stroke.colour = colour_at(cyclic_palette(), static_cast<double>(s) / static_cast<double>(count));
    panel.curves.push_back(segment_curve(torus.segments[s], place, stroke));
    if (!torus.jumps_after(s)) continue;
    Stroke jump = jump_stroke(series_colour(k));
    jump.width *= 0.5;
    panel.curves.push_back({{place(0.0, torus.end_of(s)), place(0.0, torus.start_after(s))}, jump, false});
  }
  add_section_points(panel, torus, shows_phase(orbits) ? "#000000" : series_colour(k), place);
}

/// What the dots are, and the colours.
void explain_tori(Figure& figure, const std::vector<OrbitTrace>& orbits) {
  const auto torus = std::find_if(orbits.begin(), orbits.end(),
                                  [](const OrbitTrace& orbit) { return orbit.section_points.cols() > 0; });
  if (torus == orbits.end()) return;
  const Marker dot{{}, Symbol::circle, true, 0.45};
  const std::string points = orbits.size() > 1
                                 ? std::string("computed points on the section")
                                 : fmt::format("{} computed points on the section", torus->section_points.cols());
  figure.key.push_back({plain_text(points), std::nullopt, dot});
  if (!shows_phase(orbits)) return;
  figure.palette = cyclic_palette();
  figure.palette->label = mathematical_name("phi");
}

void add_orbit(Panel& panel, const std::vector<OrbitTrace>& orbits, std::size_t k, const StatePlace& place,
               const StateWindow& window) {
  const OrbitTrace& orbit = orbits[k];
  if (orbit.segments_per_return > 0) return add_torus(panel, orbits, k, place);
  for (std::size_t s = 0; s < orbit.segments.size(); ++s) {
    Curve curve = segment_curve(orbit.segments[s], place, orbit_stroke(orbits, k));
    if (!orbit.is_section) add_arrow(panel, curve, window);
    panel.curves.push_back(std::move(curve));
    if (orbit.jumps_after(s)) add_jump(panel, orbit, s, place, jump_marker(k, {}, true));
  }
  if (orbit.is_section) add_section_points(panel, orbit, series_colour(k), place);
}

/// The rectangle that a picture of curves on a section shows: the curves, and of each line of an event function the
/// point nearest to them, with a margin.
class SectionView {
 public:
  explicit SectionView(const std::vector<OrbitTrace>& orbits, int a, int b) {
    const StateWindow wide = window_of(orbits, a, b);
    const double half_x = 0.25 * (wide.high_x - wide.low_x), half_y = 0.25 * (wide.high_y - wide.low_y);
    low_ = {wide.low_x + half_x, wide.low_y + half_y};
    high_ = {wide.high_x - half_x, wide.high_y - half_y};
    size_ = {2.0 * half_x, 2.0 * half_y};
  }

  /// False where no point of the line is near.
  bool takes_in(const std::vector<std::vector<PicturePoint>>& pieces) {
    constexpr double near = 0.4;  // of the curves' size
    PicturePoint best;
    double least = near;
    bool found = false;
    for (const auto& piece : pieces)
      for (const PicturePoint& point : piece) {
        if (!(distance(point) < least)) continue;
        least = distance(point);
        best = point;
        found = true;
      }
    if (!found) return false;
    low_ = {std::min(low_.x, best.x), std::min(low_.y, best.y)};
    high_ = {std::max(high_.x, best.x), std::max(high_.y, best.y)};
    return true;
  }

  void set(Panel& panel) const {
    constexpr double margin = 0.06;
    panel.x.low = low_.x - margin * size_.x, panel.x.high = high_.x + margin * size_.x;
    panel.y.low = low_.y - margin * size_.y, panel.y.high = high_.y + margin * size_.y;
  }

 private:
  /// From the rectangle, in its sizes; negative inside, the more so the nearer to the middle.
  double distance(const PicturePoint& point) const {
    const double x = std::max(low_.x - point.x, point.x - high_.x) / size_.x;
    const double y = std::max(low_.y - point.y, point.y - high_.y) / size_.y;
    return std::max(x, y);
  }

  PicturePoint low_, high_, size_;
};

void add_lines_of_events(Figure& figure, Panel& panel, const EventSurfaces& surfaces, const std::vector<int>& states,
                         const StateWindow& window, const std::vector<OrbitTrace>& orbits) {
  const bool is_section = orbits.front().is_section;
  SectionView view(orbits, states[0], states[1]);
  std::size_t number = 0;
  for (auto& line : surfaces.in_plane(states[0], states[1], window)) {
    if (is_section && !view.takes_in(line.pieces)) continue;
    const KeyEntry entry = surface_entry(line.event.name, number++);
    for (auto& piece : line.pieces) panel.curves.push_back({std::move(piece), *entry.stroke, true});
    figure.key.push_back(entry);
  }
  if (is_section && number > 0) view.set(panel);
}

/// In space: where an event function depends on one of the states alone, the edges of its plane around the orbits.
void add_planes_of_events(Figure& figure, Panel& panel, const EventSurfaces& surfaces, const std::vector<int>& states,
                          const std::vector<OrbitTrace>& orbits) {
  std::size_t number = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t second = (axis + 1) % 3, third = (axis + 2) % 3;
    const StateRange one = range_along(orbits, states[second]), other = range_along(orbits, states[third]);
    const StateRange own = range_along(orbits, states[axis], 0.1);
    for (const EventSurfaces::Level& level : surfaces.of_state(states[axis], own.low, own.high)) {
      const KeyEntry entry = surface_entry(level.event.name, number++);
      for (const double value : level.values) {
        Curve edge;
        edge.stroke = *entry.stroke;
        edge.background = true;
        for (const auto& [a, b] : {std::pair(one.low, other.low),
                                   {one.high, other.low},
                                   {one.high, other.high},
                                   {one.low, other.high},
                                   {one.low, other.low}}) {
          std::array<double, 3> corner{};
          corner[axis] = value, corner[second] = a, corner[third] = b;
          edge.points.push_back({corner[0], corner[1], corner[2]});
        }
        panel.curves.push_back(std::move(edge));
      }
      figure.key.push_back(entry);
    }
  }
}

}  // namespace

Figure phase_portrait(const std::vector<OrbitTrace>& orbits, const OrbitFigureOptions& options) {
  check_dimensions(orbits);
  const std::vector<int> states = states_along(orbits, options);
  const StateWindow window = window_of(orbits, states[0], states[1]);
  Figure figure;
  Panel panel;
  const auto name = [&options, &states](std::size_t axis) {
    return mathematical_name(state_name(states[axis], options));
  };
  panel.x.label = name(0);
  panel.y.label = name(1);
  if (states.size() > 2) panel.z = AxisSettings{name(2), {}, {}, false};
  for (std::size_t k = 0; k < orbits.size(); ++k)
    if (is_in_key(orbits, options)) figure.key.push_back(orbit_entry(orbits, k, options));
  if (shows_phase(orbits) && !figure.key.empty()) figure.key.front().stroke->colour = colour_at(cyclic_palette(), 0.0);
  explain_tori(figure, orbits);
  if (panel.z && shows_phase(orbits)) {
    figure.palette.reset();
    figure.note = plain_text("coloured by the angle at which a return begins");
  }
  if (options.system != nullptr && options.surfaces) {
    const EventSurfaces surfaces(*options.system, orbits, options.events);
    if (panel.z)
      add_planes_of_events(figure, panel, surfaces, states, orbits);
    else
      add_lines_of_events(figure, panel, surfaces, states, window, orbits);
  }
  if (!options.legend.empty()) explain_dashes(figure, orbits);
  for (std::size_t k = 0; k < orbits.size(); ++k) add_orbit(panel, orbits, k, place_of(states), window);
  figure.panels.push_back(std::move(panel));
  return figure;
}

namespace {

/// One state of one orbit over a period.
void add_series(Panel& panel, const OrbitTrace& orbit, int state, const Stroke& stroke, const Marker& jump) {
  const StatePlace place = [state](double time, const Eigen::VectorXd& x) { return PicturePoint{time, x(state)}; };
  for (std::size_t s = 0; s < orbit.segments.size(); ++s) {
    panel.curves.push_back(segment_curve(orbit.segments[s], place, stroke));
    if (orbit.jumps_after(s, state)) add_jump(panel, orbit, s, place, jump);
  }
}

void add_levels(Figure& figure, Panel& panel, const EventSurfaces& surfaces, const std::vector<OrbitTrace>& orbits,
                int state, double duration) {
  const auto [low, high] = range_along(orbits, state, 0.5);
  for (const EventSurfaces::Level& level : surfaces.of_state(state, low, high)) {
    std::size_t number = 0;
    auto known = std::find_if(figure.key.begin(), figure.key.end(),
                              [&level](const KeyEntry& entry) { return entry.text.text == level.event.name; });
    if (known == figure.key.end()) {
      for (const KeyEntry& entry : figure.key) number += entry.stroke->colour == surface_entry("", 0).stroke->colour;
      figure.key.push_back(surface_entry(level.event.name, number));
      known = figure.key.end() - 1;
    }
    for (const double value : level.values)
      panel.curves.push_back({{{-duration, value}, {2.0 * duration, value}}, *known->stroke, true});
  }
}

}  // namespace

Figure time_series(const std::vector<OrbitTrace>& orbits, const OrbitFigureOptions& options) {
  const int n = orbits.front().dimension();
  std::vector<int> states;
  for (const std::string& name : options.y) states.push_back(find_state(name, n, options, "-y"));
  if (states.empty())
    for (int k = 0; k < std::min(n, 2); ++k) states.push_back(k);
  double duration = 0.0;
  for (const OrbitTrace& orbit : orbits) duration = std::max(duration, orbit.period());

  Figure figure;
  LabelText all_names;
  const bool one_panel = options.one_panel || states.size() == 1;
  figure.panels.resize(one_panel ? 1 : states.size());
  for (std::size_t k = 0; k < orbits.size(); ++k)
    if ((!one_panel || states.size() == 1) && is_in_key(orbits, options))
      figure.key.push_back(orbit_entry(orbits, k, options));
  for (std::size_t i = 0; i < states.size(); ++i) {
    Panel& panel = figure.panels[one_panel ? 0 : i];
    const LabelText name = mathematical_name(state_name(states[i], options));
    all_names = all_names.empty() ? name : joined(joined(all_names, plain_text(", ")), name);
    panel.y.label = one_panel ? all_names : name;
    panel.x.label = plain_text("time");
    if (options.system != nullptr && options.surfaces)
      add_levels(figure, panel, EventSurfaces(*options.system, orbits, options.events), orbits, states[i], duration);
    for (std::size_t k = 0; k < orbits.size(); ++k) {
      // Several states in one panel: a colour for each state of each orbit, a symbol for each orbit.
      const bool by_state = one_panel && states.size() > 1;
      Stroke stroke = orbit_stroke(orbits, k);
      Marker jump = jump_marker(k, {}, true);
      jump.size = 0.7;
      if (by_state) {
        jump.colour = series_colour(k * states.size() + i);
        stroke = line_stroke(orbits[k].kind, jump.colour, 2.5);
        const LabelText comma = plain_text(", ");
        const std::size_t index = i * orbits.size() + k;
        const LabelText own = index < options.legend.size() ? plain_text(options.legend[index]) : LabelText{};
        const LabelText chosen = orbits.size() > 1 ? joined(joined(name, comma), orbit_name(orbits, k, options)) : name;
        figure.key.push_back({own.empty() ? chosen : own, stroke, std::nullopt});
      }
      add_series(panel, orbits[k], states[i], stroke, jump);
    }
  }
  const bool states_alone = one_panel && states.size() > 1 && orbits.size() == 1;
  if (!options.legend.empty() || states_alone) explain_dashes(figure, orbits);
  return figure;
}

TrajectoryFile read_trajectory_file(const std::string& path) {
  const TrajectoryRows rows = read_trajectory_rows(path);
  TrajectoryFile file;
  file.trace.name = std::filesystem::path(path).stem().string();
  file.trace.is_closed = false;
  for (const auto& [name, value] : rows.parameters) {
    const std::optional<int> k = unnamed_parameter(name);
    if (k && *k > static_cast<int>(file.trace.parameters.size())) file.trace.parameters.resize(*k - 1, 0.0);
    file.trace.parameters.push_back(value);
  }
  file.states = rows.states;
  for (const RecordedRows& recorded : rows.segments) {
    TraceSegment segment;
    segment.times = recorded.times;
    segment.states = recorded.states;
    file.trace.segments.push_back(std::move(segment));
  }
  return file;
}

}  // namespace tchat
