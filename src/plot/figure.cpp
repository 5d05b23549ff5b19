#include "plot/figure.hpp"

#include <algorithm>

namespace tchat {

namespace {

/// Half the distance of neighbours; a lone one is as wide as its value, or 1.
double half_distance(double first, double last, std::size_t count) {
  if (count > 1) return 0.5 * std::abs(last - first) / static_cast<double>(count - 1);
  return first != 0.0 ? 0.5 * std::abs(first) : 0.5;
}

}  // namespace

PicturePoint ColourField::half_cell() const {
  return {half_distance(first.x, last.x, columns), half_distance(first.y, last.y, rows)};
}

PicturePoint ColourField::low() const {
  const PicturePoint half = half_cell();
  return {std::min(first.x, last.x) - half.x, std::min(first.y, last.y) - half.y};
}

PicturePoint ColourField::high() const {
  const PicturePoint half = half_cell();
  return {std::max(first.x, last.x) + half.x, std::max(first.y, last.y) + half.y};
}

}  // namespace tchat
