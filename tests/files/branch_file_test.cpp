// A p-file with its q- and d-file: what belongs together, and what is of another run.
#include "files/branch_file.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "base/messages.hpp"
#include "files/sample_solutions.hpp"
#include "files/solution_file_reader.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using namespace test_support;
using Catch::Matchers::Contains;

namespace {

/// Points 10 label 1 and 20 label 2, as the sample entries have them, with another point between; PAR(1) is 1 there.
std::string points(double parameter = 1.0) {
  std::string text =
      "   0   NDIM=   2   IPS = 180   ISP =   2   NSEG=   1\n   0   Active continuation parameters:  1 61\n"
      "   0    PT  TY  LAB            PAR(1)             PERIOD\n";
  const auto row = [&](int point, int type, int label) {
    text += fmt::format("   1{:6}{:4}{:5}{:19.10E}{:19.10E}\n", point, type, label, parameter, 61.0);
  };
  row(-10, 9, 1);
  row(-11, 0, 0);
  row(20, -4, 2);
  return text;
}

std::string solutions() {
  SampleEntry first, second;
  second.label = 2;
  second.type = -4;
  second.internal = {2, 1, 3, 0.25};
  return first.text() + second.text();
}

std::string block(int point, const char* type, int label, double parameter, const char* end = "") {
  return fmt::format(
      "  BR    PT  TY  LAB      PAR(1)\n   1{:6}{:>4}{:5}{:14.5E}{}\n Multipliers:     Stable:   1\n"
      "   Multiplier   1  0.5E+000  0.0E+000   Abs. Val.  0.5E+000\n   1{:6}  Iterations   : 4\n{}\n",
      point, type, label, parameter, end, std::abs(point), std::string(47, '='));
}

std::string message(const std::string& p, const std::string& q, const std::string& d) {
  try {
    read_branch_file(p, q, d);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("what the q- and d-file know of the points of a p-file") {
  const TemporaryFolder folder;
  folder.write("q.a", solutions());
  folder.write("d.a", block(-10, "EP", 1, 1.0) + block(20, "GR", 2, 1.0, "  inadmissible"));
  const BranchFile file = read_branch_file(folder.write("p.a", points()));
  CHECK(file.warnings.empty());
  CHECK(file.types[0] == std::vector<std::string>{"EP", "", "GR"});
  REQUIRE(file.solution_of(0, 2) != nullptr);
  CHECK(file.solution_of(0, 2)->kind == UserPointKind{UserPointKind::contact, 1, 3, 0.25});
  CHECK(file.solution_of(0, 1) == nullptr);
  CHECK(file.parameters[0].at(7) == 7.0);
  REQUIRE(file.diagnostic_of(0, 0) != nullptr);
  CHECK(file.diagnostic_of(0, 0)->iterations == 4);
  CHECK(file.diagnostic_of(0, 0)->multipliers == std::vector<std::complex<double>>{0.5});
  CHECK(file.diagnostic_of(0, 1) == nullptr);  // the d-file may lack points
  CHECK(file.admissible[0] == std::vector<bool>{true, true, false});
}

TEST_CASE("files of another run are refused when named, left out when beside") {
  const TemporaryFolder folder;
  const std::string p = folder.write("p.a", points(1.5)), q = folder.write("q.b", solutions());
  const std::string d = folder.write("d.b", block(-10, "EP", 1, 1.0));
  CHECK_THAT(message(p, q, ""), Contains("label 1 has 1 where") && Contains("PAR(1) = 1.5") &&
                                    Contains("of another run, the one needed is ") && Contains("q.a"));
  CHECK_THAT(message(p, "", d), Contains("label 1 has 1 where") && Contains("the one needed is ") && Contains("d.a"));
  const std::string none = folder.write("d.none", block(-30, "EP", 1, 1.5));
  CHECK_THAT(message(p, "", none), Contains("none of the points"));
  CHECK_THAT(message(p, "", folder.write("d.empty", "nothing\n")), Contains("no point in it"));
  CHECK_THAT(message(p, p, ""), Contains("p.a:1"));

  folder.write("q.a", solutions());
  folder.write("d.a", block(-10, "EP", 1, 1.0));
  const BranchFile file = read_branch_file(p);
  REQUIRE(file.warnings.size() == 2);
  CHECK_THAT(file.warnings[0], Contains("q.a: ") && Contains("of another run: take it away"));
  CHECK_THAT(file.warnings[1], Contains("d.a: ") && Contains("of another run: take it away"));
  CHECK(file.solution_of(0, 0) == nullptr);
  CHECK(file.diagnostic_of(0, 0) == nullptr);
  CHECK(file.types[0] == std::vector<std::string>{"EP", "", "UZ"});
}

TEST_CASE("a d-file has the digits of the screen") {
  const TemporaryFolder folder;
  const std::string p = folder.write("p.a", points(1.23456789)),
                    d = folder.write("d.a", block(-10, "EP", 1, 1.23456789));
  CHECK(message(p, "", d).empty());
  CHECK_FALSE(message(p, "", folder.write("d.b", block(-10, "EP", 1, 1.2347))).empty());
}

TEST_CASE("labels that the q-file lacks are told") {
  const TemporaryFolder folder;
  folder.write("q.a", SampleEntry().text());
  const BranchFile file = read_branch_file(folder.write("p.a", points()));
  REQUIRE(file.warnings.size() == 1);
  CHECK_THAT(file.warnings[0], Contains("q.a: 1 of the labels of"));
}

TEST_CASE("names of columns that are longer than their headings") {
  const PointFile file = parse_point_file(
      "   0   unames = {1: 'displacement of the proof mass'}\n   0   columns = {2: 'MAX displacement of the proof "
      "mass'}\n"
      "   0    PT  TY  LAB            PAR(7)  MAX displacement \n"
      "   1    -1   9    1  1.0000000000E+000  2.0000000000E+000\n",
      "p.a");
  CHECK(file.sections[0].columns == std::vector<std::string>{"PAR(7)", "MAX displacement of the proof mass"});
  CHECK(file.sections[0].parameter_of_column(0) == 7);
  CHECK_FALSE(file.sections[0].parameter_of_column(1));
}

TEST_CASE("a further branch of AUTO has headings alone and the constants of the first") {
  const PointFile file = parse_point_file(
      "   0   0.0E+00  1.0E+00  0.0E+00  1.0E+00\n   0   IPS =   1\n   0   parnames = {1: 'rho'}\n"
      "   0    PT  TY  LAB               rho\n   1     1   9    1  1.0000000000E+000\n"
      "   0\n   0    PT  TY  LAB               rho                 x\n"
      "   2     1   9    2  1.0000000000E+000  2.0000000000E+000\n"
      "   0   0.0E+00  1.0E+00  0.0E+00  1.0E+00\n   0   IPS =   2\n   0    PT  TY  LAB               rho\n"
      "   3     1   9    3  1.0000000000E+000\n",
      "b.a");
  REQUIRE(file.sections.size() == 3);
  CHECK(file.sections[1].parameter_of_column(0) == 1);
  CHECK(file.sections[1].problem_type == 1);
  CHECK(file.sections[1].columns == std::vector<std::string>{"rho", "x"});
  CHECK(file.sections[2].problem_type == 2);
  CHECK_FALSE(file.sections[2].parameter_of_column(0));
}

TEST_CASE("solutions by counted names") {
  const TemporaryFolder folder;
  const BranchFile file = [&] {
    folder.write("q.a", solutions());
    return read_branch_file(folder.write("p.a", points()));
  }();
  CHECK(counted_names(file.solutions) == std::vector<std::vector<std::string>>{{"EP1"}, {"GR1"}});
}
