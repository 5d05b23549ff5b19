#include "files/diagnostics_file.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

using namespace tchat;
using Catch::Matchers::Contains;

namespace {

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

}  // namespace

TEST_CASE("The bar has 47 signs", "[output]") {
  CHECK(format_bar() == "===============================================\n");
  CHECK(format_bar().size() == 48);
}

TEST_CASE("Newton history by hand", "[output]") {
  const std::string text = format_newton_history(1, 12, {{0, 3.0, 1.25, 0.0, 0.0}, {1, 3.125, 1.5, 1e-3, 2.5e-12}});
  CHECK(text ==
        "  BR    PT  IT     PARAMETER      RESIDUAL      PAR. STEP     STATE STEP\n"
        "   1    12   0   3.00000E+00   1.25000E+00\n"
        "   1    12   1   3.12500E+00   1.50000E+00   1.00000E-03    2.50000E-12\n");
}

TEST_CASE("Multipliers as the parser of fort.9 takes them apart", "[output]") {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<std::complex<double>> mu = {{-0.6, 0.8}, {0.25, 0.0}, {-infinity, 0.0}, {1e120, 0.0}};
  std::istringstream text(format_multipliers(mu));
  std::string line;
  std::getline(text, line);
  CHECK(words_of(line) == std::vector<std::string>{"Multipliers:", "Stable:", "2"});
  std::getline(text, line);
  CHECK(words_of(line) == std::vector<std::string>{"Multiplier", "1", "-6.0000000000E-001", "8.0000000000E-001", "Abs.",
                                                   "Val.", "1.0000000000E+000"});
  std::getline(text, line);
  CHECK(words_of(line)[2] == "2.5000000000E-001");
  std::getline(text, line);
  CHECK(words_of(line)[2] == "-1.0000000000E+099");
  CHECK(words_of(line)[6] == "1.0000000000E+099");
  std::getline(text, line);
  CHECK(words_of(line)[2] == "1.0000000000E+099");
  CHECK_FALSE(std::getline(text, line));
}

TEST_CASE("A multiplier at the rim of AUTO's rule counts as stable", "[output]") {
  const std::vector<std::complex<double>> mu = {{1.0000099, 0.0}, {1.00002, 0.0}};
  CHECK_THAT(format_multipliers(mu), Contains("Stable:   1"));
}

TEST_CASE("An ordinary point in short, as readers find it", "[output]") {
  PointLine point;
  point.branch = 2;
  point.point = 10017;
  point.stable = true;
  point.values = {3.25, 1.0};
  const std::string heading = format_short_heading({{PointColumn::Kind::parameter, 1, "alpha"}, {}});
  const std::vector<std::complex<double>> mu = {{-0.6, 0.8}, {-0.6, -0.8}, {0.25, 0.0}, {-1e-15, 0.0}};
  const std::vector<double> tests = {-5.00217, 0.126612345, NAN, -1.3e-7, 0.0};
  std::string text;
  append_short_point(text, point, heading);
  append_short_multipliers(text, mu, false);
  append_short_tests(text, tests);
  append_iterations(text, 2, 10017, 2);
  append_next_step(text, 2, 10017, -0.02);
  CHECK(text ==
        "  BR    PT  TY  LAB      alpha\n"
        "   2   -18        0  3.25000E+00\n"
        "Multiplier 1 -6.0000000000E-01 8.0000000000E-01\n"
        "Multiplier 2 -6.0000000000E-01 -8.0000000000E-01\n"
        "Multiplier 3 2.5000000000E-01 0\n"
        "Multiplier 4 -1.0000000000E-15 0\n"
        "tests: -5.0022 0.12661 - -1.3e-07 0\n"
        "   2    18  Iterations   : 2\n"
        "   2    18  Next Step    : -2.00000e-02\n" +
            format_bar());
  CHECK(text.size() <= 400);
  const std::vector<DiagnosticPoint> read = parse_diagnostics(text);
  REQUIRE(read.size() == 1);
  CHECK(read[0].branch == 2);
  CHECK(read[0].point == -18);
  CHECK(read[0].parameter == 3.25);
  CHECK(read[0].multipliers == mu);
  CHECK(read[0].iterations == 2);

  text.clear();
  point.admissible = false;
  append_short_point(text, point, heading);
  append_short_multipliers(text, std::vector<std::complex<double>>{{-1.0, 2.0}}, true);
  append_short_tests(text, {});
  CHECK(text ==
        "  BR    PT  TY  LAB      alpha\n"
        "   2   -18        0  3.25000E+00  inadmissible\n"
        "Eigenvalue 1: -1.0000000000E+00 2.0000000000E+00\n");
}

TEST_CASE("Test functions and those that are undefined", "[output]") {
  const std::string text = format_test_functions({{"contact, segment 1, event 2", -0.5, true}, {"fold", 0.0, false}});
  CHECK(text ==
        "   contact, segment 1, event 2:                  -5.0000000000E-001\n"
        "   fold:                                                  undefined\n");
}

TEST_CASE("Notes: place, indented further lines, no words that a parser takes for numbers", "[output]") {
  CHECK(format_note(1, 10003, "first\nsecond") == "   1     4  NOTE: first\n                  second\n");
  CHECK(format_note(1, 5, "Multiplier 0 is off") == "   1     5  NOTE: multiplier 0 is off\n");
  CHECK(format_note(1, 5, "the Eigenvalue is") == "   1     5  NOTE: the eigenvalue is\n");
}

TEST_CASE("The end of a complete run is recognised", "[output]") {
  CHECK(format_end_of_run() == "===============================================\nend of run\n");
  CHECK(ends_complete_run(format_end_of_run()));
  CHECK(ends_complete_run("end of run\n"));
  CHECK(ends_complete_run("end of run\r\n\n"));
  CHECK(ends_complete_run("=====\n Total Time    0.123E+01\n"));
  CHECK_FALSE(ends_complete_run(""));
  CHECK_FALSE(ends_complete_run("end of run"));
  CHECK_FALSE(ends_complete_run("end of run\n" + format_bar()));
  CHECK_FALSE(ends_complete_run("   1     4  NOTE: the end of run\n"));
  for (std::size_t cut = 0; cut + 1 < format_end_of_run().size(); ++cut)
    CHECK_FALSE(ends_complete_run(format_end_of_run().substr(0, cut)));
}
