#include "plot/layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace tchat {

namespace {

constexpr double font_for_1200_pixels = 27.0;
constexpr double least_font = 9.0;

/// Coordinates that set the ranges, and those of what does so only where nothing else is seen.
struct Values {
  std::vector<PicturePoint> points, minor;
};

void add_values(const Panel& panel, Values& values) {
  if (panel.field) values.points.insert(values.points.end(), {panel.field->low(), panel.field->high()});
  for (const Curve& curve : panel.curves) {
    if (curve.background) continue;
    auto& list = curve.minor ? values.minor : values.points;
    list.insert(list.end(), curve.points.begin(), curve.points.end());
  }
  for (const Cloud& cloud : panel.clouds)
    values.points.insert(values.points.end(), cloud.points.begin(), cloud.points.end());
  const bool has_curve = !values.points.empty();
  for (const Marker& marker : panel.markers)
    (marker.minor || !(has_curve || panel.curves.empty()) ? values.minor : values.points).push_back(marker.at);
}

bool is_inside(double value, const AxisSettings& range) {
  return can_be_shown(value) && !(range.low && value < *range.low) && !(range.high && value > *range.high);
}

/// One coordinate of what lies within the ranges chosen for this axis and the other one, so that a chosen --xrange
/// gives a fitting y-range, and --yrange 0: an upper end for what is above zero.
std::vector<double> visible(const Values& values, double PicturePoint::*coordinate, double PicturePoint::*across,
                            const AxisSettings& own, const AxisSettings& other) {
  const bool limited = other.low || other.high || own.low || own.high;
  std::vector<double> result;
  for (const auto* list : {&values.points, &values.minor}) {
    for (const PicturePoint& p : *list)
      if (!limited || (is_inside(p.*across, other) && is_inside(p.*coordinate, own))) result.push_back(p.*coordinate);
    if (!result.empty()) return result;
  }
  if (own.low || own.high) return visible(values, coordinate, across, {}, other);
  return limited ? visible(values, coordinate, across, {}, {}) : result;
}

/// A map fills its frame.
AxisSettings fitting(AxisSettings axis, const std::optional<ColourField>& field, double PicturePoint::*coordinate) {
  if (field && !axis.logarithmic) {
    if (!axis.low) axis.low = field->low().*coordinate;
    if (!axis.high) axis.high = field->high().*coordinate;
  }
  return axis;
}

/// In units of the font's size: the strip, and what is left of it.
constexpr double bar_width = 1.0, bar_gap = 0.9;

/// With its numbers and its text.
double bar_margin(const ColourBarPlace& place, const Palette& palette, double font) {
  return (bar_gap + bar_width + 0.8 + place.scale.widest_number + (palette.label.empty() ? 0.0 : 1.6)) * font;
}

/// Widens one axis so that a unit is as long on both.
void equalise(PanelLayout& panel) {
  const double unit_x = (panel.x.high - panel.x.low) / panel.frame.width();
  const double unit_y = (panel.y.high - panel.y.low) / panel.frame.height();
  AxisScale& scale = unit_x < unit_y ? panel.x : panel.y;
  const double factor = unit_x < unit_y ? unit_y / unit_x : unit_x / unit_y;
  const double middle = 0.5 * (scale.low + scale.high);
  AxisSettings wider;
  wider.low = middle + factor * (scale.low - middle);
  wider.high = middle + factor * (scale.high - middle);
  scale = choose_scale(wider, {}, 8);
}

Obstacles obstacles_of(const Panel& panel, const PanelLayout& layout, const std::optional<KeyPlace>& key, double font) {
  Obstacles obstacles;
  obstacles.frame = layout.frame.grown(-0.2 * font);
  for (const Curve& curve : panel.curves) {
    std::vector<PicturePoint> points;
    for (const PicturePoint& p : curve.points) points.push_back(layout.on_paper(p));
    obstacles.curves.push_back(std::move(points));
  }
  for (const Cloud& cloud : panel.clouds)
    for (const PicturePoint& p : cloud.points) obstacles.dots.push_back(layout.on_paper(p));
  for (const auto* markers : {&panel.markers, &layout.symbols})
    for (const Marker& marker : *markers) {
      const PicturePoint at = layout.on_paper(marker.at);
      obstacles.markers.push_back(Box{at.x, at.x, at.y, at.y}.grown(marker.size * marker_radius * font));
    }
  if (key && key->inside) obstacles.forbidden.push_back(key->box);
  return obstacles;
}

void place_marker_labels(const Panel& panel, PanelLayout& layout, const Obstacles& obstacles, double font) {
  std::vector<LabelRequest> requests;
  std::vector<std::size_t> owners;
  for (std::size_t k = 0; k < panel.markers.size(); ++k) {
    const Marker& marker = panel.markers[k];
    const PicturePoint at = layout.on_paper(marker.at);
    if (marker.label.empty() || !layout.frame.contains(at)) continue;
    const double size = label_font_ratio * font;
    const LabelRequest request{at, text_width(marker.label) * size, text_height(marker.label) * size,
                               (marker.size * marker_radius + 0.22) * font, marker.one_of_many};
    const bool crowded = std::any_of(owners.begin(), owners.end(), [&](const std::size_t& owner) {
      const PicturePoint other = requests[static_cast<std::size_t>(&owner - owners.data())].at;
      const bool equal = panel.markers[owner].label.text == marker.label.text;
      const bool many = panel.markers[owner].one_of_many && marker.one_of_many;
      const double reach = equal ? 1.2 : many ? 0.5 : 0.0;
      return std::abs(other.x - at.x) < reach * request.width && std::abs(other.y - at.y) < reach * request.height;
    });
    if (crowded) continue;  // points side by side: one label stands for all
    requests.push_back(request);
    owners.push_back(k);
  }
  const auto places = place_labels(requests, obstacles);
  layout.labels.assign(panel.markers.size(), std::nullopt);
  for (std::size_t k = 0; k < owners.size(); ++k) layout.labels[owners[k]] = places[k];
}

double font_of(const Figure& figure) {
  return std::max(least_font, font_for_1200_pixels * std::min(figure.width / 1200.0, figure.height / 700.0));
}

/// What stands above the panels, without the key.
double height_of_texts(const Figure& figure, double font) {
  return (0.8 + (figure.title.empty() ? 0.0 : 1.7) + (figure.note.empty() ? 0.0 : 1.3)) * font;
}

/// gnuplot projects the box and writes at its edges: only ranges, tics and what is above it are decided here.
FigureLayout lay_out_in_space(const Figure& figure) {
  constexpr int most_steps = 6;
  FigureLayout layout;
  layout.font = font_of(figure);
  const Panel& panel = figure.panels.front();
  Values values;
  add_values(panel, values);
  PanelLayout place;
  place.x = choose_scale(panel.x, visible(values, &PicturePoint::x, &PicturePoint::y, panel.x, {}), most_steps);
  place.y = choose_scale(panel.y, visible(values, &PicturePoint::y, &PicturePoint::x, panel.y, {}), most_steps);
  place.z = choose_scale(*panel.z, visible(values, &PicturePoint::z, &PicturePoint::x, *panel.z, {}), most_steps);
  place.frame = {0.0, static_cast<double>(figure.width), 0.0, figure.height - height_of_texts(figure, layout.font)};
  const KeyGrid rows(figure.key, layout.font, figure.width - layout.font, 0.35 * place.frame.height());
  if (!rows.empty()) {
    place.frame.top -= rows.height();
    layout.key = rows.place_above(place.frame, figure.width);
  }
  place.dash_scales.assign(panel.curves.size(), 1.0);
  place.marker_scales.assign(panel.markers.size(), 1.0);
  layout.panels.push_back(std::move(place));
  return layout;
}

}  // namespace

PicturePoint PanelLayout::on_paper(const PicturePoint& p) const {
  return {frame.left + x.fraction(p.x) * frame.width(), frame.bottom + y.fraction(p.y) * frame.height()};
}

PicturePoint PanelLayout::in_data(const PicturePoint& p) const {
  const auto value = [](const AxisScale& scale, double fraction) {
    return scale.logarithmic ? scale.low * std::pow(scale.high / scale.low, fraction)
                             : scale.low + fraction * (scale.high - scale.low);
  };
  return {value(x, (p.x - frame.left) / frame.width()), value(y, (p.y - frame.bottom) / frame.height())};
}

FigureLayout lay_out(const Figure& figure) {
  if (figure.panels.front().z) return lay_out_in_space(figure);
  FigureLayout layout;
  layout.font = font_of(figure);
  const double font = layout.font;
  const auto panels = static_cast<int>(figure.panels.size());

  Values shared;
  for (const Panel& panel : figure.panels) add_values(panel, shared);
  double widest = 0.0;
  double widest_below = 0.0;
  for (const Panel& panel : figure.panels) {
    Values own;
    add_values(panel, own);
    PanelLayout place;
    place.x = choose_scale(
        fitting(panel.x, panel.field, &PicturePoint::x),
        visible(shared, &PicturePoint::x, &PicturePoint::y, panel.x, panels == 1 ? panel.y : AxisSettings{}), 8);
    place.y = choose_scale(fitting(panel.y, panel.field, &PicturePoint::y),
                           visible(own, &PicturePoint::y, &PicturePoint::x, panel.y, panel.x), panels > 1 ? 6 : 8);
    widest = std::max(widest, place.y.widest_number);
    widest_below = std::max(widest_below, place.x.widest_number);
    layout.panels.push_back(place);
  }

  double right_margin = std::max(1.5, 0.5 * widest_below + 0.3) * font;  // the last number may stand at the edge
  if (figure.palette && figure.palette->has_bar) {
    layout.colour_bar = {{}, choose_scale({{}, figure.palette->low(), figure.palette->high()}, {}, 8)};
    right_margin += bar_margin(*layout.colour_bar, *figure.palette, font);
  }
  Box inner{std::max((widest + 3.0) * font, figure.least_left), figure.width - right_margin, 3.7 * font,
            figure.height - std::max(height_of_texts(figure, font), figure.least_above)};
  const KeyGrid list(figure.key, font);
  const KeyGrid rows(figure.key, font, figure.width - font, 0.35 * inner.height());
  const bool may_be_inside = panels == 1 && !figure.panels[0].field;
  const double top_of_key = figure.height - height_of_texts(figure, font);
  if (!may_be_inside && !rows.empty()) inner.top = std::min(inner.top, top_of_key - rows.height());

  const double gap = 0.7 * font;
  const double height = (inner.height() - gap * (panels - 1)) / panels;
  for (int k = 0; k < panels; ++k) {
    const double top = inner.top - k * (height + gap);
    PanelLayout& place = layout.panels[static_cast<std::size_t>(k)];
    place.frame = {inner.left, inner.right, top - height, top};
    if (figure.panels[static_cast<std::size_t>(k)].equal_scales) equalise(place);
  }
  if (!list.empty() && may_be_inside) {
    const Obstacles obstacles = obstacles_of(figure.panels[0], layout.panels[0], std::nullopt, font);
    layout.key = list.place_inside(obstacles);
    if (!layout.key) {
      PanelLayout& place = layout.panels[0];
      place.frame.top = std::min(place.frame.top, top_of_key - rows.height());
      if (figure.panels[0].equal_scales) equalise(place);
    }
  }
  if (!rows.empty() && !layout.key) layout.key = rows.place_above(layout.panels[0].frame, figure.width);
  if (layout.colour_bar) {
    const double left = inner.right + bar_gap * font;
    layout.colour_bar->box = {left, left + bar_width * font, inner.bottom, layout.panels[0].frame.top};
  }
  for (std::size_t k = 0; k < layout.panels.size(); ++k) {
    PanelLayout& place = layout.panels[k];
    ShortPieces pieces = find_short_pieces(figure.panels[k], place, font);
    place.dash_scales = std::move(pieces.dash_scales);
    place.marker_scales = std::move(pieces.marker_scales);
    place.symbols = symbols_along_curves(figure.panels[k], place, font);
    Obstacles obstacles = obstacles_of(figure.panels[k], place, layout.key, font);
    obstacles.markers.insert(obstacles.markers.end(), pieces.boxes.begin(), pieces.boxes.end());
    place_marker_labels(figure.panels[k], place, obstacles, font);
  }
  return layout;
}

namespace {

// In units of the font's size:
constexpr double sample_and_gap = key_sample_length + 0.5;
constexpr double column_gap = 1.2;
constexpr double smallest_font = 0.3;

/// A corner or the middle of an edge as parts of the free width and height.
struct Corner {
  double x, y;
  double cost;  // in pixels of covered curves: what is usual comes first
};
constexpr std::array<Corner, 8> corners = {{{1.0, 1.0, 0.0},
                                            {0.0, 1.0, 0.1},
                                            {1.0, 0.0, 0.2},
                                            {0.0, 0.0, 0.3},
                                            {0.5, 1.0, 0.4},
                                            {0.5, 0.0, 0.5},
                                            {1.0, 0.5, 0.6},
                                            {0.0, 0.5, 0.7}}};

}  // namespace

KeyGrid::KeyGrid(const std::vector<KeyEntry>& entries, double font) : font_(font) {
  for (const KeyEntry& entry : entries)
    widths_.push_back(text_width(entry.text) * label_font_ratio + sample_and_gap + 0.3);
  fill(1);
}

KeyGrid::KeyGrid(const std::vector<KeyEntry>& entries, double font, double width, double height)
    : KeyGrid(entries, font) {
  for (; !empty(); font_ *= 0.9) {
    for (std::size_t columns = widths_.size(); columns > 0; --columns) {
      fill(columns);
      if (this->width() <= width && (this->height() <= height || font_ < smallest_font * font)) return;
    }
    if (font_ < 0.01 * font) return;  // a width of nothing
  }
}

/// Entries fill the columns one after the other.
void KeyGrid::fill(std::size_t columns) {
  rows_ = (widths_.size() + columns - 1) / columns;
  columns_.clear();
  for (std::size_t k = 0; k < widths_.size(); ++k) {
    if (k % rows_ == 0) columns_.push_back(0.0);
    columns_.back() = std::max(columns_.back(), widths_[k]);
  }
}

double KeyGrid::width() const {
  const double gaps = columns_.empty() ? 0.0 : column_gap * static_cast<double>(columns_.size() - 1);
  return (std::accumulate(columns_.begin(), columns_.end(), 0.0) + gaps) * font_;
}

KeyPlace KeyGrid::placed(double left, double bottom, bool inside) const {
  KeyPlace place{{left, left + width(), bottom, bottom + height()}, inside, font_, {}};
  const double first = place.box.top - 0.2 * font_ - 0.5 * line_height();
  for (std::size_t k = 0; k < widths_.size(); ++k) {
    if (k > 0 && k % rows_ == 0) left += (columns_[k / rows_ - 1] + column_gap) * font_;
    place.entries.push_back({left, first - static_cast<double>(k % rows_) * line_height()});
  }
  return place;
}

std::optional<KeyPlace> KeyGrid::place_inside(const Obstacles& obstacles) const {
  Box area = obstacles.frame.grown(-0.4 * font_);
  area.left += 0.5 * font_, area.right -= 0.2 * font_;  // clear of the tics
  const double free_x = area.width() - width();
  const double free_y = area.height() - height();
  if (free_x < 0.35 * area.width() || free_y < 0.35 * area.height()) return std::nullopt;
  std::optional<KeyPlace> best;
  double least = 0.5 * font_;  // a little of a curve under the key's margin does no harm
  for (const Corner& corner : corners) {
    const double left = area.left + corner.x * free_x;
    const double bottom = area.bottom + corner.y * free_y;
    const Box box{left, left + width(), bottom, bottom + height()};
    double cost = corner.cost + obstacles.curve_length(box);
    for (const Box& marker : obstacles.markers)
      if (shared_area(box.grown(1.2 * font_), marker) > 0.0) cost += 2.0 * font_;
    for (const PicturePoint& dot : obstacles.dots)
      if (box.contains(dot)) cost += 0.1 * font_;
    if (cost < least) least = cost, best = placed(left, bottom, true);
  }
  return best;
}

KeyPlace KeyGrid::place_above(const Box& frame, double picture_width) const {
  const double left = std::min(frame.centre().x - 0.5 * width(), picture_width - 0.5 * font_ - width());
  return placed(std::max(left, 0.5 * font_), frame.top + 0.2 * font_, false);
}

namespace {

// In units of the font's size:
constexpr double symbol_distance = 9.0;
constexpr double shortest_line = 3.0;
constexpr double clear_of_markers = 1.3;
constexpr double clear_of_frame = 0.6;

double distance(const PicturePoint& a, const PicturePoint& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// A line on the paper, measured where it is seen.
class VisibleLine {
 public:
  VisibleLine(const Curve& curve, const PanelLayout& layout, const Box& frame) {
    for (const PicturePoint& point : curve.points) {
      const PicturePoint at = layout.on_paper(point);
      if (!points_.empty()) {
        const bool seen =
            is_finite(at) && is_finite(points_.back()) && frame.contains(at) && frame.contains(points_.back());
        ends_.push_back(length() + (seen ? distance(points_.back(), at) : 0.0));
      }
      points_.push_back(at);
    }
  }

  double length() const { return ends_.empty() ? 0.0 : ends_.back(); }

  /// The point at this length from the beginning, between 0 and length().
  PicturePoint at(double wanted) const {
    const auto k = static_cast<std::size_t>(std::lower_bound(ends_.begin(), ends_.end(), wanted) - ends_.begin());
    const double begin = k == 0 ? 0.0 : ends_[k - 1];
    const double part = ends_[k] > begin ? (wanted - begin) / (ends_[k] - begin) : 0.0;
    const PicturePoint a = points_[k], b = points_[k + 1];
    return {a.x + part * (b.x - a.x), a.y + part * (b.y - a.y)};
  }

 private:
  std::vector<PicturePoint> points_;
  std::vector<double> ends_;  // length up to the end of each interval
};

/// The place nearest to the wanted length that is clear of these points.
std::optional<PicturePoint> clear_place(const VisibleLine& line, double wanted, const std::vector<PicturePoint>& taken,
                                        double font) {
  for (const double shift : {0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0}) {
    const double length = wanted + shift * font;
    if (length <= 0.0 || length >= line.length()) continue;
    const PicturePoint place = line.at(length);
    const bool is_clear = std::all_of(taken.begin(), taken.end(), [&](const PicturePoint& other) {
      return distance(place, other) > clear_of_markers * font;
    });
    if (is_clear) return place;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Marker> symbols_along_curves(const Panel& panel, const PanelLayout& layout, double font) {
  std::vector<PicturePoint> taken;
  for (const Marker& marker : panel.markers) taken.push_back(layout.on_paper(marker.at));
  std::vector<Marker> symbols;
  for (const Curve& curve : panel.curves) {
    if (!curve.symbol) continue;
    const VisibleLine line(curve, layout, layout.frame.grown(-clear_of_frame * font));
    if (!(line.length() > shortest_line * font)) continue;
    const int count = std::max(1, static_cast<int>(std::lround(line.length() / (symbol_distance * font))));
    for (int i = 0; i < count; ++i) {
      const auto place = clear_place(line, (i + 0.5) * line.length() / count, taken, font);
      if (!place) continue;
      taken.push_back(*place);
      symbols.push_back(*curve.symbol);
      symbols.back().at = layout.in_data(*place);
    }
  }
  return symbols;
}

namespace {

// In units of the font's size:
constexpr double few_dashes = 1.6;    // a piece of this length shows four dashes
constexpr double label_length = 3.0;  // a label could hide it
constexpr double marker_length = 1.4;
constexpr double smallest_dashes = 0.4;
constexpr double smaller_marker = 0.7;

double length_on_paper(const Curve& curve, const PanelLayout& layout) {
  double length = 0.0;
  for (std::size_t k = 1; k < curve.points.size(); ++k) {
    const PicturePoint a = layout.on_paper(curve.points[k - 1]), b = layout.on_paper(curve.points[k]);
    if (is_finite(a) && is_finite(b)) length += std::hypot(b.x - a.x, b.y - a.y);
  }
  return length;
}

/// Small boxes along the curve.
void add_boxes(const Curve& curve, const PanelLayout& layout, double font, std::vector<Box>& boxes) {
  constexpr double size = 0.4;
  for (std::size_t k = 1; k < curve.points.size(); ++k) {
    const PicturePoint a = layout.on_paper(curve.points[k - 1]), b = layout.on_paper(curve.points[k]);
    if (!is_finite(a) || !is_finite(b)) continue;
    const int parts = 1 + static_cast<int>(std::hypot(b.x - a.x, b.y - a.y) / (size * font));
    for (int i = 0; i < parts; ++i) {
      const double from = static_cast<double>(i) / parts, to = static_cast<double>(i + 1) / parts;
      const auto [left, right] = std::minmax({a.x + from * (b.x - a.x), a.x + to * (b.x - a.x)});
      const auto [bottom, top] = std::minmax({a.y + from * (b.y - a.y), a.y + to * (b.y - a.y)});
      boxes.push_back(Box{left, right, bottom, top}.grown(1.0));
    }
  }
}

bool is_at_end_of(const Curve& curve, const PicturePoint& at) {
  const auto same = [&at](const PicturePoint& end) { return end.x == at.x && end.y == at.y; };
  return same(curve.points.front()) || same(curve.points.back());
}

}  // namespace

ShortPieces find_short_pieces(const Panel& panel, const PanelLayout& layout, double font) {
  ShortPieces result{std::vector<double>(panel.curves.size(), 1.0), std::vector<double>(panel.markers.size(), 1.0), {}};
  for (std::size_t c = 0; c < panel.curves.size(); ++c) {
    const Curve& curve = panel.curves[c];
    if (curve.stroke.dash == Dash::solid || curve.points.size() < 2) continue;
    const double length = length_on_paper(curve, layout) / font;
    result.dash_scales[c] = std::clamp(length / few_dashes, smallest_dashes, 1.0);
    if (length < label_length) add_boxes(curve, layout, font, result.boxes);
    if (length > marker_length) continue;
    for (std::size_t m = 0; m < panel.markers.size(); ++m)
      if (is_at_end_of(curve, panel.markers[m].at)) result.marker_scales[m] = smaller_marker;
  }
  return result;
}

}  // namespace tchat
