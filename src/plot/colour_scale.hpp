/// Colours that stand for numbers.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "plot/figure.hpp"

namespace tchat {

/// From dark to light, in equal steps for the eye, also for the colour-blind and in grey; where there are numbers of
/// both signs, blue over a pale grey at zero to red.
Palette scale_palette(double low, double high);

/// Round a circle of hues, all of them equally light: for angles from 0 to 1, which have the same colour.
Palette cyclic_palette();

/// Colour k for the number k.
Palette category_palette(const std::vector<std::string>& colours);

/// #rrggbb of a number from the palette's low end to its high one.
std::string colour_at(const Palette& palette, double number);

}  // namespace tchat
