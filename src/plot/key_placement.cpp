#include "plot/key_placement.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tchat {

namespace {

constexpr double sample_width = 2.9;  // of a line and the gap to the text, in units of the font's size

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

KeySize::KeySize(const std::vector<KeyEntry>& entries, double font)
    : rows_(static_cast<int>(entries.size())), font_(font) {
  for (const KeyEntry& entry : entries)
    width_ = std::max(width_, (text_width(entry.text) * label_font_ratio + sample_width + 0.3) * font);
}

int KeySize::columns(double available) const {
  return std::clamp(static_cast<int>(available / std::max(width_, 1.0)), 1, std::max(rows_, 1));
}

double KeySize::rows_height(double available) const {
  const int columns_used = columns(available);
  return line_height() * ((rows_ + columns_used - 1) / columns_used) + 0.4 * font_;
}

std::optional<KeyPlace> KeySize::place_inside(const Obstacles& obstacles) const {
  const Box area = obstacles.frame.grown(-0.4 * font_);
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
    if (cost < least) least = cost, best = KeyPlace{box, true};
  }
  return best;
}

KeyPlace KeySize::place_above(const Box& frame) const {
  return {{frame.left, frame.right, frame.top + 0.2 * font_, frame.top + 0.2 * font_ + rows_height(frame.width())},
          false};
}

}  // namespace tchat
