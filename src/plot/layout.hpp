/// The layout of a figure on the paper: frames and scales, the place of the key, and symbols along curves.
#pragma once

#include <optional>
#include <vector>

#include "plot/figure.hpp"
#include "plot/label_placement.hpp"

namespace tchat {

// Where everything of a figure stands on the paper: frames of the panels, scales of the axes, places of labels and of
// the key. Pixels of the picture, y upwards from its lower edge.

struct PanelLayout {
  Box frame;
  AxisScale x;
  AxisScale y;
  AxisScale z;                                     ///< of a picture in space
  std::vector<std::optional<PlacedLabel>> labels;  ///< one for each marker; nothing where there is no label to show
  std::vector<double> dash_scales;                 ///< one for each curve, see ShortPieces
  std::vector<Marker> symbols;                     ///< along the curves
  std::vector<double> marker_scales;               ///< one for each marker

  PicturePoint on_paper(const PicturePoint& p) const;
  /// The point of the data at a place on the paper.
  PicturePoint in_data(const PicturePoint& p) const;
};

struct KeyPlace {
  Box box;
  bool inside = true;                 ///< inside the first panel; otherwise above it
  double font = 27.0;                 ///< as that of the axes, or smaller
  std::vector<PicturePoint> entries;  ///< the left end of each entry's sample, at half its height
};

/// A strip of colours beside the frames, with an axis at its right.
struct ColourBarPlace {
  Box box;
  AxisScale scale;
};

struct FigureLayout {
  double font = 27.0;  ///< size of the axes' font; that of labels at points is label_font_ratio times this
  std::vector<PanelLayout> panels;
  std::optional<KeyPlace> key;
  std::optional<ColourBarPlace> colour_bar = {};
};

inline constexpr double label_font_ratio = 0.85;

/// Of the lines in the key, in units of the font's size.
inline constexpr double key_sample_length = 2.6;

/// Markers of a size of 1 have this radius, in units of the font's size.
inline constexpr double marker_radius = 0.25;

/// Throws UserError for axes that cannot show the data (see choose_scale).
FigureLayout lay_out(const Figure& figure);

// The key of a figure: how large it is, and a place for it where it hides nothing.
//
// Its entries stand in columns, each as wide as its own longest text. Inside the frame there is one column; above the
// frame there are as many as fit side by side, in smaller letters where a long text or many entries would not fit.

/// Sizes of a key in pixels, for the size of the axes' font in pixels.
class KeyGrid {
 public:
  /// One column.
  KeyGrid(const std::vector<KeyEntry>& entries, double font);
  /// As few rows as fit into a width and a height.
  KeyGrid(const std::vector<KeyEntry>& entries, double font, double width, double height);

  bool empty() const { return widths_.empty(); }
  double width() const;
  double height() const { return line_height() * static_cast<double>(rows_) + 0.4 * font_; }

  /// The emptiest of the corners and middles of the frame's edges; nothing when curves run through all of them.
  std::optional<KeyPlace> place_inside(const Obstacles& obstacles) const;
  /// Above a frame, in its middle, but inside the picture.
  KeyPlace place_above(const Box& frame, double picture_width) const;

 private:
  double line_height() const { return 1.25 * font_; }
  void fill(std::size_t columns);
  KeyPlace placed(double left, double bottom, bool inside) const;

  std::vector<double> widths_;  // of the entries in units of the font's size
  std::size_t rows_ = 0;
  std::vector<double> columns_;  // widths of the columns, in the same units
  double font_ = 27.0;
};

// Symbols along curves, which tell them apart without their colours.

/// The symbol of every curve that has one, at about equal distances along what is seen of it, clear of the panel's
/// markers and of one another. The frame and the scales of the layout are known; `font` is the size of the axes' font.
std::vector<Marker> symbols_along_curves(const Panel& panel, const PanelLayout& layout, double font);

// Pieces of a line that are so short on the paper that dashes, symbols or labels could hide what they are.

struct ShortPieces {
  std::vector<double> dash_scales;    ///< by curve: shorter dashes where few of them would fit
  std::vector<double> marker_scales;  ///< by marker: smaller at the end of a very short piece
  std::vector<Box> boxes;             ///< along short dashed and dotted pieces, for labels to keep clear of
};

/// Of a panel whose frame and scales are known; `font` is the size of the axes' font.
ShortPieces find_short_pieces(const Panel& panel, const PanelLayout& layout, double font);

}  // namespace tchat
