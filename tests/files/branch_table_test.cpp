// Tables for other programs: what CSV and JSON have to be, whatever names and numbers a run has.
#include "files/branch_file.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <sstream>

#include "files/table_writer.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using test_support::TemporaryFolder;

namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string csv(const BranchFile& file) {
  std::ostringstream out;
  write_branch_table(*table_formats()[0].make(out), file);
  return out.str();
}

}  // namespace

TEST_CASE("CSV fields as RFC 4180 has them") {
  CHECK(csv_field(TableCell()).empty());
  CHECK(csv_field(TableCell(true)) == "1");
  CHECK(csv_field(TableCell(-7)) == "-7");
  CHECK(csv_field(TableCell(std::string("plain words"))) == "plain words");
  CHECK(csv_field(TableCell(std::string("a, \"b\""))) == "\"a, \"\"b\"\"\"");
  CHECK(csv_field(TableCell(std::string("two\nlines"))) == "\"two\nlines\"");
  CHECK(csv_field(TableCell(-std::numeric_limits<double>::infinity())) == "-inf");
  CHECK(csv_field(TableCell(std::nan(""))).empty());
  CHECK(csv_line({"a", "", "c"}) == "a,,c\n");
}

TEST_CASE("JSON values are valid whatever a name holds") {
  CHECK(json_value(TableCell()) == "null");
  CHECK(json_value(TableCell(false)) == "false");
  CHECK(json_value(TableCell(std::numeric_limits<double>::infinity())) == "null");
  CHECK(json_value(TableCell(std::nan(""))) == "null");
  CHECK(json_value(TableCell(1e-5)) == "1e-05");
  CHECK(json_value(TableCell(std::string("a \"b\" \\ c\td\xff\n"))) == R"("a \"b\" \\ c?d_\n")");
}

TEST_CASE("numbers are read back exactly") {
  for (const double value : {0.1, 1.0 / 3.0, 3.0485258794, 6.02214076e23, 5e-324, -2.2250738585072014e-308})
    CHECK(std::strtod(csv_field(TableCell(value)).c_str(), nullptr) == value);
}

TEST_CASE("states keep their names, and columns of tchat's own give way") {
  CHECK(own_heading("t", {"x", "v"}) == "t");
  CHECK(own_heading("t", {"x", "t", "t_"}) == "t__");
}

TEST_CASE("headings that are there already get a number") {
  CHECK(distinct_headings({"t", "x", "t", "t", "t (2)"}) ==
        std::vector<std::string>{"t", "x", "t (2)", "t (3)", "t (2) (2)"});
}

TEST_CASE("sections with different columns, names like our own, numbers that are not finite") {
  const TemporaryFolder folder;
  const std::string path = folder.write("p.a",
                                        "   0   ISP =   2   NSEG=   1\n   0   parnames = {1: 'label', 2: 'b'}\n   0   "
                                        "Active continuation parameters:  1\n"
                                        "   0    PT  TY  LAB             label            L2-NORM\n"
                                        "   1    -1   9    1  1.5000000000E+000  1.0000000000E+099\n"
                                        "   0   ISW =   2   NSEG=   1\n   0   Branch type: 7  TY = 'PD'\n"
                                        "   0    PT  TY  LAB                 b            L2-NORM\n"
                                        "   2     1   9    2  2.5000000000E+000  3.5000000000E+000\n");
  folder.write("d.a",
               "  BR    PT  TY  LAB       label\n   1    -1  EP    1   1.50000E+00\n Multipliers:     Stable:   0\n"
               "   Multiplier   1  1.0000000000E+099  0.0000000000E+000   Abs. Val.  1.0000000000E+099\n"
               "   1     1  Iterations   : 3\n===============================================\n");
  const BranchFile file = read_branch_file(path);
  CHECK(file.warnings.empty());
  CHECK(lines_of(csv(file)) ==
        std::vector<std::string>{"section,branch,point,type,name,label,kind,stable,admissible,label (2),L2-NORM,b,"
                                 "multiplier1_re,multiplier1_im,newton_iterations",
                                 "1,1,1,EP,,1,,1,1,1.5,,,inf,0,3", "2,2,1,EP,,2,,,,,3.5,2.5,,,"});
  std::ostringstream json;
  write_branch_table(*table_formats()[1].make(json), file);
  CHECK(lines_of(json.str()) ==
        std::vector<std::string>{
            "[",
            R"-({"section": 1, "branch": 1, "point": 1, "type": "EP", "name": null, "label": 1, "kind": null, )-"
            R"-("stable": true, "admissible": true, "label (2)": 1.5, "L2-NORM": null, "b": null, )-"
            R"-("multipliers": [[null, 0]], "newton_iterations": 3},)-",
            R"-({"section": 2, "branch": 2, "point": 1, "type": "EP", "name": null, "label": 2, "kind": null, )-"
            R"-("stable": null, "admissible": null, "label (2)": null, "L2-NORM": 3.5, "b": 2.5, )-"
            R"-("multipliers": null, "newton_iterations": null})-",
            "]"});
}
