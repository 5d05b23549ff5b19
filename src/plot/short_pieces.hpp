/// Pieces of a line that are so short on the paper that dashes, symbols or labels could hide what they are.
#pragma once

#include <vector>

#include "plot/figure.hpp"
#include "plot/layout.hpp"

namespace tchat {

struct ShortPieces {
  std::vector<double> dash_scales;    ///< by curve: shorter dashes where few of them would fit
  std::vector<double> marker_scales;  ///< by marker: smaller at the end of a very short piece
  std::vector<Box> boxes;             ///< along short dashed and dotted pieces, for labels to keep clear of
};

/// Of a panel whose frame and scales are known; `font` is the size of the axes' font.
ShortPieces find_short_pieces(const Panel& panel, const PanelLayout& layout, double font);

}  // namespace tchat
