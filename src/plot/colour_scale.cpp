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

/// Hues of the plane (a, b) of Oklab [Ottosson 2020] at one lightness and chroma, all within sRGB.
std::vector<std::string> cyclic_colours(std::size_t count) {
  constexpr double lightness = 0.64, chroma = 0.115, turn = 6.283185307179586;
  const auto encoded = [](double linear) {
    const double v = std::clamp(linear, 0.0, 1.0);
    return std::lround(255.0 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055));
  };
  std::vector<std::string> colours;
  for (std::size_t k = 0; k < count; ++k) {
    const double hue = turn * (static_cast<double>(k) / static_cast<double>(count) + 0.7);
    const double a = chroma * std::cos(hue), b = chroma * std::sin(hue);
    const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
    const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
    const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
    colours.push_back(fmt::format("#{:02x}{:02x}{:02x}",
                                  encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
                                  encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
                                  encoded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)));
  }
  return colours;
}

std::vector<std::string> signed_colours(std::size_t count) {
  constexpr std::array<Colour, 5> fixed = {
      {{33.0, 80.0, 160.0}, {120.0, 170.0, 210.0}, {238.0, 238.0, 238.0}, {235.0, 150.0, 110.0}, {170.0, 20.0, 40.0}}};
  return between(fixed, count);
}

}  // namespace tchat
