#include "files/point_file.hpp"

#include <catch2/catch.hpp>
#include <vector>

using namespace tchat;

namespace {

std::vector<PointColumn> columns(const std::vector<std::string>& names) {
  std::vector<PointColumn> result;
  for (const std::string& name : names) result.push_back({PointColumn::Kind::parameter, 1, name});
  return result;
}

std::string line_of(const PointLine& point) {
  return format_table_line(point, columns(std::vector<std::string>(point.values.size(), "P")));
}

}  // namespace

TEST_CASE("The table on screen by hand", "[output]") {
  CHECK(format_table_heading(columns({"alpha", "L2-NORM", "a name that is too long"})) ==
        "  BR    PT  TY  LAB      alpha      L2-NORM  a name that\n");
  CHECK(line_of({1, 1, true, 9, 1, {3.0, -1.25}}) == "   1    -1  EP    1  3.00000E+00 -1.25000E+00\n");
  CHECK(line_of({1, 20, false, 4, 2, {1e-100}}) == "   1    20        2 1.00000E-100\n");
  CHECK(line_of({2, 3, false, 0, 0, {0.5}}) == "   2     3        0  5.00000E-01\n");
  CHECK(line_of({1, 7, false, 54, 3, {}}) == "   1     7        3\n");
}

TEST_CASE("Types in letters, GR and XI by what the point is", "[output]") {
  CHECK(line_of({1, 5, false, -4, 3, {}, {UserPointKind::contact, 1, 2, 0.5}}) == "   1     5  GR    3\n");
  CHECK(line_of({1, 5, false, -4, 3, {}, {UserPointKind::xi, 1, 2, 0.0}}) == "   1     5  XI    3\n");
  CHECK(line_of({1, 5, false, -54, 3, {}, {UserPointKind::user_value, 0, 2, 0.0}}) == "   1     5  UZ    3\n");
  CHECK(line_of({1, 5, false, -59, 3, {}}) == "   1     5  MX    3\n");
}

TEST_CASE("Inadmissible points are marked", "[output]") {
  CHECK(line_of({1, 5, false, 0, 0, {1.0}, {}, false}) == "   1     5        0  1.00000E+00  inadmissible\n");
}

TEST_CASE("At most five columns, so that a line fits 100 characters") {
  const std::string line = line_of({1, 5, false, 0, 0, std::vector<double>(12, 1.0), {}, false});
  CHECK(line == "   1     5        0  1.00000E+00  1.00000E+00  1.00000E+00  1.00000E+00  1.00000E+00  inadmissible\n");
  CHECK(line.size() <= 100);
  CHECK(format_table_heading(columns(std::vector<std::string>(12, "P"))).size() == 19 + 5 * 13 - 2 + 1);
}

TEST_CASE("Free parameters and the period are always shown, then the measure and maxima, durations are not",
          "[output]") {
  using Kind = PointColumn::Kind;
  std::vector<PointColumn> columns{{Kind::parameter, 2, "omega"},       {Kind::l2_norm, 0, "L2-NORM"},
                                   {Kind::maximum, 1, "MAX q1"},        {Kind::maximum, 2, "MAX v1"},
                                   {Kind::maximum, 3, "MAX q2"},        {Kind::parameter, 1, "a"},
                                   {Kind::parameter, 61, "PAR(61)", 1}, {Kind::period, 0, "PERIOD"}};
  CHECK(format_table_heading(columns) ==
        "  BR    PT  TY  LAB      omega      L2-NORM       MAX q1            a       PERIOD\n");
  CHECK(format_table_line({1, 2, true, 0, 0, {1, 2, 3, 4, 5, 6, 7, 8}}, columns) ==
        "   1    -2        0  1.00000E+00  2.00000E+00  3.00000E+00  6.00000E+00  8.00000E+00\n");
  columns.insert(columns.end() - 1, {Kind::user_function, 1, "power"});
  CHECK(format_table_heading(columns) ==
        "  BR    PT  TY  LAB      omega      L2-NORM            a        power       PERIOD\n");
}
