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

class BranchFigureBuilder {
 public:
  BranchFigureBuilder(const std::vector<BranchFile>& files, const BranchFigureOptions& options)
      : files_(files), options_(options), axes_(default_columns(files)) {
    if (!options.x.empty()) axes_.x = options.x;
    if (!options.y.empty()) axes_.y = options.y;
    for (const BranchFile& file : files)
      for (const PointSection& section : file.sections) {
        const bool curve = section.is_two_parameter_curve();
        if (curve)
          ++kind_files_[curve_kind(curve_type_of(section), section.problem_type == 150).name][file.path];
        else
          plain_files_.insert(file.path);
      }
  }

  Figure build() {
    std::vector<Piece> pieces;
    for (std::size_t f = 0; f < files_.size(); ++f)
      for (const BranchPiece& piece : files_[f].pieces) pieces.push_back(read_piece(f, piece));
    const PicturePoint scale = size_of(pieces);
    for (const Piece& piece : pieces) add_piece(piece, scale);
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
    const auto number =
        static_cast<std::size_t>(std::distance(plain_files_.begin(), plain_files_.find(files_[f].path)));
    constexpr std::size_t after_curves = 3;  // colours that no curve has
    const std::string colour = !kind_files_.empty()      ? series_colour(after_curves + number)
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
    CurveKind kind = curve_kind(curve_type_of(section), section.problem_type == 150);
    const auto& of_kind = kind_files_[kind.name];
    const auto number = static_cast<std::size_t>(std::distance(of_kind.begin(), of_kind.find(files_[f].path)));
    static constexpr std::array<const char*, 3> further = {"#707070", "#b08a00", "#9a5aa0"};
    if (number > 0) kind.stroke.colour = further[(number - 1) % further.size()];
    add_runs(piece, intervals, files_[f], [this, &kind](LineKind line) {
      if (line != LineKind::inadmissible) return kind.stroke;
      kinds_.insert(line);
      return branch_stroke(line, kind.stroke.colour);
    });
    const bool several = of_kind.size() > 1;
    add_file_entry(f, kind.stroke, several ? fmt::format("{} ({})", kind.name, files_[f].name) : kind.name);
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
  std::map<std::string, std::map<std::string, int>> kind_files_;  // kind of curve -> files with such sections
  std::set<std::string> plain_files_;
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
