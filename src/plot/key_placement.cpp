#include "plot/key_placement.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace tchat {

namespace {

// In units of the font's size:
constexpr double sample_and_gap = key_sample_length + 0.5;
constexpr double column_gap = 1.2;
constexpr double smallest_font = 0.3;

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

KeyGrid::KeyGrid(const std::vector<KeyEntry>& entries, double font) : font_(font) {
  for (const KeyEntry& entry : entries)
    widths_.push_back(text_width(entry.text) * label_font_ratio + sample_and_gap + 0.3);
  fill(1);
}

KeyGrid::KeyGrid(const std::vector<KeyEntry>& entries, double font, double width, double height)
    : KeyGrid(entries, font) {
  for (; !empty(); font_ *= 0.9) {
    for (std::size_t columns = widths_.size(); columns > 0; --columns) {
      fill(columns);
      if (this->width() <= width && (this->height() <= height || font_ < smallest_font * font)) return;
    }
    if (font_ < 0.01 * font) return;  // a width of nothing
  }
}

/// Entries fill the columns one after the other.
void KeyGrid::fill(std::size_t columns) {
  rows_ = (widths_.size() + columns - 1) / columns;
  columns_.clear();
  for (std::size_t k = 0; k < widths_.size(); ++k) {
    if (k % rows_ == 0) columns_.push_back(0.0);
    columns_.back() = std::max(columns_.back(), widths_[k]);
  }
}

double KeyGrid::width() const {
  const double gaps = columns_.empty() ? 0.0 : column_gap * static_cast<double>(columns_.size() - 1);
  return (std::accumulate(columns_.begin(), columns_.end(), 0.0) + gaps) * font_;
}

KeyPlace KeyGrid::placed(double left, double bottom, bool inside) const {
  KeyPlace place{{left, left + width(), bottom, bottom + height()}, inside, font_, {}};
  const double first = place.box.top - 0.2 * font_ - 0.5 * line_height();
  for (std::size_t k = 0; k < widths_.size(); ++k) {
    if (k > 0 && k % rows_ == 0) left += (columns_[k / rows_ - 1] + column_gap) * font_;
    place.entries.push_back({left, first - static_cast<double>(k % rows_) * line_height()});
  }
  return place;
}

std::optional<KeyPlace> KeyGrid::place_inside(const Obstacles& obstacles) const {
  Box area = obstacles.frame.grown(-0.4 * font_);
  area.left += 0.5 * font_, area.right -= 0.2 * font_;  // clear of the tics
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
    for (const PicturePoint& dot : obstacles.dots)
      if (box.contains(dot)) cost += 0.1 * font_;
    if (cost < least) least = cost, best = placed(left, bottom, true);
  }
  return best;
}

KeyPlace KeyGrid::place_above(const Box& frame, double picture_width) const {
  const double left = std::min(frame.centre().x - 0.5 * width(), picture_width - 0.5 * font_ - width());
  return placed(std::max(left, 0.5 * font_), frame.top + 0.2 * font_, false);
}

}  // namespace tchat
