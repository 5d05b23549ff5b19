#include "files/solution_tables.hpp"

#include <catch2/catch.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "base/messages.hpp"
#include "files/sample_orbits.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using test_support::message_of;
using test_support::sample_orbit;

namespace {

/// Numbers of the lines that are neither comments nor empty.
std::vector<std::vector<double>> rows_of(const std::string& text) {
  std::vector<std::vector<double>> rows;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    rows.emplace_back();
    for (double value; words >> value;) rows.back().push_back(value);
  }
  return rows;
}

}  // namespace

TEST_CASE("tables: an orbit in physical time", "[output]") {
  const LabelledSolution orbit = sample_orbit(2, 3, 2, 2);  // durations 1.5, 2, 2.5
  const std::string text = format_orbit_table(orbit, "q.x");
  CHECK_THAT(text, Contains("# q.x: label 5 (PD), 3 segments, period 6\n# PAR(1) = 3\n"));
  const auto rows = rows_of(text);
  REQUIRE(rows.size() == 15);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const int segment = static_cast<int>(k) / 5, node = static_cast<int>(k) % 5;
    REQUIRE(rows[k].size() == 5);
    CHECK(rows[k][0] == segment + 1.0);
    CHECK(rows[k][1] == 0.25 * node);
    const double starts[] = {0.0, 1.5, 3.5}, durations[] = {1.5, 2.0, 2.5};
    CHECK(rows[k][2] == Approx(starts[segment] + 0.25 * node * durations[segment]).epsilon(1e-10));
    for (int r = 0; r < 2; ++r)
      CHECK(rows[k][3 + static_cast<std::size_t>(r)] ==
            Approx(orbit.states(2 * segment + r, node)).epsilon(1e-9).margin(1e-12));
  }
}

TEST_CASE("Older files: segments from the durations, or the dimension from the user", "[output]") {
  LabelledSolution orbit = sample_orbit(2, 3, 2, 2);
  orbit.dimension = 0;
  orbit.problem_type = 0;
  CHECK(rows_of(format_orbit_table(orbit, "q.x")).size() == 15);
  orbit.free_parameters.clear();
  CHECK_THAT(message_of<UserError>([&] { format_orbit_table(orbit, "q.x"); }), Contains("--dimension"));
  CHECK(rows_of(format_orbit_table(orbit, "q.x", {}, 3)).size() == 10);
  CHECK_THAT(format_orbit_table(orbit, "q.x", {}, 3), Contains("2 segments, period 3.5"));
  CHECK_THAT(message_of<UserError>([&] { format_orbit_table(orbit, "q.x", {}, 4); }), Contains("must divide 6"));
}

TEST_CASE("The table of labels", "[output]") {
  SolutionFile file;
  file.solutions.push_back(sample_orbit(2, 2, 50, 4));
  file.solutions.push_back(sample_orbit(4, 1, 10, 2));
  file.solutions[1].label = 6;
  file.solutions[1].type = -4;
  file.solutions[1].kind = {UserPointKind::contact, 1, 2, 0.5};
  const std::string text = format_label_table(file);
  CHECK(text ==
        "  LAB  TY  BR    PT  IPS  SEG NTSTxNCOL STABLE        PERIOD  FREE PARAMETERS\n"
        "    5  PD   2    17  180    2      50x4      -           3.5  PAR(1) = 3\n"
        "    6  GR   2    17  180    1      10x2      -           1.5  PAR(1) = 3\n"
        "          contact inside segment 1, event function 2, tau = 0.5\n");
  RecordedLabel recorded;
  recorded.stable = false;
  recorded.admissible = false;
  recorded.words = "period doubling";
  recorded.violation = "h_1 < 0";
  CHECK_THAT(format_label_table(file, {}, {{5, recorded}}),
             Contains("50x4     no           3.5  PAR(1) = 3   period doubling\n          inadmissible: h_1 < 0\n"));
}

TEST_CASE("Names of the problem in both tables", "[output]") {
  const ProblemNames names{{"x", "velocity"}, {"omega"}, {}};
  SolutionFile file;
  file.solutions.push_back(sample_orbit(3, 1, 4, 2));
  file.solutions[0].type = -4;
  file.solutions[0].kind = {UserPointKind::user_value, 0, 1, 0.0};
  CHECK_THAT(format_label_table(file, names), Contains("omega = 3   user value of omega\n") && !Contains("PAR(1)"));
  const std::string text = format_orbit_table(file.solutions[0], "q.x", names);
  CHECK_THAT(text, Contains("# omega = 3\n"));
  CHECK_THAT(text, Contains("                  x           velocity               U(3)\n"));
}
