/// The key of a figure: how large it is, and a place for it where it hides nothing.
#pragma once

#include <optional>
#include <vector>

#include "plot/figure.hpp"
#include "plot/label_placement.hpp"
#include "plot/layout.hpp"

namespace tchat {

/// Sizes of a key in pixels, for a font size in pixels.
class KeySize {
 public:
  KeySize(const std::vector<KeyEntry>& entries, double font);

  bool empty() const { return rows_ == 0; }
  double width() const { return width_; }
  double height() const { return line_height() * rows_ + 0.4 * font_; }
  /// With the entries side by side over a width.
  double rows_height(double available) const;
  int columns(double available) const;

  /// The emptiest of the corners and middles of the frame's edges; nothing when curves run through all of them.
  std::optional<KeyPlace> place_inside(const Obstacles& obstacles) const;
  KeyPlace place_above(const Box& frame) const;

 private:
  double line_height() const { return 1.25 * font_; }

  int rows_ = 0;
  double width_ = 0.0;
  double font_ = 27.0;
};

}  // namespace tchat
