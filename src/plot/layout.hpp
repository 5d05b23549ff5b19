/// Where everything of a figure stands on the paper: frames of the panels, scales of the axes, places of labels and of
/// the key. Pixels of the picture, y upwards from its lower edge.
#pragma once

#include <optional>
#include <vector>

#include "plot/axis_scale.hpp"
#include "plot/figure.hpp"
#include "plot/label_placement.hpp"

namespace tchat {

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

}  // namespace tchat
