#include "plot/sweep_colours.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "base/user_error.hpp"
#include "plot/colour_scale.hpp"
#include "plot/picture_styles.hpp"

namespace tchat {

namespace {

constexpr std::size_t most_categories = 11;  // black is left for what is none of them
constexpr double no_colour = std::numeric_limits<double>::quiet_NaN();
constexpr const char* others_colour = "#909090";
constexpr const char* nothing_colour = "#e4e4e4";

std::string kind_colour(AttractorKind kind) {
  static const std::map<AttractorKind, const char*> colours = {
      {AttractorKind::periodic, "#0060a8"},   {AttractorKind::quasi_periodic, "#3a9a4a"},
      {AttractorKind::chaotic, "#c04000"},    {AttractorKind::rest, "#9a5aa0"},
      {AttractorKind::chattering, "#d09a00"}, {AttractorKind::escape, "#000000"}};
  const auto found = colours.find(kind);
  return found != colours.end() ? found->second : nothing_colour;
}

std::string attractor_name(const SweepTable& table, int number) {
  for (const SweepAttractor& attractor : table.attractors) {
    if (attractor.number != number) continue;
    if (attractor.kind != AttractorKind::periodic) return fmt::format("{}: {}", number, to_string(attractor.kind));
    return fmt::format("{}: {} impact{}, period {:.4g}", number, attractor.impacts, attractor.impacts == 1 ? "" : "s",
                       attractor.period);
  }
  return fmt::format("{}", number);
}

/// Names and colours of a column's numbers.
class Categories {
 public:
  Categories(const SweepTable& table, const std::string& column) : table_(table), column_(column) {}

  bool is_nothing(double value) const {
    if (column_ == "attractor") return !(value > 0.0);
    return column_ == "period" || column_ == "impacts" ? !(value >= 0.0) : !std::isfinite(value);
  }

  std::string name(double value) const {
    const int number = static_cast<int>(std::lround(value));
    if (column_ == "kind") return to_string(static_cast<AttractorKind>(number));
    if (column_ == "attractor") return attractor_name(table_, number);
    if (column_ == "period") return fmt::format("period {}", number);
    if (column_ == "impacts") return fmt::format("{} impact{}", number, number == 1 ? "" : "s");
    if (column_ == "event") return fmt::format("event {}", number);
    return start_name(table_, number);
  }

  std::string name_of_nothing() const {
    return column_ == "period" || column_ == "impacts" ? "not periodic" : "no attractor";
  }

  std::string colour(double value, std::size_t place) const {
    if (column_ == "kind") return kind_colour(static_cast<AttractorKind>(std::lround(value)));
    return series_colour(place + 1);
  }

  /// By number, where the larger ones are the rarer; attractors by how much they attract.
  std::vector<double> shown(const std::map<double, std::size_t>& counts) const {
    std::vector<double> values;
    for (const auto& [value, count] : counts) values.push_back(value);
    if (values.size() <= most_categories) return values;
    if (column_ == "attractor")
      std::stable_sort(values.begin(), values.end(),
                       [&counts](double a, double b) { return counts.at(a) > counts.at(b); });
    values.resize(most_categories);
    std::sort(values.begin(), values.end());
    return values;
  }

 private:
  const SweepTable& table_;
  const std::string& column_;
};

RowColours category_colours(const SweepTable& table, const std::string& column, const std::vector<double>& values,
                            const std::vector<std::size_t>& rows) {
  const Categories categories(table, column);
  std::map<double, std::size_t> counts;
  bool has_nothing = false;
  for (const std::size_t row : rows) {
    if (categories.is_nothing(values[row]))
      has_nothing = true;
    else
      ++counts[values[row]];
  }
  RowColours result;
  std::map<double, double> number;
  for (const double value : categories.shown(counts)) {
    number[value] = static_cast<double>(result.colours.size());
    result.colours.push_back(categories.colour(value, result.colours.size()));
    result.names.push_back(plain_text(categories.name(value)));
  }
  const auto add = [&result](const char* colour, const std::string& name) {
    result.colours.emplace_back(colour);
    result.names.push_back(plain_text(name));
    return static_cast<double>(result.colours.size()) - 1.0;
  };
  const double others = number.size() < counts.size() ? add(others_colour, "others") : no_colour;
  const double nothing = has_nothing ? add(nothing_colour, categories.name_of_nothing()) : no_colour;
  result.palette = category_palette(result.colours);
  for (const std::size_t row : rows) {
    const auto found = number.find(values[row]);
    result.numbers.push_back(categories.is_nothing(values[row]) ? nothing
                             : found != number.end()            ? found->second
                                                                : others);
  }
  return result;
}

struct NumberRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

RowColours scale_of_colours(const std::string& path, const ColourWish& wish, const SweepQuantity& quantity,
                            const std::vector<std::size_t>& rows) {
  NumberRange range;
  for (const std::size_t row : rows)
    if (const double value = quantity.values[row]; std::isfinite(value))
      range.low = std::min(range.low, value), range.high = std::max(range.high, value);
  if (!(range.low <= range.high) && !(wish.low && wish.high))
    throw UserError(fmt::format("{}: -z '{}' is nowhere a number", path, wish.column));
  range = {wish.low.value_or(range.low), wish.high.value_or(range.high)};
  if (!(range.high - range.low > 1e-8 * std::max(std::abs(range.low), std::abs(range.high)))) {
    const double half = std::max(0.05 * std::abs(range.low), 1e-12);
    range = {range.low - half, range.low + half};
  }
  RowColours result;
  result.palette = scale_palette(range.low, range.high);
  result.palette.label = wish.label.empty() ? quantity.label : wish.label;
  for (const std::size_t row : rows) result.numbers.push_back(quantity.values[row]);
  return result;
}

}  // namespace

std::string start_name(const SweepTable& table, int number) {
  const auto k = static_cast<std::size_t>(std::max(number, 1) - 1);
  for (const char* direction : {"up", "down"})
    if (k < table.starts.size() && table.starts[k].starts_with(direction)) return direction;
  return fmt::format("start {}", number);
}

bool is_category(const SweepTable& table, const std::string& column) {
  constexpr std::array<std::string_view, 5> categories = {"attractor", "period", "impacts", "start", "event"};
  const std::string name = sweep_column(table, column);
  return column == "kind" || std::find(categories.begin(), categories.end(), name) != categories.end();
}

RowColours row_colours(const SweepTable& table, const std::string& path, const ColourWish& wish,
                       const std::vector<std::size_t>& rows) {
  const SweepQuantity quantity = read_sweep_quantity(table, path, wish.column, "-z");
  if (!is_category(table, wish.column)) return scale_of_colours(path, wish, quantity, rows);
  const std::string name = sweep_column(table, wish.column);
  return category_colours(table, name.empty() ? wish.column : name, quantity.values, rows);
}

}  // namespace tchat
