#include "plot/figure.hpp"

#include <fmt/format.h>
#include <fmt/printf.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>

#include "base/levels.hpp"
#include "base/messages.hpp"

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

namespace {

/// The first ones differ in hue and in lightness, those of the kinds of curve are among them.
constexpr std::array<const char*, 12> colours = {"#000000", "#0060a8", "#c04000", "#3a9a4a", "#9a5aa0", "#d09a00",
                                                 "#50b8e8", "#e060a0", "#7a4420", "#008a8a", "#8a9a20", "#8888d8"};

/// A third of the way to white.
std::string paler(const std::string& colour) {
  std::string result = "#";
  for (std::size_t k = 1; k + 1 < colour.size(); k += 2)
    result += fmt::format("{:02x}", (2 * std::stoi(colour.substr(k, 2), nullptr, 16) + 255) / 3);
  return result;
}

}  // namespace

std::string cloud_colour(std::size_t k) {
  constexpr std::array<const char*, 4> pale = {"#a8a8a8", "#8ab8e0", "#e8b088", "#9cd0a4"};
  return pale[k % pale.size()];
}

Marker cloud_marker(const std::string& colour) { return {{}, Symbol::dot, true, 0.5, colour}; }

std::string series_colour(std::size_t k) { return colours[k % colours.size()]; }

Symbol series_symbol(std::size_t k) {
  constexpr std::array<Symbol, 5> symbols = {Symbol::circle, Symbol::square, Symbol::triangle, Symbol::diamond,
                                             Symbol::reversed_triangle};
  return symbols[k % symbols.size()];
}

Stroke line_stroke(LineKind kind, const std::string& colour, double width) {
  switch (kind) {
    case LineKind::stable:
      return {Dash::solid, width, colour};
    case LineKind::unstable:
      return {Dash::dashed, 0.75 * width, colour};
    default:
      return {Dash::dotted, 0.8 * width, paler(colour)};
  }
}

Stroke jump_stroke(const std::string& colour) { return {Dash::solid, 1.3, paler(colour)}; }

std::vector<KeyEntry> line_kind_entries(const std::set<LineKind>& kinds, const std::string& colour, double width) {
  const auto name = [](LineKind kind) {
    return kind == LineKind::stable ? "stable" : kind == LineKind::unstable ? "unstable" : "inadmissible";
  };
  std::vector<KeyEntry> entries;
  for (const LineKind kind : kinds)
    entries.push_back({plain_text(name(kind)), line_stroke(kind, colour, width), std::nullopt});
  return entries;
}

Marker special_point_marker(const std::string& type, const PicturePoint& at) {
  const PointTypeFacts* const facts = find_point_type(type);
  Marker marker;
  marker.at = at;
  marker.symbol = facts != nullptr ? facts->symbol : Symbol::dot;
  marker.filled = facts == nullptr || facts->is_filled;
  marker.one_of_many = type == "XI";
  marker.size = marker.one_of_many ? 0.8 : 1.0;
  marker.label = plain_text(type);
  return marker;
}

bool is_labelled_by_default(const std::string& type) {
  const PointTypeFacts* const facts = find_point_type(type);
  return facts != nullptr && facts->is_labelled;
}

std::vector<std::string> all_point_types() {
  std::vector<std::string> types;
  for (const PointTypeFacts& row : point_types())
    if (types.empty() || types.back() != row.name) types.emplace_back(row.name);
  return types;
}

CurveKind curve_kind(const std::string& letters, bool grazing) {
  if (grazing) return {"grazing", "#000000", Symbol::circle, false};
  static const std::map<std::string, CurveKind> kinds{
      {"LP", {"fold", "#0060a8", Symbol::square, true}},
      {"PD", {"period doubling", "#c04000", Symbol::triangle, true}},
      {"TR", {"torus", "#3a9a4a", Symbol::diamond, true}},
      {"GR", {"two events at once", "#008080", Symbol::circle, false}},
      {"BE", {"boundary equilibrium", "#008080", Symbol::pentagon, false}},
      {"HB", {"Hopf", "#9a5aa0", Symbol::reversed_triangle, true}},
      {"BP", {"branch points", "#7a4420", Symbol::pentagon, true}},
  };
  const auto known = kinds.find(letters);
  return known != kinds.end() ? known->second : CurveKind{"two-parameter curve", "#000000", Symbol::dot, true};
}

std::string unused_colour(const std::vector<CurveKind>& curves, std::size_t k) {
  std::vector<std::string> unused;
  for (const char* colour : colours)
    if (std::none_of(curves.begin(), curves.end(), [colour](const CurveKind& curve) { return curve.colour == colour; }))
      unused.emplace_back(colour);
  return unused.empty() ? series_colour(k) : unused[k % unused.size()];
}

std::vector<CurveKind> with_own_colours(std::vector<CurveKind> kinds) {
  std::vector<CurveKind> first_ones;
  const auto is_first = [&first_ones](const CurveKind& kind) {
    return std::none_of(first_ones.begin(), first_ones.end(),
                        [&kind](const CurveKind& other) { return other.name == kind.name; });
  };
  std::vector<CurveKind*> further;
  for (CurveKind& kind : kinds) {
    if (is_first(kind))
      first_ones.push_back(kind);
    else
      further.push_back(&kind);
  }
  for (std::size_t k = 0; k < further.size(); ++k) further[k]->colour = unused_colour(first_ones, k);
  return kinds;
}

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

namespace {

constexpr double infinity_in_files = 1e90;
constexpr double margin = 0.04;
/// Ends that differ by less than this part of their size are equal in a script.
constexpr double narrowest = level::differences;

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  bool is_empty() const { return !(low <= high); }
};

Range range_of(const std::vector<double>& values, bool positive) {
  Range range;
  for (const double value : values) {
    if (!can_be_shown(value) || (positive && value <= 0.0)) continue;
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
  }
  return range;
}

/// Wider than the data; a constant, up to rounding, gets a range around it.
Range widened(Range range) {
  const double size = std::max(std::abs(range.low), std::abs(range.high));
  const double span = range.high - range.low;
  if (span <= narrowest * size || span == 0.0) {
    const double half = size > 0.0 ? 0.05 * size : 1.0;
    return {range.low - half, range.high + half};
  }
  return {range.low - margin * span, range.high + margin * span};
}

bool is_narrow(double low, double high) { return high - low <= narrowest * std::max(std::abs(low), std::abs(high)); }

/// Ranges that the user has given, of which gnuplot would make an error.
void refuse_range(const AxisSettings& settings) {
  for (const std::optional<double>& end : {settings.low, settings.high})
    if (end && !can_be_shown(*end))
      throw UserError(fmt::format("a range that ends at {:g} cannot be drawn; its ends are between {:g} and {:g}", *end,
                                  -infinity_in_files, infinity_in_files));
  if (settings.low && settings.high && is_narrow(*settings.low, *settings.high))
    throw UserError(
        fmt::format("the range {:.17g}:{:.17g} is too narrow to be drawn; its ends must differ by more than "
                    "{:g} of their size",
                    *settings.low, *settings.high, narrowest));
}

/// The smallest of 1, 2, 5 times a power of ten that goes into the range at most so many times.
double round_step(double span, int most) {
  const double power = std::pow(10.0, std::floor(std::log10(span / most)));
  for (const double leading : {1.0, 2.0, 5.0})
    if (span <= leading * power * most) return leading * power;
  return 10.0 * power;
}

void set_linear_tics(AxisScale& scale, int most) {
  const double largest = std::max(std::abs(scale.low), std::abs(scale.high));
  scale.tic_step = round_step(scale.high - scale.low, most);
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(scale.tic_step) + level::negligible)));
  scale.format = largest >= 1e6 || largest < 1e-4 ? "%g" : fmt::format("%.{}f", decimals);
  scale.widest_number = 0.0;
  for (const double tic : {std::ceil(scale.low / scale.tic_step), std::floor(scale.high / scale.tic_step)})
    scale.widest_number =
        std::max(scale.widest_number, text_width(plain_text(fmt::sprintf(scale.format, tic * scale.tic_step))));
}

}  // namespace

bool can_be_shown(double value) { return std::isfinite(value) && std::abs(value) < infinity_in_files; }

double AxisScale::fraction(double value) const {
  if (!can_be_shown(value) || (logarithmic && value <= 0.0)) return std::numeric_limits<double>::quiet_NaN();
  if (logarithmic) return std::log(value / low) / std::log(high / low);
  return (value - low) / (high - low);
}

AxisScale choose_scale(const AxisSettings& settings, const std::vector<double>& values, int most_steps) {
  AxisScale scale;
  scale.logarithmic = settings.logarithmic;
  Range range = range_of(values, settings.logarithmic);
  if (settings.logarithmic) {
    if (range.is_empty() && !(settings.low && settings.high))
      throw UserError("a logarithmic axis can show positive values only, and there are none; leave --logx, --logy out");
    if (!range.is_empty()) {
      const double factor = range.high > range.low ? std::pow(range.high / range.low, margin) : 2.0;
      range = {range.low / factor, range.high * factor};
    }
    if ((settings.low && *settings.low <= 0.0) || (settings.high && *settings.high <= 0.0))
      throw UserError("the range of a logarithmic axis must be positive, as in --xrange 0.1:10");
  } else if (!range.is_empty()) {
    range = widened(range);
  } else {
    range = {0.0, 1.0};
  }
  refuse_range(settings);
  scale.low = settings.low.value_or(range.low);
  scale.high = settings.high.value_or(range.high);
  if (!settings.high && is_narrow(scale.low, scale.high)) scale.high = scale.low + std::max(1.0, std::abs(scale.low));
  if (!settings.low && is_narrow(scale.low, scale.high))
    scale.low = settings.logarithmic ? scale.high / 10.0 : scale.high - std::max(1.0, std::abs(scale.high));
  if (scale.logarithmic) {
    scale.format = "10^{%L}";
    scale.widest_number = 2.5;
  } else {
    set_linear_tics(scale, most_steps);
  }
  return scale;
}

}  // namespace tchat
