#include "output/screen_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "output/number_format.hpp"
#include "start/point_type.hpp"

namespace tchat {

namespace {

constexpr std::size_t most_columns = 7;
constexpr int column_width = 14;

}  // namespace

std::string format_table_heading(const std::vector<PointColumn>& columns) {
  std::string line = "  BR    PT  TY  LAB";
  for (std::size_t k = 0; k < std::min(columns.size(), most_columns); ++k)
    line += heading_field(columns[k].name, column_width);
  return line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
}

std::string format_table_line(const PointLine& point) {
  const int number = wrapped_point(point.point);
  const bool shows_type = basic_type(point.type) != static_cast<int>(PointType::regular);
  std::string line = fmt::format("{:>4}", point.branch) + integer_field(point.stable ? -number : number, 6) +
                     fmt::format("{:>4}", shows_type ? type_name(point.type, point.kind) : "") +
                     integer_field(point.label, 5);
  for (std::size_t k = 0; k < std::min(point.values.size(), most_columns); ++k)
    line += fmt::format("{:>{}.5E}", finite(point.values[k]), column_width);
  if (!point.admissible) line += "  inadmissible";
  return line + '\n';
}

}  // namespace tchat
