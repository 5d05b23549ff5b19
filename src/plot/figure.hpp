/// A picture before it is drawn: panels with curves, markers and texts in the coordinates of the data.
///
/// What is drawn is decided by the builders (branch_figure, orbit_figure, multiplier_figure); where things stand on the
/// paper by layout and label_placement; how gnuplot is told by gnuplot_script.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "plot/label_text.hpp"

namespace tchat {

struct PicturePoint {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;  ///< of panels in space
};

inline bool is_finite(const PicturePoint& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

/// Dashes tell stability and nothing else: what is stable or has no stability is solid, what is unstable dashed, what
/// the model forbids dotted.
enum class Dash { solid, dashed, dotted };

struct Stroke {
  Dash dash = Dash::solid;
  double width = 2.5;  ///< for a picture 1200 pixels wide
  std::string colour = "#000000";
};

enum class Symbol { square, circle, triangle, diamond, pentagon, reversed_triangle, dot };

struct Marker {
  PicturePoint at;
  Symbol symbol = Symbol::circle;
  bool filled = true;
  double size = 1.0;
  std::string colour = "#000000";
  LabelText label;           ///< empty: none
  bool one_of_many = false;  ///< where they are crowded some go without label
  bool minor = false;        ///< as that of a curve
};

/// A polyline; a point that is not finite interrupts it.
struct Curve {
  std::vector<PicturePoint> points;
  Stroke stroke;
  bool background = false;            ///< event surfaces, axes: neither part of the range nor avoided by labels
  bool minor = false;                 ///< inadmissible: part of the range only where a panel has nothing else
  std::optional<Marker> symbol = {};  ///< repeated along it
};

/// Dots beneath everything else.
struct Cloud {
  std::vector<PicturePoint> points;
  std::string colour = "#000000";
};

/// An arrowhead on a curve.
struct Arrow {
  PicturePoint from;
  PicturePoint to;
  std::string colour = "#000000";
};

struct AxisSettings {
  LabelText label;
  std::optional<double> low;  ///< chosen by the user
  std::optional<double> high;
  bool logarithmic = false;
};

struct Panel {
  AxisSettings x;
  AxisSettings y;
  std::optional<AxisSettings> z;  ///< present: a picture in space, the only panel of its figure, without labels
  std::vector<Cloud> clouds;
  std::vector<Curve> curves;
  std::vector<Marker> markers;
  std::vector<Arrow> arrows;
  bool equal_scales = false;  ///< circles are round
};

/// A line of the key: a sample of a line, of a marker, or of both.
struct KeyEntry {
  LabelText text;
  std::optional<Stroke> stroke;
  std::optional<Marker> marker;
};

struct Figure {
  std::vector<Panel> panels;  ///< stacked, one below the other, with one x-axis
  std::vector<KeyEntry> key;
  LabelText title;
  LabelText note;  ///< a line below the title: what the picture leaves out
  int width = 1200;
  int height = 900;
  double view_tilt = 65.0;  ///< of pictures in space: degrees from looking down along z
  double view_turn = 35.0;  ///< and around z
};

}  // namespace tchat
