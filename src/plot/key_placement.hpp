/// The key of a figure: how large it is, and a place for it where it hides nothing.
///
/// Its entries stand in columns, each as wide as its own longest text. Inside the frame there is one column; above the
/// frame there are as many as fit side by side, in smaller letters where a long text or many entries would not fit.
#pragma once

#include <optional>
#include <vector>

#include "plot/figure.hpp"
#include "plot/label_placement.hpp"
#include "plot/layout.hpp"

namespace tchat {

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

}  // namespace tchat
