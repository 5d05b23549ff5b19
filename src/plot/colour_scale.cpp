#include "plot/colour_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tchat {

namespace {

template <std::size_t N>
Palette equally_spaced(const std::array<const char*, N>& colours, double low, double high) {
  Palette palette;
  for (std::size_t k = 0; k < N; ++k)
    palette.stops.emplace_back(low + (high - low) * static_cast<double>(k) / (N - 1), colours[k]);
  return palette;
}

std::string mixed(const std::string& first, const std::string& second, double part) {
  std::string result = "#";
  for (std::size_t k = 1; k + 1 < first.size(); k += 2) {
    const int a = std::stoi(first.substr(k, 2), nullptr, 16), b = std::stoi(second.substr(k, 2), nullptr, 16);
    result += fmt::format("{:02x}", std::lround((1.0 - part) * a + part * b));
  }
  return result;
}

/// The part of a palette from low to high.
Palette cut(const Palette& palette, double low, double high) {
  Palette result{{{low, colour_at(palette, low)}}};
  for (const auto& stop : palette.stops)
    if (stop.first > low && stop.first < high) result.stops.push_back(stop);
  result.stops.emplace_back(high, colour_at(palette, high));
  return result;
}

}  // namespace

Palette scale_palette(double low, double high) {
  constexpr std::array rising = {"#440154", "#414487", "#2a788e", "#22a884", "#7ad151", "#fde725"};
  constexpr std::array both_signs = {"#2150a0", "#78aad2", "#eeeeee", "#eb966e", "#aa1428"};
  const double size = std::max(std::abs(low), std::abs(high));
  const bool has_both_signs = low < 0.0 && high > 0.0 && std::min(-low, high) > 0.02 * size;
  return has_both_signs ? cut(equally_spaced(both_signs, -size, size), low, high) : equally_spaced(rising, low, high);
}

Palette cyclic_palette() {
  // Hues of the plane (a, b) of Oklab [Ottosson 2020] at lightness 0.64 and chroma 0.115.
  constexpr std::array hues = {"#5590d0", "#8183d0", "#a477bf", "#bb6fa0", "#c76d79", "#c67352", "#b77f31",
                               "#9a8e2f", "#729b4e", "#3ca276", "#00a29e", "#139bbe", "#5590d0"};
  return equally_spaced(hues, 0.0, 1.0);
}

Palette category_palette(const std::vector<std::string>& colours) {
  Palette palette;
  palette.has_bar = false;
  for (std::size_t k = 0; k < colours.size(); ++k)
    for (const double edge : {-0.5, 0.5}) palette.stops.emplace_back(static_cast<double>(k) + edge, colours[k]);
  return palette;
}

std::string colour_at(const Palette& palette, double number) {
  const auto next = std::find_if(palette.stops.begin() + 1, palette.stops.end() - 1,
                                 [number](const auto& stop) { return stop.first >= number; });
  const auto& [begin, colour] = *(next - 1);
  return mixed(colour, next->second, (number - begin) / (next->first - begin));
}

}  // namespace tchat
