#include "plot/sweep_columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string_view>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "base/words.hpp"
#include "plot/column_expression.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

constexpr std::string_view later = "@+";

/// Length of "@+K" at the beginning of the text; 0: there is none.
std::size_t length_of_shift(std::string_view text) {
  if (!text.starts_with(later)) return 0;
  const std::size_t end = std::min(text.find_first_not_of("0123456789", later.size()), text.size());
  return end > later.size() ? end : 0;
}

class SweepNames {
 public:
  SweepNames(const SweepTable& table, const std::string& path, const std::string& wanted, const char* option)
      : table_(table), where_(fmt::format("{}: {} {}", path, option, in_quotes(wanted))) {
    names_ = table.names;
    names_.emplace_back("kind");
    for (const auto& [name, value] : table.parameters) names_.push_back(name);
  }

  const std::string& where() const { return where_; }

  KnownNames known() const {
    return {[this](std::string_view text) { return length(text); }, fmt::format("{}", fmt::join(names_, ", "))};
  }

  /// A name, or a name and a shift.
  SweepQuantity named(const std::string& text) const {
    const std::size_t at = text.find(later);
    const std::string name = text.substr(0, at);
    SweepQuantity quantity = column(name);
    if (at == std::string::npos) return quantity;
    const int rows = parse_integer(text.substr(at + later.size())).value_or(0);
    shift(quantity.values, static_cast<std::size_t>(std::max(rows, 0)));
    quantity.errors.clear();
    quantity.label =
        joined(quantity.label, rows == 1 ? plain_text(", next") : plain_text(fmt::format(", {} later", rows)));
    return quantity;
  }

 private:
  /// Of the longest name that the text begins with, a shift behind it included.
  std::size_t length(std::string_view text) const {
    const std::size_t longest = length_of_name(text, names_);
    return longest > 0 ? longest + length_of_shift(text.substr(longest)) : 0;
  }

  SweepQuantity column(const std::string& wanted) const {
    SweepQuantity quantity;
    const std::string name = sweep_column(table_, wanted);
    if (const std::vector<double>* values = table_.column(name)) {
      quantity.values = *values;
      if (name.starts_with("lambda"))
        if (const auto* errors = table_.column("error" + name.substr(6))) quantity.errors = *errors;
      quantity.label = mathematical_name(name);
      for (const SweptQuantity& swept : table_.over)
        if (swept.is_state && swept.column() == name)
          quantity.label = joined(mathematical_name(swept.name), plain_text("(0)"));
      return quantity;
    }
    if (same_letters(wanted, "kind")) {
      for (const AttractorKind kind : table_.kinds) quantity.values.push_back(static_cast<double>(kind));
      quantity.label = plain_text("kind");
      return quantity;
    }
    for (const auto& [parameter, value] : table_.parameters)
      if (same_letters(parameter, wanted)) {
        quantity.values.assign(table_.rows(), value);
        quantity.label = mathematical_name(parameter);
        return quantity;
      }
    throw UserError(fmt::format("{}: there is no column of that name; there are {}", where_, fmt::join(names_, ", ")));
  }

  /// Rows of one value and one start follow one another in the order of time.
  void shift(std::vector<double>& values, std::size_t rows) const {
    const std::vector<double>* index = table_.column("index");
    const std::vector<double>* start = table_.column("start");
    for (std::size_t k = 0; k < values.size(); ++k) {
      const std::size_t other = k + rows;
      const bool same = other < values.size() && (index == nullptr || (*index)[other] == (*index)[k]) &&
                        (start == nullptr || (*start)[other] == (*start)[k]);
      values[k] = same ? values[other] : std::numeric_limits<double>::quiet_NaN();
    }
  }

  const SweepTable& table_;
  std::string where_;
  std::vector<std::string> names_;
};

/// The swept value nearest to the one asked for.
double nearest(const SweptQuantity& swept, const SweepChoice& choice, const std::string& path,
               std::vector<std::string>& warnings) {
  const auto [low, high] = std::minmax(swept.from, swept.to);
  const double step = swept.count > 1 ? (high - low) / static_cast<double>(swept.count - 1) : 0.0;
  if (!(choice.value >= low - 0.5 * step && choice.value <= high + 0.5 * step))
    throw UserError(fmt::format("--at {}={:g}: {} goes from {:g} to {:g} in {}", choice.column, choice.value,
                                choice.column, swept.from, swept.to, path));
  double best = swept.value(0);
  for (long i = 1; i < swept.count; ++i)
    if (std::abs(swept.value(i) - choice.value) < std::abs(best - choice.value)) best = swept.value(i);
  if (std::abs(best - choice.value) > level::orbit * std::max({std::abs(low), std::abs(high), step}))
    warnings.push_back(
        fmt::format("{}: the value of {} nearest to {:.12g} is {:.12g}", path, choice.column, choice.value, best));
  return best;
}

}  // namespace

SweepQuantity read_sweep_quantity(const SweepTable& table, const std::string& path, const std::string& wanted,
                                  const char* option) {
  const SweepNames names(table, path, wanted, option);
  const KnownNames known = names.known();
  if (known.length(wanted) == wanted.size() || !looks_like_expression(wanted)) return names.named(wanted);
  const ColumnExpression expression = parse_expression(wanted, known, names.where());
  std::vector<SweepQuantity> parts;
  for (const std::string& name : expression.names) parts.push_back(names.named(name));
  std::vector<std::vector<double>> rows(table.rows());
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (const SweepQuantity& part : parts) rows[k].push_back(part.values[k]);
  SweepQuantity result;
  result.values = evaluate(expression, rows, names.where());
  result.label = expression_label(wanted, known, [&names](const std::string& name) { return names.named(name).label; });
  return result;
}

std::string sweep_column(const SweepTable& table, const std::string& wanted) {
  for (const std::string& name : table.names)
    if (name == wanted) return name;
  for (const std::string& name : table.names)
    if (same_letters(name, wanted)) return name;
  return "";
}

const SweptQuantity* swept_quantity(const SweepTable& table, const std::string& column) {
  for (const SweptQuantity& swept : table.over)
    if (swept.column() == column) return &swept;
  return nullptr;
}

std::vector<std::string> sweep_states(const SweepTable& table) {
  constexpr std::array<std::string_view, 8> scalars = {"index",  "start", "attractor", "event",
                                                       "period", "time",  "impacts",   "penetration"};
  std::vector<std::string> states;
  for (const std::string& name : table.names) {
    const bool scalar =
        std::find(scalars.begin(), scalars.end(), name) != scalars.end() || swept_quantity(table, name) != nullptr;
    const bool exponent = name.starts_with("lambda") || name.starts_with("error");
    if (!scalar && !exponent && !is_largest_value_column(name)) states.push_back(name);
  }
  return states;
}

SweepChoice read_sweep_choice(const std::string& text) {
  const std::size_t sign = text.find('=');
  const auto value = sign == std::string::npos ? std::nullopt : parse_real(text.substr(sign + 1));
  if (sign == 0 || !value || !std::isfinite(*value))
    throw UserError(fmt::format("--at {}: a choice is a column and its value, as in --at mu=-0.8 or --at start=2",
                                in_quotes(text)));
  return {text.substr(0, sign), *value};
}

std::vector<std::size_t> chosen_rows(const SweepTable& table, const std::string& path,
                                     const std::vector<SweepChoice>& choices, std::vector<std::string>& warnings) {
  std::vector<std::size_t> rows(table.rows());
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = k;
  for (const SweepChoice& choice : choices) {
    const std::string name = sweep_column(table, choice.column);
    const std::vector<double>* column = table.column(name);
    if (column == nullptr)
      throw UserError(fmt::format("--at {}={:g}: {} has no column of that name; there are {}", choice.column,
                                  choice.value, path, fmt::join(table.names, ", ")));
    const SweptQuantity* swept = swept_quantity(table, name);
    const double value = swept != nullptr ? nearest(*swept, choice, path, warnings) : choice.value;
    // Columns are numbers of a text: equal to what the sweep says of its values but for their last digits.
    const double slack = swept != nullptr ? level::orbit * std::max(std::abs(swept->from), std::abs(swept->to)) : 0.0;
    std::erase_if(rows, [&](std::size_t k) { return !(std::abs((*column)[k] - value) <= slack); });
    if (rows.empty())
      throw UserError(
          fmt::format("--at {}={:g}: no row of {} has this {}", choice.column, choice.value, path, choice.column));
  }
  return rows;
}

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
  if (!(range.high - range.low > level::differences * std::max(std::abs(range.low), std::abs(range.high)))) {
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
