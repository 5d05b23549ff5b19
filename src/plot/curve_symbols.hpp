/// Symbols along curves, which tell them apart without their colours.
#pragma once

#include <vector>

#include "plot/figure.hpp"
#include "plot/layout.hpp"

namespace tchat {

/// The symbol of every curve that has one, at about equal distances along what is seen of it, clear of the panel's
/// markers and of one another. The frame and the scales of the layout are known; `font` is the size of the axes' font.
std::vector<Marker> symbols_along_curves(const Panel& panel, const PanelLayout& layout, double font);

}  // namespace tchat
