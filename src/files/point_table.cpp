#include "files/point_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "files/labelled_solution.hpp"
#include "files/number_format.hpp"
#include "settings/point_type.hpp"

namespace tchat {

namespace {

constexpr std::size_t most_columns = 5;
constexpr int column_width = 13;

bool is_of_duration(const PointColumn& column) { return column.segment > 0; }

/// What the screen shows first: 0 always, then in this order as far as there is room.
int rank(const PointColumn& column, std::size_t place) {
  using Kind = PointColumn::Kind;
  const bool is_parameter = column.kind == Kind::parameter;
  if (place == 0 || column.kind == Kind::period || (is_parameter && !is_of_duration(column))) return 0;
  if (place == 1) return 1;  // the solution measure
  if (column.kind == Kind::user_function) return 2;
  return is_of_duration(column) ? 4 : 3;
}

/// The columns shown, in the file's order.
std::vector<std::size_t> shown(const std::vector<PointColumn>& columns) {
  std::vector<std::size_t> chosen(columns.size());
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  std::stable_sort(chosen.begin(), chosen.end(),
                   [&](std::size_t a, std::size_t b) { return rank(columns[a], a) < rank(columns[b], b); });
  chosen.resize(std::min(chosen.size(), most_columns));
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace

std::string shown_name(const PointColumn& column) {
  return is_of_duration(column) ? fmt::format("T{}", column.segment) : column.name;
}

std::string format_table_heading(const std::vector<PointColumn>& columns) {
  std::string line = "  BR    PT  TY  LAB";
  for (const std::size_t k : shown(columns)) {
    const std::string heading = heading_field(shown_name(columns[k]), column_width);
    const bool touches = line.back() != ' ' && heading.front() != ' ';  // a long name in the first column
    line += touches ? " " + heading.substr(0, heading.size() - 1) : heading;
  }
  return line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
}

std::string format_table_line(const PointLine& point, const std::vector<PointColumn>& columns) {
  const bool shows_type = basic_type(point.type) != static_cast<int>(PointType::regular);
  std::string line;
  append_branch_and_point(line, point.branch, point.point, point.stable ? -1 : 1);
  line += fmt::format("{:>4}", shows_type ? type_name(point.type, point.kind) : "");
  append_integer_field(line, point.label, 5);
  for (const std::size_t k : shown(columns))
    line += fmt::format(" {:>{}.5E}", finite(point.values[k]), column_width - 1);
  if (!point.admissible) line += "  inadmissible";
  return line + '\n';
}

}  // namespace tchat
