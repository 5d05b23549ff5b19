#include "plot/branch_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "files/auto_format.hpp"
#include "files/solution_file.hpp"
#include "plot/branch_quantity.hpp"
#include "settings/constants_file.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

constexpr const char* neutral = "#000000";
constexpr double line_width = 3.0;

/// Letters that all points of a two-parameter curve share: from the header, or from a type.
int curve_type_of(const PointSection& section) {
  if (section.curve_type != 0) return section.curve_type;
  for (const PointRow& row : section.rows)
    if (const int curve = curve_type(row.type); curve > 0) return curve;
  return 0;
}

CurveKind kind_of(const PointSection& section) {
  return curve_kind(curve_name(section.problem_type, curve_type_of(section)),
                    keeps_contact(section.problem_type) || family_of(section.problem_type).is_drawn_as_contact());
}

/// The curves of one kind in one file share a line.
struct FileCurve {
  std::string path;
  CurveKind kind;

  bool operator==(const FileCurve& other) const { return path == other.path && kind.name == other.kind.name; }
};

template <class T>
std::size_t position(const std::vector<T>& list, const T& wanted) {
  return static_cast<std::size_t>(std::distance(list.begin(), std::find(list.begin(), list.end(), wanted)));
}

template <class T>
void add_once(std::vector<T>& list, T entry) {
  if (position(list, entry) == list.size()) list.push_back(std::move(entry));
}

class BranchFigureBuilder {
 public:
  BranchFigureBuilder(const std::vector<BranchFile>& files, const BranchFigureOptions& options,
                      std::vector<std::string>* warnings)
      : files_(files), options_(options), warnings_(warnings) {
    if (!files.empty()) axes_ = default_columns(files);
    if (!options.x.empty()) axes_.x = options.x;
    if (!options.y.empty()) axes_.y = options.y;
    for (const BranchFile& file : files)
      for (const PointSection& section : file.sections) {
        if (section.is_two_parameter_curve())
          add_once(curves_, curve_in(file, section));
        else
          add_once(plain_files_, file.path);
      }
    std::vector<CurveKind> kinds;
    for (const FileCurve& curve : curves_) kinds.push_back(curve.kind);
    curve_kinds_ = with_own_colours(kinds);
  }

  Figure build() {
    std::vector<Piece> pieces;
    for (std::size_t f = 0; f < files_.size(); ++f) read_file(f, pieces);
    const PicturePoint scale = size_of(pieces);
    for (const Piece& piece : pieces) add_piece(piece, scale);
    add_underlay();
    add_clouds();
    add_key();
    panel_.x.label = x_label_;
    panel_.y.label = y_label_;
    Figure figure;
    figure.panels.push_back(std::move(panel_));
    figure.key = std::move(key_);
    figure.palette = options_.underlay.palette;
    return figure;
  }

 private:
  /// A line of the picture: points of a section that lie on one branch.
  struct Piece {
    std::size_t file, section;
    std::vector<std::size_t> rows;
    std::vector<PicturePoint> points;  // of each row
  };

  void read_file(std::size_t f, std::vector<Piece>& pieces) {
    const BranchFile& file = files_[f];
    for (std::size_t s = 0; s < file.sections.size(); ++s) {
      const BranchQuantity x = read_quantity(file, s, axes_.x, "-x");
      const BranchQuantity y = read_quantity(file, s, axes_.y, "-y");
      if (x_label_.empty()) x_label_ = x.label, y_label_ = y.label;
      if (x.arms.size() > 1 && y.arms.size() > 1 && x.arms.size() != y.arms.size())
        throw UserError(fmt::format("{}: {} has {} values in a period and {} has {}; the axes take states at one event",
                                    file.path, x.orbits_of, x.arms.size(), y.orbits_of, y.arms.size()));
      tell_missing_orbits(file, s, x, y);
      for (std::size_t arm = 0; arm < std::max(x.arms.size(), y.arms.size()); ++arm)
        for (const BranchPiece& piece : file.pieces)
          if (piece.section == s) add_unbroken(read_piece(f, piece, x, y, arm), pieces);
    }
  }

  /// In parts, where so much of the section is not known between two points that a line would be invented.
  void add_unbroken(const Piece& piece, std::vector<Piece>& pieces) const {
    constexpr std::size_t longest_gap = 8;  // as a divisor of the section
    const std::size_t gap = std::max<std::size_t>(section_of(piece).rows.size() / longest_gap, 2);
    Piece part{piece.file, piece.section, {}, {}};
    for (std::size_t k = 0; k < piece.rows.size(); ++k) {
      if (!part.rows.empty() && piece.rows[k] - part.rows.back() > gap)
        pieces.push_back(std::exchange(part, Piece{piece.file, piece.section, {}, {}}));
      part.rows.push_back(piece.rows[k]);
      part.points.push_back(piece.points[k]);
    }
    pieces.push_back(std::move(part));
  }

  Piece read_piece(std::size_t f, const BranchPiece& piece, const BranchQuantity& x, const BranchQuantity& y,
                   std::size_t arm) const {
    const auto& across = x.arms[arm % x.arms.size()];
    const auto& up = y.arms[arm % y.arms.size()];
    Piece result{f, piece.section, {}, {}};
    for (std::size_t k = piece.begin; k < piece.end; ++k) {
      if (!x.known[k] || !y.known[k]) continue;
      PicturePoint point{across[k], up[k]};
      const double part = k > piece.begin ? part_within_bounds(files_[f], piece.section, k) : 1.0;
      if (part < 1.0 && !result.points.empty() && result.rows.back() + 1 == k) {
        const PicturePoint before = result.points.back();
        point = {before.x + part * (point.x - before.x), before.y + part * (point.y - before.y)};
      }
      result.rows.push_back(k);
      result.points.push_back(point);
    }
    return result;
  }

  void tell_missing_orbits(const BranchFile& file, std::size_t s, const BranchQuantity& x, const BranchQuantity& y) {
    const std::string& what = y.orbits_of.empty() ? x.orbits_of : y.orbits_of;
    if (what.empty() || warnings_ == nullptr) return;
    std::size_t all = 0, known = 0;
    for (const BranchPiece& piece : file.pieces)  // the first point of a restart never has a label
      for (std::size_t k = piece.begin + 1; k < piece.end && piece.section == s; ++k)
        ++all, known += x.known[k] && y.known[k];
    if (known < all)
      warnings_->push_back(
          fmt::format("{}: {} is known at the {} of {} points that have an orbit in the q-file; a line "
                      "goes through these alone, and not over more than an eighth of the branch (a run with NPR=1 "
                      "writes all orbits)",
                      file.path, what, known, all));
  }

  /// Width and height of what is shown.
  static PicturePoint size_of(const std::vector<Piece>& pieces) {
    std::vector<double> x, y;
    for (const Piece& piece : pieces)
      for (const PicturePoint& p : piece.points) x.push_back(p.x), y.push_back(p.y);
    const AxisScale along_x = choose_scale({}, x, 8), along_y = choose_scale({}, y, 8);
    return {along_x.high - along_x.low, along_y.high - along_y.low};
  }

  void add_piece(const Piece& piece, const PicturePoint& scale) {
    if (piece.rows.empty()) return;
    const auto intervals = smooth_intervals(piece.points, scale);
    if (section_of(piece).is_two_parameter_curve())
      add_curve(piece, intervals);
    else
      add_branch(piece, intervals);
    add_markers(piece);
  }

  /// Without names, curves of one kind are alike in all files.
  FileCurve curve_in(const BranchFile& file, const PointSection& section) const {
    return {options_.black ? "" : file.path, kind_of(section)};
  }

  const PointSection& section_of(const Piece& piece) const { return files_[piece.file].sections[piece.section]; }

  using Intervals = std::vector<std::vector<PicturePoint>>;  // the line from each point to the next

  /// Runs of points whose lines look alike share their end points.
  template <class StrokeOf>
  void add_runs(const Piece& piece, const Intervals& intervals, StrokeOf stroke_of) {
    std::optional<LineKind> before;
    for (std::size_t k = 0; k < intervals.size(); ++k) {
      const LineKind kind = line_kind(files_[piece.file], piece.section, piece.rows[k + 1]);
      if (kind != before)
        panel_.curves.push_back({{intervals[k].front()}, stroke_of(kind), false, kind == LineKind::inadmissible});
      auto& points = panel_.curves.back().points;
      points.insert(points.end(), intervals[k].begin() + 1, intervals[k].end());
      before = kind;
    }
  }

  void add_branch(const Piece& piece, const Intervals& intervals) {
    const BranchFile& file = files_[piece.file];
    const std::string colour = !curves_.empty() ? unused_colour(curve_kinds_, position(plain_files_, file.path))
                               : plain_files_.size() > 1 && !options_.black ? series_colour(piece.file)
                                                                            : neutral;
    knows_stability_ = knows_stability_ || section_of(piece).has_stability();
    add_runs(piece, intervals, [this, &colour](LineKind kind) {
      kinds_.insert(kind);
      return line_stroke(kind, colour, line_width);
    });
    if (!options_.black) add_file_entry(piece.file, {Dash::solid, line_width, colour}, std::nullopt, file.name);
  }

  void add_curve(const Piece& piece, const Intervals& intervals) {
    const CurveKind& kind = curve_kinds_[position(curves_, curve_in(files_[piece.file], section_of(piece)))];
    const std::size_t first = panel_.curves.size();
    add_runs(piece, intervals, [this, &kind](LineKind line) {
      if (line == LineKind::inadmissible) kinds_.insert(line);
      return line_stroke(line, kind.colour, 0.85 * line_width);
    });
    const Marker symbol{{}, kind.symbol, kind.filled, 0.6, kind.colour};
    for (std::size_t k = first; k < panel_.curves.size(); ++k)
      if (curves_.size() > 1 && !panel_.curves[k].minor) panel_.curves[k].symbol = symbol;
    const std::string& name = kind.name;
    const bool several = std::count_if(curves_.begin(), curves_.end(),
                                       [&name](const FileCurve& other) { return other.kind.name == name; }) > 1;
    add_file_entry(piece.file, {Dash::solid, 0.85 * line_width, kind.colour},
                   curves_.size() > 1 ? std::optional(symbol) : std::nullopt,
                   several ? fmt::format("{} ({})", name, files_[piece.file].name) : name);
  }

  void add_markers(const Piece& piece) {
    const BranchFile& file = files_[piece.file];
    const std::size_t first = panel_.computed.size();
    for (std::size_t k = 0; k < piece.points.size(); ++k)
      panel_.computed.push_back({piece.points[k], piece.file, piece.section, piece.rows[k]});
    for (std::size_t k = 0; k < piece.points.size(); ++k) {
      const std::size_t row = piece.rows[k];
      const std::string& type = file.types[piece.section][row];
      const int label = section_of(piece).rows[row].label;
      if (label == 0 || type.empty() || !options_.labels.includes(type)) continue;
      Marker marker = special_point_marker(type, piece.points[k]);
      marker.minor = !file.admissible[piece.section][row];
      marker.computed = first + k;
      if (const DiagnosticPoint* const point = file.diagnostic_of(piece.section, row);
          point != nullptr && point->normal_form && point->normal_form->is_subcritical())
        marker.filled = false;
      const auto zeros = file.xi_zeros.find(label);
      if (options_.labels.numbers)
        marker.label = plain_text(fmt::format("{} {}", type, label));
      else if (type == "XI" && zeros != file.xi_zeros.end())
        marker.label = xi_name(zeros->second);
      panel_.markers.push_back(std::move(marker));
    }
  }

  /// A lone cloud without branches needs no key.
  void add_underlay() {
    const Underlay& underlay = options_.underlay;
    panel_.field = underlay.field;
    panel_.clouds = underlay.clouds;
    panel_.curves.insert(panel_.curves.begin(), underlay.curves.begin(), underlay.curves.end());
    const bool alone = files_.empty() && options_.clouds.empty() && options_.legend.empty() && !underlay.field;
    if (underlay.key.size() > 1 || !alone) key_.insert(key_.end(), underlay.key.begin(), underlay.key.end());
    if (x_label_.empty()) x_label_ = underlay.x;
    if (y_label_.empty()) y_label_ = underlay.y;
  }

  void add_clouds() {
    for (const NamedCloud& cloud : options_.clouds) {
      const std::string colour = cloud_colour(panel_.clouds.size());
      panel_.clouds.push_back({cloud.points, colour, 0.5});
      key_.push_back({plain_text(cloud.name), std::nullopt, cloud_marker(colour)});
      if (x_label_.empty()) x_label_ = mathematical_name(cloud.x_name);
      if (y_label_.empty()) y_label_ = mathematical_name(cloud.y_name);
    }
  }

  /// One entry a file, or a kind of curve.
  void add_file_entry(std::size_t f, const Stroke& stroke, const std::optional<Marker>& marker,
                      const std::string& name) {
    const bool own = f < options_.legend.size();
    const LabelText text = plain_text(own ? options_.legend[f] : name);
    for (const KeyEntry& entry : key_)
      if (entry.text.text == text.text) return;
    key_.push_back({text, stroke, marker});
  }

  /// What the dashes mean; the name of a lone branch is left out where they say enough.
  void add_key() {
    if (knows_stability_ && key_.size() == 1 && key_[0].stroke && options_.legend.empty()) key_.clear();
    if (!knows_stability_) kinds_.erase(LineKind::stable);
    const std::string colour = key_.empty() || (key_.size() == 1 && key_[0].stroke) ? neutral : "#606060";
    for (KeyEntry& entry : line_kind_entries(kinds_, colour, line_width)) key_.push_back(std::move(entry));
  }

  const std::vector<BranchFile>& files_;
  const BranchFigureOptions& options_;
  std::vector<std::string>* warnings_;
  AxisColumns axes_;
  std::vector<FileCurve> curves_;  // in the order given
  std::vector<CurveKind> curve_kinds_;
  std::vector<std::string> plain_files_;  // files with branches in one parameter
  std::set<LineKind> kinds_;
  bool knows_stability_ = false;
  LabelText x_label_, y_label_;
  Panel panel_;
  std::vector<KeyEntry> key_;
};

}  // namespace

bool LabelSelection::includes(const std::string& type) const {
  if (all) return true;
  if (defaults) return is_labelled_by_default(type);
  return std::find(types.begin(), types.end(), type) != types.end();
}

LineKind line_kind(const BranchFile& file, std::size_t section, std::size_t row) {
  const auto& admissible = file.admissible[section];
  if (!admissible[row] || (row > 0 && !admissible[row - 1])) return LineKind::inadmissible;
  const PointSection& s = file.sections[section];
  if (s.is_two_parameter_curve() || !s.has_stability()) return LineKind::stable;
  return s.rows[row].point < 0 ? LineKind::stable : LineKind::unstable;
}

Figure branch_figure(const std::vector<BranchFile>& files, const BranchFigureOptions& options,
                     std::vector<std::string>* warnings) {
  return BranchFigureBuilder(files, options, warnings).build();
}

namespace {

constexpr double digits_of_header = level::five_digits;

/// RL0, RL1, A0, A1 of r.NAME; nothing without it.
std::vector<double> recorded_bounds(const std::string& point_path) {
  const std::string path = sibling_path(point_path, 'r');
  std::error_code error;
  if (path.empty() || !std::filesystem::is_regular_file(path, error)) return {};
  try {
    const RunSettings settings = read_constants_file(path);
    return {settings.parameter_min, settings.parameter_max, settings.measure_min, settings.measure_max};
  } catch (const UserError&) {
    return {};  // the header's digits must do
  }
}

std::vector<double> bounds_of(const BranchFile& file, std::size_t section) {
  std::vector<double> bounds = file.sections[section].bounds;
  const std::vector<double> exact = recorded_bounds(file.path);
  for (std::size_t k = 0; k < std::min(bounds.size(), exact.size()); ++k)
    if (std::abs(bounds[k] - exact[k]) <= digits_of_header * std::abs(exact[k])) bounds[k] = exact[k];
  return bounds;
}

}  // namespace

double part_within_bounds(const BranchFile& file, std::size_t section, std::size_t row) {
  const PointSection& s = file.sections[section];
  const bool is_end = basic_type(s.rows[row].type) == static_cast<int>(PointType::end);
  if (!is_end || row == 0 || s.bounds.empty()) return 1.0;
  const std::vector<double> bounds = bounds_of(file, section);
  double part = 1.0;
  for (std::size_t k = 0; k < std::min<std::size_t>(2, s.columns.size()); ++k) {
    const double before = s.rows[row - 1].values[k], here = s.rows[row].values[k];
    for (const double bound : {bounds[2 * k], bounds[2 * k + 1]})
      if ((before < bound && bound < here) || (before > bound && bound > here))
        part = std::min(part, (bound - before) / (here - before));
  }
  return part;
}

namespace {

constexpr double fine_enough = 0.008;  // parts of the picture
constexpr int most_parts = 12;
constexpr double corner_cosine = 0.5;  // turns by more than 60 degrees are corners

class SmoothLine {
 public:
  SmoothLine(const std::vector<PicturePoint>& points, const PicturePoint& scale) : points_(points), scale_(scale) {}

  std::vector<PicturePoint> interval(std::size_t k) const {
    const PicturePoint a = points_[k], b = points_[k + 1];
    const double length = distance(a, b);
    if (!is_finite(a) || !is_finite(b) || !(length > fine_enough) || !std::isfinite(length)) return {a, b};
    const int parts = std::clamp(static_cast<int>(std::ceil(length / fine_enough)), 2, most_parts);
    const PicturePoint slope_a = slope(k, length, a, b), slope_b = slope(k + 1, length, a, b);
    std::vector<PicturePoint> result{a};
    for (int i = 1; i < parts; ++i) result.push_back(hermite(a, b, slope_a, slope_b, static_cast<double>(i) / parts));
    result.push_back(b);
    return result;
  }

 private:
  double distance(const PicturePoint& a, const PicturePoint& b) const {
    return std::hypot((b.x - a.x) / scale_.x, (b.y - a.y) / scale_.y);
  }

  /// Derivative at point k over an interval of that length; at ends and corners the straight line's.
  PicturePoint slope(std::size_t k, double length, const PicturePoint& a, const PicturePoint& b) const {
    const PicturePoint straight{b.x - a.x, b.y - a.y};
    if (k == 0 || k + 1 >= points_.size()) return straight;
    const PicturePoint before = points_[k - 1], here = points_[k], after = points_[k + 1];
    const double first = distance(before, here), second = distance(here, after);
    if (!(first > 0.0) || !(second > 0.0) || !std::isfinite(first + second)) return straight;
    const double cosine = ((here.x - before.x) * (after.x - here.x) / (scale_.x * scale_.x) +
                           (here.y - before.y) * (after.y - here.y) / (scale_.y * scale_.y)) /
                          (first * second);
    if (cosine < corner_cosine) return straight;
    const auto derivative = [&](double p, double q, double r) {
      return length * ((q - p) / first * second + (r - q) / second * first) / (first + second);
    };
    return {derivative(before.x, here.x, after.x), derivative(before.y, here.y, after.y)};
  }

  static PicturePoint hermite(const PicturePoint& a, const PicturePoint& b, const PicturePoint& slope_a,
                              const PicturePoint& slope_b, double t) {
    const double t2 = t * t, t3 = t2 * t;
    const double wa = 2.0 * t3 - 3.0 * t2 + 1.0, wb = 1.0 - wa, va = t3 - 2.0 * t2 + t, vb = t3 - t2;
    return {wa * a.x + wb * b.x + va * slope_a.x + vb * slope_b.x,
            wa * a.y + wb * b.y + va * slope_a.y + vb * slope_b.y};
  }

  const std::vector<PicturePoint>& points_;
  PicturePoint scale_;
};

}  // namespace

std::vector<std::vector<PicturePoint>> smooth_intervals(const std::vector<PicturePoint>& points,
                                                        const PicturePoint& scale) {
  const SmoothLine line(points, scale);
  std::vector<std::vector<PicturePoint>> intervals;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) intervals.push_back(line.interval(k));
  return intervals;
}

}  // namespace tchat
