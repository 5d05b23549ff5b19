/// What lies beneath the branches of a diagram, or is a picture without any: what a sweep has found.
#pragma once

#include <optional>
#include <vector>

#include "plot/figure.hpp"

namespace tchat {

struct Underlay {
  std::optional<ColourField> field;
  std::optional<Palette> palette;
  std::vector<Cloud> clouds;
  std::vector<Curve> curves;  ///< error bars, and the line where an exponent is zero
  std::vector<KeyEntry> key;
  LabelText x, y;  ///< of the axes when there are no branches

  /// Puts another one on top. Throws UserError when both have a map, or both a palette.
  void add(Underlay other);
};

}  // namespace tchat
