#include "plot/branch_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include "plot/axis_scale.hpp"
#include "plot/branch_columns.hpp"
#include "plot/picture_styles.hpp"
#include "plot/smooth_line.hpp"

namespace tchat {

namespace {

constexpr const char* neutral = "#000000";

Stroke branch_stroke(LineKind kind, const std::string& colour) {
  switch (kind) {
    case LineKind::stable:
      return {Dash::solid, 3.0, colour};
    case LineKind::unstable:
      return {Dash::dashed, 2.2, colour};
    default:
      return {Dash::fine_dotted, 2.0, colour};
  }
}

/// Letters that all points of a two-parameter curve share: from the header, or from the tens digit of a type.
int curve_type_of(const PointSection& section) {
  if (section.curve_type != 0) return section.curve_type;
  for (const PointRow& row : section.rows)
    if (const int tens = std::abs(row.type) / 10; tens > 0) return tens;
  return 0;
}

CurveKind kind_of(const PointSection& section) {
  return curve_kind(curve_type_of(section), section.problem_type == 150);
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
  BranchFigureBuilder(const std::vector<BranchFile>& files, const BranchFigureOptions& options)
      : files_(files), options_(options) {
    if (!files.empty()) axes_ = default_columns(files);
    if (!options.x.empty()) axes_.x = options.x;
    if (!options.y.empty()) axes_.y = options.y;
    for (const BranchFile& file : files)
      for (const PointSection& section : file.sections) {
        if (section.is_two_parameter_curve())
          add_once(curves_, FileCurve{file.path, kind_of(section)});
        else
          add_once(plain_files_, file.path);
      }
    std::vector<CurveKind> kinds;
    for (const FileCurve& curve : curves_) kinds.push_back(curve.kind);
    curve_strokes_ = curve_strokes(kinds);
  }

  Figure build() {
    std::vector<Piece> pieces;
    for (std::size_t f = 0; f < files_.size(); ++f)
      for (const BranchPiece& piece : files_[f].pieces) pieces.push_back(read_piece(f, piece));
    const PicturePoint scale = size_of(pieces);
    for (const Piece& piece : pieces) add_piece(piece, scale);
    add_clouds();
    add_key();
    panel_.x.label = mathematical_name(x_name_);
    panel_.y.label = mathematical_name(y_name_);
    Figure figure;
    figure.panels.push_back(std::move(panel_));
    figure.key = std::move(key_);
    return figure;
  }

 private:
  /// A piece of a file with its points in the picture.
  struct Piece {
    std::size_t file;
    BranchPiece rows;
    std::vector<PicturePoint> points;
  };

  Piece read_piece(std::size_t f, const BranchPiece& piece) {
    const BranchFile& file = files_[f];
    const PointSection& section = file.sections[piece.section];
    const ColumnSource x = find_column(file, piece.section, axes_.x, "-x");
    const ColumnSource y = find_column(file, piece.section, axes_.y, "-y");
    if (x_name_.empty()) x_name_ = x.name, y_name_ = y.name;
    Piece result{f, piece, {}};
    for (std::size_t k = piece.begin; k < piece.end; ++k)
      result.points.push_back({x.value(section.rows[k]), y.value(section.rows[k])});
    return result;
  }

  /// Width and height of what is shown.
  static PicturePoint size_of(const std::vector<Piece>& pieces) {
    std::vector<double> x, y;
    for (const Piece& piece : pieces)
      for (const PicturePoint& p : piece.points) x.push_back(p.x), y.push_back(p.y);
    const AxisScale along_x = choose_scale({}, x, 5), along_y = choose_scale({}, y, 5);
    return {along_x.high - along_x.low, along_y.high - along_y.low};
  }

  void add_piece(const Piece& piece, const PicturePoint& scale) {
    const PointSection& section = files_[piece.file].sections[piece.rows.section];
    const auto intervals = smooth_intervals(piece.points, scale);
    if (section.is_two_parameter_curve())
      add_curve(piece.file, piece.rows, intervals);
    else
      add_branch(piece.file, piece.rows, intervals);
    add_markers(files_[piece.file], piece.rows, piece.points);
  }

  using Intervals = std::vector<std::vector<PicturePoint>>;  // the line from each point to the next

  /// Runs of points whose lines look alike share their end points.
  template <class StrokeOf>
  void add_runs(const BranchPiece& piece, const Intervals& intervals, const BranchFile& file, StrokeOf stroke_of) {
    std::optional<LineKind> before;
    for (std::size_t k = 0; k < intervals.size(); ++k) {
      const LineKind kind = line_kind(file, piece.section, piece.begin + k + 1);
      if (kind != before)
        panel_.curves.push_back({{intervals[k].front()}, stroke_of(kind), false, kind == LineKind::inadmissible});
      auto& points = panel_.curves.back().points;
      points.insert(points.end(), intervals[k].begin() + 1, intervals[k].end());
      before = kind;
    }
  }

  void add_branch(std::size_t f, const BranchPiece& piece, const Intervals& intervals) {
    const std::string colour = !curves_.empty() ? unused_colour(curve_strokes_, position(plain_files_, files_[f].path))
                               : plain_files_.size() > 1 ? series_colour(f)
                                                         : neutral;
    add_runs(piece, intervals, files_[f], [this, &colour](LineKind kind) {
      kinds_.insert(kind);
      return branch_stroke(kind, colour);
    });
    add_file_entry(f, {Dash::solid, 3.0, colour}, files_[f].name);
  }

  void add_curve(std::size_t f, const BranchPiece& piece, const Intervals& intervals) {
    const PointSection& section = files_[f].sections[piece.section];
    const FileCurve curve{files_[f].path, kind_of(section)};
    const Stroke& stroke = curve_strokes_[position(curves_, curve)];
    add_runs(piece, intervals, files_[f], [this, &stroke](LineKind line) {
      if (line != LineKind::inadmissible) return stroke;
      kinds_.insert(line);
      return branch_stroke(line, stroke.colour);
    });
    const std::string& name = curve.kind.name;
    const bool several = std::count_if(curves_.begin(), curves_.end(),
                                       [&name](const FileCurve& other) { return other.kind.name == name; }) > 1;
    add_file_entry(f, stroke, several ? fmt::format("{} ({})", name, files_[f].name) : name);
  }

  void add_markers(const BranchFile& file, const BranchPiece& piece, const std::vector<PicturePoint>& points) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      const std::string& type = file.types[piece.section][piece.begin + k];
      const int label = file.sections[piece.section].rows[piece.begin + k].label;
      if (label == 0 || type.empty() || !options_.labels.includes(type)) continue;
      Marker marker = special_point_marker(type, points[k]);
      marker.minor = !file.admissible[piece.section][piece.begin + k];
      const auto zeros = file.xi_zeros.find(label);
      if (options_.labels.numbers)
        marker.label = plain_text(fmt::format("{} {}", type, label));
      else if (type == "XI" && zeros != file.xi_zeros.end())
        marker.label = xi_name(zeros->second);
      panel_.markers.push_back(std::move(marker));
    }
  }

  void add_clouds() {
    for (const NamedCloud& cloud : options_.clouds) {
      const std::string colour = cloud_colour(panel_.clouds.size());
      panel_.clouds.push_back({cloud.points, colour});
      key_.push_back({plain_text(cloud.name), std::nullopt, cloud_marker(colour)});
      if (x_name_.empty()) x_name_ = cloud.x_name;
      if (y_name_.empty()) y_name_ = cloud.y_name;
    }
  }

  /// One entry a file, or a kind of curve.
  void add_file_entry(std::size_t f, const Stroke& stroke, const std::string& name) {
    const bool own = f < options_.legend.size();
    const LabelText text = plain_text(own ? options_.legend[f] : name);
    for (const KeyEntry& entry : key_)
      if (entry.text.text == text.text) return;
    key_.push_back({text, stroke, std::nullopt});
  }

  /// What the dashes mean, where more than one of them is in the picture; a lone name is left out.
  void add_key() {
    if (key_.size() == 1 && options_.legend.empty()) key_.clear();
    if (kinds_.size() > 1 || kinds_.contains(LineKind::inadmissible)) {
      static constexpr std::array<std::pair<LineKind, const char*>, 3> names = {
          {{LineKind::stable, "stable"}, {LineKind::unstable, "unstable"}, {LineKind::inadmissible, "inadmissible"}}};
      const std::string colour = key_.size() > 1 ? "#606060" : neutral;
      for (const auto& [kind, name] : names)
        if (kinds_.contains(kind)) key_.push_back({plain_text(name), branch_stroke(kind, colour), std::nullopt});
    }
  }

  const std::vector<BranchFile>& files_;
  const BranchFigureOptions& options_;
  AxisColumns axes_;
  std::vector<FileCurve> curves_;  // in the order given
  std::vector<Stroke> curve_strokes_;
  std::vector<std::string> plain_files_;  // files with branches in one parameter
  std::set<LineKind> kinds_;
  std::string x_name_, y_name_;
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

Figure branch_figure(const std::vector<BranchFile>& files, const BranchFigureOptions& options) {
  return BranchFigureBuilder(files, options).build();
}

}  // namespace tchat
