#include "plot/colour_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tchat {

namespace {

using Colour = std::array<double, 3>;  // red, green, blue from 0 to 255

/// Between fixed colours at equal distances.
template <std::size_t N>
std::vector<std::string> between(const std::array<Colour, N>& fixed, std::size_t count) {
  std::vector<std::string> colours;
  for (std::size_t k = 0; k < count; ++k) {
    const double place = static_cast<double>(k) * static_cast<double>(N - 1) / static_cast<double>(count - 1);
    const std::size_t left = std::min(static_cast<std::size_t>(place), N - 2);
    const double part = place - static_cast<double>(left);
    std::string colour = "#";
    for (std::size_t c = 0; c < 3; ++c)
      colour += fmt::format("{:02x}", std::lround((1.0 - part) * fixed[left][c] + part * fixed[left + 1][c]));
    colours.push_back(std::move(colour));
  }
  return colours;
}

}  // namespace

std::vector<std::string> rising_colours(std::size_t count) {
  constexpr std::array<Colour, 6> fixed = {{{68.0, 1.0, 84.0},
                                            {65.0, 68.0, 135.0},
                                            {42.0, 120.0, 142.0},
                                            {34.0, 168.0, 132.0},
                                            {122.0, 209.0, 81.0},
                                            {253.0, 231.0, 37.0}}};
  return between(fixed, count);
}

std::vector<std::string> signed_colours(std::size_t count) {
  constexpr std::array<Colour, 5> fixed = {
      {{33.0, 80.0, 160.0}, {120.0, 170.0, 210.0}, {238.0, 238.0, 238.0}, {235.0, 150.0, 110.0}, {170.0, 20.0, 40.0}}};
  return between(fixed, count);
}

}  // namespace tchat
