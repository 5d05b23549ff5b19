/// A picture before it is drawn: its panels, curves and markers, and their styles, colours and axes.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "files/orbit_trace.hpp"
#include "plot/label_text.hpp"
#include "settings/point_type.hpp"

namespace tchat {

// A picture before it is drawn: panels with curves, markers and texts in the coordinates of the data.
//
// What is drawn is decided by the builders (branch_figure, orbit_figure, multiplier_figure); where things stand on the
// paper by layout and label_placement; how gnuplot is told by gnuplot_script.

struct PicturePoint {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;  ///< of panels in space

  bool operator==(const PicturePoint&) const = default;
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

using Symbol = PointSymbol;

struct Marker {
  PicturePoint at;
  Symbol symbol = Symbol::circle;
  bool filled = true;
  double size = 1.0;
  std::string colour = "#000000";
  LabelText label = {};                      ///< empty: none
  bool one_of_many = false;                  ///< where they are crowded some go without label
  bool minor = false;                        ///< as that of a curve
  std::optional<std::size_t> computed = {};  ///< the point of a branch that it marks, in the panel's list
};

/// A point of a branch where it is drawn: what a page shows of it is in the file.
struct ComputedPoint {
  PicturePoint at;
  std::size_t file = 0, section = 0, row = 0;  ///< the file counts among those of the figure
};

/// A polyline; a point that is not finite interrupts it.
struct Curve {
  std::vector<PicturePoint> points;
  Stroke stroke;
  bool background = false;            ///< event surfaces, axes: neither part of the range nor avoided by labels
  bool minor = false;                 ///< inadmissible: part of the range only where a panel has nothing else
  std::optional<Marker> symbol = {};  ///< repeated along it
};

/// Where dots and cells are from: rows of the figure's `sweep`-th sweep. Empty for what is from elsewhere.
struct SweepRows {
  std::size_t sweep = 0;
  std::vector<std::optional<std::size_t>> rows = {};
};

/// Dots beneath everything else.
struct Cloud {
  std::vector<PicturePoint> points;
  std::string colour = "#000000";  ///< or "palette": z is each dot's number there
  double size = 0.5;               ///< as a marker's
  SweepRows rows = {};             ///< of each point
};

/// A map of equal rectangles, each in one colour, beneath the dots.
struct ColourField {
  std::size_t columns = 0, rows = 0;
  PicturePoint first, last;   ///< centres of the cells at the beginning and at the end of `cells`
  std::vector<double> cells;  ///< numbers in the figure's palette, row by row; NaN: nothing is drawn
  SweepRows sweep_rows = {};  ///< of each cell

  /// Half of a cell's width, and height.
  PicturePoint half_cell() const;
  /// Corners: the least and the largest coordinates that it covers.
  PicturePoint low() const;
  PicturePoint high() const;
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
  std::optional<ColourField> field = {};
  std::vector<Cloud> clouds;
  std::vector<Curve> curves;
  std::vector<Marker> markers;
  std::vector<Arrow> arrows;
  std::vector<ComputedPoint> computed = {};
  bool equal_scales = false;  ///< circles are round
};

/// A line of the key: a sample of a line, of a marker, or of both.
struct KeyEntry {
  LabelText text;
  std::optional<Stroke> stroke;
  std::optional<Marker> marker;
};

/// Colours that stand for numbers, linear between stops: a bar at the right edge shows what they mean.
struct Palette {
  std::vector<std::pair<double, std::string>> stops;  ///< rising numbers and their colours, #rrggbb
  LabelText label = {};                               ///< of the bar
  bool has_bar = true;

  double low() const { return stops.front().first; }
  double high() const { return stops.back().first; }
};

struct Figure {
  std::vector<Panel> panels;  ///< stacked, one below the other, with one x-axis
  std::vector<KeyEntry> key;
  std::optional<Palette> palette = {};
  LabelText title;
  LabelText note;  ///< a line below the title: what the picture leaves out
  int width = 1200;
  int height = 900;
  double least_left = 0.0;  ///< of the frames from the picture's left and upper edge, in pixels; wider where texts need
  double least_above = 0.0;  ///< it: so that frames of several figures in one picture stand side by side
  double view_tilt = 65.0;   ///< of pictures in space: degrees from looking down along z
  double view_turn = 35.0;   ///< and around z
};

// How things look by default: colours that stay apart in grey, dashes, and symbols of special points.

/// Colour of the k-th file or orbit (from 0): black first, then colours that differ for the colour-blind and in grey.
std::string series_colour(std::size_t k);

/// Colour of the k-th cloud of dots (from 0): pale, for curves lie over it.
std::string cloud_colour(std::size_t k);

/// A dot as large as those of clouds.
Marker cloud_marker(const std::string& colour);

/// Symbol of the k-th orbit in one picture, for its jumps.
Symbol series_symbol(std::size_t k);

/// Solid, dashed and thinner, or dotted and paler; `width` is that of a stable line.
Stroke line_stroke(LineKind kind, const std::string& colour, double width);

/// From the state before a jump to that behind it: thin and pale, for nothing moves along it.
Stroke jump_stroke(const std::string& colour);

/// What the dashes of these kinds mean, as lines of the key.
std::vector<KeyEntry> line_kind_entries(const std::set<LineKind>& kinds, const std::string& colour, double width);

/// The marker of a special point by its letters (LP, PD, GR, ...), with the letters as its label.
Marker special_point_marker(const std::string& type, const PicturePoint& at);

/// The types that are labelled when the user says nothing: bifurcations, grazing, codimension two; not UZ, RG, EP, MX.
bool is_labelled_by_default(const std::string& type);

/// All letters that points can have, for messages.
std::vector<std::string> all_point_types();

/// What a two-parameter curve consists of, by the letters of its points ("" where files do not tell), or grazing
/// orbits. It has a colour, and small symbols along it: those of the special points that make the curve.
struct CurveKind {
  std::string name;
  std::string colour;
  Symbol symbol = Symbol::circle;
  bool filled = true;
};
CurveKind curve_kind(const std::string& letters, bool grazing);

/// Several curves in one picture: the first of a kind has the colour of the kind, further ones others; as long as there
/// are colours each has its own.
std::vector<CurveKind> with_own_colours(std::vector<CurveKind> kinds);

/// The k-th (from 0) of the colours that none of these curves has; from the beginning again when there are no more.
std::string unused_colour(const std::vector<CurveKind>& curves, std::size_t k);

// Colours that stand for numbers.

/// From dark to light, in equal steps for the eye, also for the colour-blind and in grey; where there are numbers of
/// both signs, blue over a pale grey at zero to red.
Palette scale_palette(double low, double high);

/// Round a circle of hues, all of them equally light: for angles from 0 to 1, which have the same colour.
Palette cyclic_palette();

/// Colour k for the number k.
Palette category_palette(const std::vector<std::string>& colours);

/// #rrggbb of a number from the palette's low end to its high one.
std::string colour_at(const Palette& palette, double number);

// The range of an axis and its tics.

struct AxisScale {
  double low = 0.0;
  double high = 1.0;
  bool logarithmic = false;
  double tic_step = 0.2;       ///< of linear axes
  std::string format = "%g";   ///< printf format of the tics' numbers
  double widest_number = 1.0;  ///< of the tics, in units of the font's size

  /// Where a value stands, 0 at the low end and 1 at the high end; NaN for what a logarithmic axis cannot show.
  double fraction(double value) const;
};

/// A range that holds all `values` with a margin, the ends that the user chose kept, and tics at round numbers, at most
/// `most_steps` apart. Values that are not finite, beyond 1e90 in size, or not positive on a logarithmic axis
/// are left out of account. Throws UserError when a logarithmic axis has nothing positive to show.
AxisScale choose_scale(const AxisSettings& settings, const std::vector<double>& values, int most_steps);

/// Can this value be shown at all? Larger ones stand for infinity in p-files.
bool can_be_shown(double value);

}  // namespace tchat
