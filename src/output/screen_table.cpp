#include "output/screen_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hybrid/parameter_vector.hpp"
#include "output/number_format.hpp"
#include "start/point_type.hpp"

namespace tchat {

namespace {

constexpr std::size_t most_columns = 7;
constexpr int column_width = 14;

bool is_free_parameter(const PointColumn& column) {
  return column.kind == PointColumn::Kind::parameter && column.index < first_duration;
}

/// The first seven; where that would cut off free parameters, these instead of the last maxima.
std::vector<std::size_t> shown(const std::vector<PointColumn>& columns) {
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < columns.size(); ++k) chosen.push_back(k);
  const auto last_maximum = [&] {
    return std::find_if(chosen.rbegin(), chosen.rend(),
                        [&](std::size_t k) { return columns[k].kind == PointColumn::Kind::maximum; });
  };
  const auto cuts_off = [&] {
    return std::any_of(chosen.begin() + std::min(chosen.size(), most_columns), chosen.end(),
                       [&](std::size_t k) { return is_free_parameter(columns[k]); });
  };
  while (cuts_off() && last_maximum() != chosen.rend()) chosen.erase(std::next(last_maximum()).base());
  chosen.resize(std::min(chosen.size(), most_columns));
  return chosen;
}

}  // namespace

std::string format_table_heading(const std::vector<PointColumn>& columns) {
  std::string line = "  BR    PT  TY  LAB";
  for (const std::size_t k : shown(columns)) line += heading_field(columns[k].name, column_width);
  return line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
}

std::string format_table_line(const PointLine& point, const std::vector<PointColumn>& columns) {
  const int number = wrapped_point(point.point);
  const bool shows_type = basic_type(point.type) != static_cast<int>(PointType::regular);
  std::string line = fmt::format("{:>4}", point.branch) + integer_field(point.stable ? -number : number, 6) +
                     fmt::format("{:>4}", shows_type ? type_name(point.type, point.kind) : "") +
                     integer_field(point.label, 5);
  for (const std::size_t k : shown(columns)) line += fmt::format("{:>{}.5E}", finite(point.values[k]), column_width);
  if (!point.admissible) line += "  inadmissible";
  return line + '\n';
}

}  // namespace tchat
