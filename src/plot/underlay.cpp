#include "plot/underlay.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>
#include <utility>

#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "files/point_file_reader.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

constexpr std::size_t least_of_point_file = 5;  // a header line of limits, or BR PT TY LAB and one value

bool is_row(const std::string& line) {
  const auto words = split_words(line);
  if (words.size() < 2 || (words.size() >= least_of_point_file && looks_like_point_file(line))) return false;
  return std::all_of(words.begin(), words.end(), [](std::string_view word) { return parse_real(word).has_value(); });
}

bool is_comment(const std::string& line) {
  const auto first = line.find_first_not_of(" \t\r");
  return first == std::string::npos || line[first] == '#';
}

}  // namespace

bool looks_like_data(const std::string& path) {
  TextLines file(path, "something to draw");
  for (std::string line; file.next(line);)
    if (!is_comment(line)) return is_row(line);
  return false;
}

DataFile read_data_file(const std::string& path) {
  std::istringstream in(read_text_file(path, "a table of numbers", "two columns are drawn as dots"));
  DataFile data;
  data.path = path;
  data.name = std::filesystem::path(path).stem().string();
  std::string heading;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (is_comment(line)) {
      if (data.points.empty() && line.find('#') != std::string::npos) heading = line.substr(line.find('#') + 1);
      continue;
    }
    const auto words = split_words(line);
    const auto x = words.size() < 2 ? std::nullopt : parse_real(words[0]);
    const auto y = words.size() < 2 ? std::nullopt : parse_real(words[1]);
    if (!x || !y)
      throw UserError(fmt::format("{}:{}: found '{}', expected two numbers or more; the first two columns are drawn",
                                  path, number, line));
    if (const auto names = split_words(heading); data.points.empty() && names.size() == words.size())
      data.x_name = names[0], data.y_name = names[1];
    data.points.push_back({*x, *y});
  }
  if (data.points.empty()) throw UserError(fmt::format("{}: there are no numbers in it", path));
  return data;
}

namespace {

/// Commas inside parentheses belong to functions.
std::vector<std::string> split_list(const std::string& text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : text) {
    depth += (c == '(') - (c == ')');
    if (c == ',' && depth == 0)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

double dot_size(std::size_t dots) { return dots > 40000 ? 0.2 : dots > 10000 ? 0.3 : dots > 4000 ? 0.4 : 0.5; }

/// Of groups whose dots may lie on each other: the earlier ones are seen around the later ones.
constexpr double larger_beneath = 1.7;

/// Few dots that lie beneath a line are seen at both sides of it, a handful from afar.
double larger_beneath_lines(std::size_t dots) { return dots > 1000 ? 1.0 : dots > 30 ? 1.8 : 3.0; }

/// Dots that share a colour.
struct Group {
  LabelText name;
  std::string colour;
  std::vector<bool> member;          // by place among the chosen rows
  double size = 1.0;                 // of its dots, beside the usual one
  std::vector<double> numbers = {};  // of the dots in the palette, likewise, where that is the colour
};

class SweepLayerBuilder {
 public:
  SweepLayerBuilder(const SweepFile& file, const SweepLook& look, std::vector<std::string>& warnings)
      : file_(file), table_(file.table), look_(look), warnings_(warnings) {
    if (table_.over.empty() || table_.rows() == 0)
      throw UserError(fmt::format("{}: there is nothing in it to draw", file_.path));
    rows_ = chosen_rows(table_, file_.path, look_.choices, warnings_);
    x_ = look_.x.empty() ? default_x() : look_.x;
    y_ = look_.y.empty() ? default_y() : look_.y;
  }

  Underlay build() {
    const SweptQuantity* across = swept_quantity(table_, sweep_column(table_, x_));
    const SweptQuantity* up = swept_quantity(table_, sweep_column(table_, y_));
    if (across != nullptr && up != nullptr && across != up)
      map(*across, *up);
    else
      dots();
    return std::move(result_);
  }

 private:
  bool is_chosen(const SweptQuantity& quantity) const {
    return std::any_of(look_.choices.begin(), look_.choices.end(), [&](const SweepChoice& choice) {
      return sweep_column(table_, choice.column) == quantity.column();
    });
  }

  /// The first one that --at has left free.
  std::string default_x() const {
    for (const SweptQuantity& quantity : table_.over)
      if (!is_chosen(quantity)) return quantity.column();
    const std::vector<std::string> states = sweep_states(table_);
    return states.size() > 1 ? states.front() : table_.over.front().column();
  }

  std::string default_y() const {
    const std::string x = sweep_column(table_, x_);
    for (const SweptQuantity& quantity : table_.over)
      if (swept_quantity(table_, x) != nullptr && quantity.column() != x && !is_chosen(quantity))
        return quantity.column();
    return default_sweep_y(table_, x);
  }

  // Dots -----------------------------------------------------------------------------------------------------------

  void dots() {
    const SweepQuantity x = read_sweep_quantity(table_, file_.path, x_, "-x");
    const std::vector<std::string> list = split_list(y_);
    std::vector<SweepQuantity> quantities;
    for (const std::string& name : list) quantities.push_back(read_sweep_quantity(table_, file_.path, name, "-y"));
    result_.x = x.label;
    result_.y = common_label(quantities);
    const std::vector<Group> groups = make_groups();
    std::size_t shown = 0;
    if (std::any_of(quantities.begin(), quantities.end(), [](const SweepQuantity& y) { return !y.errors.empty(); }))
      add_zero_line(x);
    for (const SweepQuantity& y : quantities) {
      for (const Group& group : groups) {
        const bool own_name = quantities.size() > 1;
        const std::string colour =
            own_name || group.colour.empty() ? next_colour(quantities.size() * groups.size() == 1) : group.colour;
        const LabelText name = !own_name           ? group.name
                               : groups.size() > 1 ? joined(joined(y.label, plain_text(", ")), group.name)
                                                   : y.label;
        shown += add_dots(x, y, group, colour, name);
      }
    }
    if (shown == 0)
      throw UserError(fmt::format("{}: {} over {} is nowhere a number: the sweep has found nothing there to draw",
                                  file_.path, y_, x_));
  }

  /// Of the first; of several exponents what they all are.
  static LabelText common_label(const std::vector<SweepQuantity>& quantities) {
    const bool exponents =
        std::all_of(quantities.begin(), quantities.end(), [](const auto& y) { return !y.errors.empty(); });
    return quantities.size() > 1 && exponents ? plain_text("Lyapunov exponents") : quantities.front().label;
  }

  /// Black is left to a lone cloud: it would hide what is beneath.
  std::string next_colour(bool alone) {
    const std::size_t k = look_.clouds_before + result_.clouds.size() + (alone || look_.beneath_branches ? 0 : 1);
    return look_.beneath_branches ? cloud_colour(k) : series_colour(k);
  }

  std::vector<Group> make_groups() {
    if (!look_.z.empty()) return coloured_groups(look_.z);
    if (look_.grey) return {Group{plain_text(file_.name), cloud_colour(0), std::vector<bool>(rows_.size(), true)}};
    const std::vector<double>* start = table_.column("start");
    std::vector<Group> groups;
    for (std::size_t k = 0; k < table_.starts.size() && start != nullptr; ++k) {
      const std::string name = start_name(table_, static_cast<int>(k) + 1);
      if (name != "up" && name != "down") return {everything()};
      Group group{plain_text(name), "", {}};
      for (const std::size_t row : rows_) group.member.push_back((*start)[row] == static_cast<double>(k + 1));
      const bool has_rows = std::find(group.member.begin(), group.member.end(), true) != group.member.end();
      if (has_rows) groups.push_back(std::move(group));
    }
    for (std::size_t k = 0; k + 1 < groups.size(); ++k) groups[k].size = larger_beneath;
    return groups.size() > 1 ? groups : std::vector<Group>{everything()};
  }

  Group everything() const { return {plain_text(file_.name), "", std::vector<bool>(rows_.size(), true)}; }

  std::vector<Group> coloured_groups(const std::string& column) {
    const RowColours colours =
        row_colours(table_, file_.path, {column, look_.z_low, look_.z_high, look_.z_label}, rows_);
    if (colours.colours.empty()) {
      result_.palette = colours.palette;
      return {{LabelText{}, "palette", std::vector<bool>(rows_.size(), true), 1.0, colours.numbers}};
    }
    std::vector<Group> groups;
    for (std::size_t c = 0; c < colours.colours.size(); ++c) {
      Group group{colours.names[c], colours.colours[c], {}};
      for (const double number : colours.numbers) group.member.push_back(number == static_cast<double>(c));
      groups.push_back(std::move(group));
    }
    return groups;
  }

  /// How many.
  std::size_t add_dots(const SweepQuantity& x, const SweepQuantity& y, const Group& group, const std::string& colour,
                       const LabelText& name) {
    Cloud cloud;
    cloud.colour = colour;
    cloud.rows.sweep = look_.sweep;
    const bool has_palette = colour == "palette";
    Curve bars{{}, {Dash::solid, 1.2, has_palette ? "#909090" : colour}};
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const PicturePoint at{x.values[rows_[k]], y.values[rows_[k]], has_palette ? group.numbers[k] : 0.0};
      if (!group.member[k] || !is_finite(at)) continue;
      // Quantities of a value stand in each of its rows.
      if (!cloud.points.empty() && cloud.points.back() == at) continue;
      cloud.points.push_back(at);
      cloud.rows.rows.emplace_back(rows_[k]);
      if (!y.errors.empty()) add_bar(bars, at, y.errors[rows_[k]]);
    }
    const std::size_t count = cloud.points.size();
    if (count == 0) return 0;
    cloud.size = group.size * dot_size(count);
    if (look_.beneath_branches) cloud.size *= larger_beneath_lines(count);
    if (!bars.points.empty()) result_.curves.push_back(std::move(bars));
    if (!name.empty()) result_.key.push_back({name, std::nullopt, Marker{{}, Symbol::dot, true, 0.9, colour}});
    result_.clouds.push_back(std::move(cloud));
    return count;
  }

  static void add_bar(Curve& bars, const PicturePoint& at, double error) {
    if (!std::isfinite(error) || error <= 0.0) return;
    constexpr double gap = std::numeric_limits<double>::quiet_NaN();
    bars.points.insert(bars.points.end(), {{at.x, at.y - error}, {at.x, at.y + error}, {gap, gap}});
  }

  void add_zero_line(const SweepQuantity& x) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const std::size_t row : rows_)
      if (std::isfinite(x.values[row])) low = std::min(low, x.values[row]), high = std::max(high, x.values[row]);
    if (low < high)
      result_.curves.push_back({{{low, 0.0}, {high, 0.0}}, {Dash::solid, 1.0, "#a0a0a0"}, /*background=*/true});
  }

  // Maps -----------------------------------------------------------------------------------------------------------

  void map(const SweptQuantity& across, const SweptQuantity& up) {
    keep_one_start();
    const std::string column = look_.z.empty() ? default_z() : look_.z;
    const RowColours colours =
        row_colours(table_, file_.path, {column, look_.z_low, look_.z_high, look_.z_label}, rows_);
    const std::vector<double>* index = table_.column("index");
    if (index == nullptr)
      throw UserError(fmt::format("{}: there is no column index, by which a map knows its cells", file_.path));
    ColourField field;
    field.columns = static_cast<std::size_t>(across.count);
    field.rows = static_cast<std::size_t>(up.count);
    field.first = {across.value(0), up.value(0)};
    field.last = {across.value(across.count - 1), up.value(up.count - 1)};
    field.cells.assign(field.columns * field.rows, std::numeric_limits<double>::quiet_NaN());
    field.sweep_rows.sweep = look_.sweep;
    field.sweep_rows.rows.assign(field.cells.size(), std::nullopt);
    const auto count = static_cast<std::size_t>(table_.over.front().count);
    const bool turned = &across != &table_.over.front();
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const auto number = static_cast<std::size_t>((*index)[rows_[k]]);
      const std::size_t first = number % count, second = number / count;
      const std::size_t cell = turned ? first * field.columns + second : second * field.columns + first;
      if (cell >= field.cells.size()) continue;
      field.cells[cell] = colours.numbers[k];
      field.sweep_rows.rows[cell] = rows_[k];
    }
    for (std::size_t c = 0; c < colours.names.size(); ++c) {
      const Marker square{{}, Symbol::square, true, 1.4, colours.colours[c]};
      result_.key.push_back({colours.names[c], std::nullopt, square});
    }
    result_.field = std::move(field);
    result_.palette = colours.palette;
    result_.x = read_sweep_quantity(table_, file_.path, x_, "-x").label;
    result_.y = read_sweep_quantity(table_, file_.path, y_, "-y").label;
  }

  std::string default_z() const {
    return table_.column("attractor") != nullptr && !table_.attractors.empty() ? "attractor" : "kind";
  }

  /// A cell has one colour.
  void keep_one_start() {
    const std::vector<double>* start = table_.column("start");
    if (start == nullptr) return;
    const double first = (*start)[rows_.front()];
    const std::size_t before = rows_.size();
    std::erase_if(rows_, [&](std::size_t row) { return (*start)[row] != first; });
    if (rows_.size() < before)
      warnings_.push_back(
          fmt::format("{}: the map shows start {:.0f}; --at start=N shows another one", file_.path, first));
  }

  const SweepFile& file_;
  const SweepTable& table_;
  const SweepLook& look_;
  std::vector<std::string>& warnings_;
  std::vector<std::size_t> rows_;
  std::string x_, y_;
  Underlay result_;
};

}  // namespace

bool looks_like_sweep(const std::string& path) {
  TextLines file(path, "something to draw");
  std::string line;
  return file.next(line) && line.starts_with("# tchat sweep");
}

SweepFile read_sweep(const std::string& path) {
  return {path, std::filesystem::path(path).stem().string(), read_sweep_file(path)};
}

void Underlay::add(Underlay other) {
  if (field && other.field) throw UserError("one panel shows one map: give the other sweep after --panel");
  if (palette && other.palette)
    throw UserError("one panel has one scale of colours: give the other sweep after --panel");
  if (other.field) field = std::move(other.field);
  if (other.palette) palette = std::move(other.palette);
  clouds.insert(clouds.end(), other.clouds.begin(), other.clouds.end());
  curves.insert(curves.end(), other.curves.begin(), other.curves.end());
  key.insert(key.end(), other.key.begin(), other.key.end());
  if (x.empty()) x = other.x;
  if (y.empty()) y = other.y;
}

std::string default_sweep_y(const SweepTable& table, const std::string& x) {
  if (table.column("penetration") != nullptr) return "penetration";  // it has been asked for
  for (const std::string& state : sweep_states(table))
    if (state != x) return state;
  if (table.column("lambda1") == nullptr) return table.column("period") != nullptr ? "period" : "attractor";
  std::string all = "lambda1";
  for (int k = 2; table.column(fmt::format("lambda{}", k)) != nullptr; ++k) all += fmt::format(",lambda{}", k);
  return all;
}

Underlay sweep_layer(const SweepFile& file, const SweepLook& look, std::vector<std::string>& warnings) {
  return SweepLayerBuilder(file, look, warnings).build();
}

}  // namespace tchat
