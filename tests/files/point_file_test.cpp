#include "files/point_file.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

using namespace tchat;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

RunSettings oscillator_settings() {
  RunSettings s;
  s.dimension = 4;
  s.free_parameters = {1, 61, 62};
  s.segments.resize(2);
  s.segments[0].index = {1, 3, 2};
  s.segments[1].index = {1, 1, 1};
  s.parameter_weights = {{61, 0.0}, {62, 0.5}};
  s.user_values = {{1, 2.5, false}, {1, 3.0, false}, {2, 4.0, true}};
  s.stop_rules = {{"PD", 1}, {"GR", 2}};
  s.parameter_min = -1.7976931348623157e308;
  s.parameter_max = 10.0;
  s.measure_min = 0.0;
  s.measure_max = 1e300;
  s.start = {"PD", 1};
  s.max_points = 12345;
  return s;
}

ProblemNames oscillator_names() { return {{"x1", "x2", "y1", "y2"}, {"alpha", "omega", "zeta", "r"}, {}}; }

std::vector<std::string> names_of(const std::vector<PointColumn>& columns) {
  std::vector<std::string> names;
  for (const PointColumn& column : columns) names.push_back(column.name);
  return names;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0, end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1)
    lines.push_back(text.substr(begin, end - begin));
  return lines;
}

}  // namespace

TEST_CASE("Columns: parameter, measure, maxima, further parameters, period", "[output]") {
  const auto columns = point_columns(oscillator_settings(), oscillator_names());
  CHECK(names_of(columns) == std::vector<std::string>{"alpha", "L2-NORM", "MAX x1", "MAX x2", "MAX y1", "MAX y2",
                                                      "PAR(61)", "PAR(62)", "PERIOD"});
  CHECK(columns[0].kind == PointColumn::Kind::parameter);
  CHECK(columns[3].kind == PointColumn::Kind::maximum);
  CHECK(columns[3].index == 2);
  CHECK(columns[7].index == 62);
  CHECK(columns[8].kind == PointColumn::Kind::period);
}

TEST_CASE("The number of maxima is 7 less the free parameters that are not durations", "[output]") {
  RunSettings s = oscillator_settings();
  s.dimension = 9;
  s.free_parameters = {2, 1, 61, 62};
  ProblemNames names = oscillator_names();
  names.user_functions = {"energy"};
  auto columns = point_columns(s, names);
  CHECK(names_of(columns) == std::vector<std::string>{"omega", "L2-NORM", "MAX x1", "MAX x2", "MAX y1", "MAX y2",
                                                      "MAX U(5)", "alpha", "PAR(61)", "PAR(62)", "energy", "PERIOD"});
  s.free_parameters = {1, 2, 3, 4, 5, 6, 7, 8};
  columns = point_columns(s, names);
  CHECK(columns.size() == 1 + 1 + 0 + 7 + 1 + 1);
}

TEST_CASE("The measure follows its selector", "[output]") {
  const ProblemNames names = oscillator_names();
  CHECK(measure_column(0, 4, names).name == "L2-NORM");
  CHECK(measure_column(2, 4, names).name == "MAX x2");
  CHECK(measure_column(-3, 4, names).name == "MIN y1");
  CHECK(measure_column(5, 4, names).name == "INTEGRAL x1");
  CHECK(measure_column(12, 4, names).name == "L2-NORM y2");
  CHECK(measure_column(12, 4, names).kind == PointColumn::Kind::component_l2_norm);
  CHECK(measure_column(12, 4, names).index == 4);
  CHECK(measure_column(13, 4, names).kind == PointColumn::Kind::l2_norm);
}

TEST_CASE("Header lines by hand", "[output]") {
  PointFileHeader header{oscillator_settings(), {1, 61, 62}, oscillator_names(), 0};
  const auto lines = lines_of(format_point_header(header, point_columns(header.settings, header.names)));
  const std::vector<std::string> expected = {
      "   0  -1.7976+308  1.0000E+01  0.0000E+00  1.0000+300",
      "   0   EPSL= 1.0000E-07   EPSU= 1.0000E-07   EPSS= 1.0000E-07",
      "   0   DS  = 1.0000E-02  DSMIN= 0.0000E+00  DSMAX= 1.0000E-01",
      "   0   NDIM=   4   IPS = 180   IRS = PD1   ILP =   1",
      "   0   NTST=  50   NCOL=   4   IAD =   3   ISP =   2",
      "   0   ISW =   1   IPLT=   0   NBC =   0   NINT=   0",
      "   0  NMX =12345  NPR =    0   MXBF=   0   IID =   2   IADS=   1",
      "   0   ITMX=   9   ITNW=   8   NWTN=   3   JAC =   0   NUZR=   3",
      "   0   NPAR= 100   THL = {61: 0, 62: 0.5}   THU = {}",
      "   0   UZR = {1: [2.5, 3]}",
      "   0   UZSTOP = {2: 4}",
      "   0   STOP = ['PD1', 'GR2']",
      "   0   unames = {1: 'x1', 2: 'x2', 3: 'y1', 4: 'y2'}",
      "   0   parnames = {1: 'alpha', 2: 'omega', 3: 'zeta', 4: 'r'}",
      "   0   NSEG=   2 GRSTOP=   1 GRJUMP=   1   SIGNATURE = [[1, 3, 2], [1, 1, 1]]",
      "   0   User-specified parameters:      1  61  62",
      "   0   Active continuation parameters:      1  61  62",
      "   0",
      "   0    PT  TY  LAB             alpha            L2-NORM             MAX x1             MAX x2"
      "             MAX y1             MAX y2            PAR(61)            PAR(62)             PERIOD  "};
  REQUIRE(lines.size() == expected.size());
  for (std::size_t k = 0; k < lines.size(); ++k) CHECK(lines[k] == expected[k]);
}

TEST_CASE("Names longer than their headings stand in the header in full", "[output]") {
  PointFileHeader header{oscillator_settings(), {1, 61, 62}, oscillator_names(), 0};
  header.names.states[1] = "velocity of \"the\" mass";
  header.names.states[2] = "thirteen long";  // MAX and 13 letters fill a heading
  const std::string text = format_point_header(header, point_columns(header.settings, header.names));
  CHECK_THAT(text, Contains("\n   0   columns = {4: 'MAX velocity of _the_ mass'}\n   0\n   0    PT  TY  LAB "));
  CHECK_THAT(text, Contains("MAX velocity of _  MAX thirteen long  "));
}

TEST_CASE("Two-parameter runs name the curve's type", "[output]") {
  PointFileHeader header{oscillator_settings(), {1, 2, 61, 62}, oscillator_names(), 7};
  const std::string text = format_point_header(header, point_columns(header.settings, header.names));
  CHECK_THAT(text, Contains("   0   Branch type: 7  TY = 'PD'\n   0\n   0    PT  TY  LAB "));
}

TEST_CASE("One free parameter has its line in the singular, as AUTO's reader expects", "[output]") {
  PointFileHeader header{oscillator_settings(), {1}, oscillator_names(), 0};
  CHECK_THAT(format_point_header(header, {}), Contains("   0   Active continuation parameter:      1\n"));
}

TEST_CASE("A point line by hand", "[output]") {
  CHECK(format_point({1, 12, true, 0, 0, {1.5, -2e-101}}) ==
        "   1   -12   0    0  1.5000000000E+000 -2.0000000000E-101\n");
  CHECK(format_point({3, 10000, false, -74, 21, {0.0}}) == "   3     1 -74   21  0.0000000000E+000\n");
  CHECK(format_point({1, 9999, true, 9, 1, {std::nan("")}}) == "   1 -9999   9    1  1.0000000000E+099\n");
}

TEST_CASE("Large labels keep their blanks", "[output]") {
  CHECK_THAT(format_point({1, 2, false, -59, 12345, {}}), StartsWith("   1     2 -59 12345\n"));
}

TEST_CASE("Every heading stands within the column of the numbers, shifted by one", "[output]") {
  PointFileHeader header{oscillator_settings(), {1, 61, 62}, oscillator_names(), 0};
  const auto columns = point_columns(header.settings, header.names);
  const std::string heading = lines_of(format_point_header(header, columns)).back();
  std::string point = format_point({1, 1, false, 9, 1, std::vector<double>(columns.size(), 1.0)});
  REQUIRE(point.size() == 19 + 19 * columns.size() + 1);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    std::string name = heading.substr(20 + 19 * k, 19);
    name = name.substr(name.find_first_not_of(' '));
    name = name.substr(0, name.find_last_not_of(' ') + 1);
    CHECK(name == columns[k].name);
  }
}
