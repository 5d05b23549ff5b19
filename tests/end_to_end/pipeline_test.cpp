// The main job: two nonimpacting branches, the impacting one, and on from its middle in the other direction; every
// number that the files hold is compared with closed forms.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>

#include "end_to_end/closed_forms.hpp"
#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

/// A value as a p-file has it.
double eleven_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10E", value);
  return std::stod(text);
}

constexpr double zeta = 0.05;
constexpr double restitution = 0.8;

/// Labels, points, types and parameters of p- and q-file agree.
void check_files_agree(const std::vector<PointSection>& sections, const std::vector<SolutionEntry>& solutions) {
  REQUIRE(labels_of(sections) == labels_of(solutions));
  REQUIRE_FALSE(solutions.empty());
  for (const SolutionEntry& solution : solutions) {
    INFO("label " << solution.label);
    const PointRow& row = with_label(sections, solution.label);
    CHECK(solution.branch == row.branch);
    CHECK(solution.point == std::abs(row.point));
    CHECK(solution.type == row.type);
    CHECK(solution.branch_mode == sections.front().integer("ISW"));
    CHECK(solution.problem_type == 180);
    CHECK(solution.dimension == 4);
    CHECK(solution.intervals == sections.front().integer("NTST"));
    CHECK(solution.collocation == sections.front().integer("NCOL"));
    REQUIRE(solution.free_parameters.size() == 2);
    CHECK(solution.free_parameters.back() == 61);
    CHECK(eleven_digits(solution.parameter(solution.free_parameters.front())) == row.values.front());
    CHECK(eleven_digits(solution.parameter(61)) == row.values.back());
    for (int k = 0; k < 4; ++k) {
      double maximum = solution.states.front().at(static_cast<std::size_t>(k));
      for (const auto& state : solution.states) maximum = std::max(maximum, state[static_cast<std::size_t>(k)]);
      CHECK(row.values.at(static_cast<std::size_t>(2 + k)) == maximum);
    }
  }
}

/// Mesh points to `mesh`, points between them to `between`.
template <class ClosedForm>
void check_states(const SolutionEntry& solution, const ClosedForm& orbit, double mesh, double between) {
  INFO("label " << solution.label);
  CHECK(solution.parameter(61) == Approx(orbit.period()).epsilon(1e-10));
  for (std::size_t k = 0; k < solution.t.size(); ++k) {
    INFO("t = " << solution.t[k]);
    const State exact = orbit.at(solution.t[k] * orbit.period());
    const double tolerance = k % static_cast<std::size_t>(solution.collocation) == 0 ? mesh : between;
    for (std::size_t i = 0; i < 4; ++i) CHECK(std::abs(solution.states[k][i] - exact[i]) < tolerance);
  }
}

void check_nonimpacting_rows(const PointSection& section, const std::string& free) {
  const double fixed = free == "alpha" ? 2.0 : 3.0;
  for (const PointRow& row : section.rows) {
    INFO("point " << row.point);
    const double alpha = free == "alpha" ? row.values[section.column("alpha")] : fixed;
    const double omega = free == "omega" ? row.values[section.column("omega")] : fixed;
    const NonimpactingOrbit orbit(alpha, omega, zeta);
    CHECK(row.point < 0);  // stable: both multipliers have modulus exp(-zeta T)
    CHECK(row.values[section.column("MAX x1")] == Approx(amplitude(alpha, omega, zeta)).epsilon(1e-9));
    CHECK(row.values[section.column("L2-NORM")] == Approx(orbit.l2_norm()).epsilon(1e-8));
    CHECK(row.values[section.column("PERIOD")] == Approx(orbit.period()).epsilon(1e-10));
    CHECK(row.values[section.column("PAR(61)")] == row.values[section.column("PERIOD")]);
    // Maxima are taken over the points of the mesh: a little below the orbit's own.
    CHECK(row.values[section.column("MAX x2")] == Approx(omega * amplitude(alpha, omega, zeta)).epsilon(1e-3));
    CHECK(row.values[section.column("MAX y1")] == Approx(1.0).epsilon(1e-3));
    CHECK(row.values[section.column("MAX y2")] == Approx(1.0).epsilon(1e-3));
  }
}

void check_header(const PointSection& section, const std::string& signature) {
  CHECK(section.integer("NDIM") == 4);
  CHECK(section.integer("IPS") == 180);
  CHECK(section.integer("NTST") == 50);
  CHECK(section.integer("NCOL") == 4);
  CHECK(section.integer("NSEG") == 1);
  CHECK(section.integer("NUZR") == 1);
  CHECK(section.constants.at("SIGNATURE") == signature);
  CHECK(section.constants.at("unames") == "{1: 'x1', 2: 'x2', 3: 'y1', 4: 'y2'}");
  CHECK(section.constants.at("parnames") == "{1: 'alpha', 2: 'omega', 3: 'zeta', 4: 'r'}");
}

/// What a run leaves: four files, a complete d-file, a table and a summary.
void check_traces(const Workspace& workspace, const std::string& name, const Outcome& outcome) {
  for (const char* letter : {"p.", "q.", "d.", "r."}) CHECK(workspace.has(letter + name));
  const std::string diagnostics = workspace.read("d." + name);
  CHECK(diagnostics.find(std::string(47, '=') + "\n") != std::string::npos);
  CHECK(outcome.err.empty());
  CHECK(outcome.out.find("BR    PT  TY  LAB") != std::string::npos);
  CHECK(outcome.out.find("stopped: ") != std::string::npos);
  CHECK(outcome.out.find("multiplier that should be 0") != std::string::npos);
}

/// Velocity at the impact that began the orbit.
double impact_velocity(const SolutionEntry& solution) { return -solution.states.front()[1] / restitution; }

void check_impacting(const std::vector<PointSection>& sections, const std::vector<SolutionEntry>& solutions) {
  check_files_agree(sections, solutions);
  for (const PointRow& row : rows_of(sections)) {
    INFO("point " << row.point);
    CHECK(row.values.back() == Approx(2.0 * M_PI / 2.0072).epsilon(1e-10));
  }
  for (const SolutionEntry& solution : solutions) {
    const ImpactingOrbit orbit(impact_velocity(solution), 2.0072, zeta, restitution);
    check_states(solution, orbit, 1e-9, 2e-7);
    CHECK(solution.parameter(1) == Approx(orbit.alpha()).epsilon(1e-9));
    CHECK(solution.parameter(2) == 2.0072);
    CHECK(solution.parameter(3) == zeta);
    CHECK(solution.parameter(4) == restitution);
  }
}

/// "Multiplier k re im" of the first point of a d-file: real parts, falling.
std::vector<double> first_multipliers(const std::string& diagnostics) {
  std::vector<double> values;
  for (auto at = diagnostics.find("   Multiplier"); at != std::string::npos && values.size() < 4;
       at = diagnostics.find("   Multiplier", at + 1))
    values.push_back(std::stod(words_of(diagnostics.substr(at, 80)).at(2)));
  std::sort(values.rbegin(), values.rend());
  return values;
}

}  // namespace

TEST_CASE("nonimpacting orbit in alpha at omega = 2") {
  const Workspace workspace;
  const Outcome outcome = workspace.run("-c nonimpacting_alpha -d nonimpacting -o branch");
  check_traces(workspace, "branch", outcome);
  const auto sections = workspace.points("branch");
  const auto solutions = workspace.solutions("branch");
  REQUIRE(sections.size() == 1);
  check_header(sections.front(), "[[1, 2, 2]]");
  REQUIRE(sections.front().names.size() == 8);
  check_nonimpacting_rows(sections.front(), "alpha");
  check_files_agree(sections, solutions);
  for (const SolutionEntry& solution : solutions)
    check_states(solution, NonimpactingOrbit(solution.parameter(1), 2.0, zeta), 1e-9, 2e-7);

  // It starts and ends with EP, labels count from 1, the user value is met.
  CHECK(sections.front().rows.front().type == 9);
  CHECK(sections.front().rows.back().type == 9);
  CHECK(labels_of(sections).front() == 1);
  CHECK(sections.front().rows.back().values.front() < 0.5);
  const auto user = std::find_if(solutions.begin(), solutions.end(), [](const auto& s) { return s.type == -4; });
  REQUIRE(user != solutions.end());
  CHECK(user->parameter(1) == Approx(2.0).epsilon(1e-9));
  CHECK(user->internal == std::vector<double>{1.0, 0.0, 1.0, 0.0});

  // Multipliers: exp(-zeta T) times a rotation by sqrt(1 - zeta^2) T, exp(-2T) and 0, at any alpha.
  const auto multipliers = first_multipliers(workspace.read("d.branch"));
  REQUIRE(multipliers.size() == 4);
  const double pair = std::exp(-zeta * M_PI) * std::cos(std::sqrt(1.0 - zeta * zeta) * M_PI);
  CHECK(std::abs(multipliers[0] - std::exp(-2.0 * M_PI)) < 1e-8);
  CHECK(std::abs(multipliers[1]) < 1e-8);
  CHECK(std::abs(multipliers[2] - pair) < 1e-8);
  CHECK(std::abs(multipliers[3] - pair) < 1e-8);
}

TEST_CASE("nonimpacting orbit in omega at alpha = 3") {
  const Workspace workspace;
  check_traces(workspace, "branch", workspace.run("-c nonimpacting_omega -d nonimpacting -o branch"));
  const auto sections = workspace.points("branch");
  const auto solutions = workspace.solutions("branch");
  REQUIRE(sections.size() == 1);
  check_header(sections.front(), "[[1, 2, 2]]");
  check_nonimpacting_rows(sections.front(), "omega");
  check_files_agree(sections, solutions);
  for (const SolutionEntry& solution : solutions)
    check_states(solution, NonimpactingOrbit(3.0, solution.parameter(2), zeta), 1e-9, 2e-7);
}

TEST_CASE("impacting orbit at omega = 2.0072, and on from its middle in the other direction") {
  const Workspace workspace;
  check_traces(workspace, "impacting", workspace.run("-c impacting -d impacting -o impacting"));
  const auto sections = workspace.points("impacting");
  const auto solutions = workspace.solutions("impacting");
  check_header(sections.front(), "[[1, 1, 1]]");
  check_impacting(sections, solutions);
  CHECK(impact_velocity(solutions.front()) == Approx(0.5).epsilon(1e-9));
  CHECK(solutions.front().parameter(1) == Approx(3.04852587939213).epsilon(1e-9));

  const Outcome back = workspace.run("-c impacting -s impacting -o back IRS=3 DS=-0.02 GRSTOP=0");
  const auto back_sections = workspace.points("back");
  const auto back_solutions = workspace.solutions("back");
  check_impacting(back_sections, back_solutions);
  const PointRow& first = back_sections.front().rows.front();
  CHECK(first.values.front() == Approx(with_label(solutions, 3).parameter(1)).epsilon(1e-9));
  CHECK(first.label == 0);  // a restarted branch begins with a point that has its label already
  CHECK(back_sections.front().rows[1].values.front() < first.values.front());
  CHECK(labels_of(back_sections).front() == labels_of(sections).back() + 1);
  CHECK(back_sections.front().integer("IRS") == 3);
  // It passes the grazing orbit into orbits that the wall forbids.
  CHECK(back.out.find("inadmissible") != std::string::npos);
  CHECK(impact_velocity(back_solutions.back()) < 0.0);
}

TEST_CASE("an orbit as a table in physical time") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o impacting NMX=5");
  for (const char* label : {"1", "EP1"}) {
    const Outcome outcome = workspace.tchat(std::string("orbit q.impacting ") + label);
    REQUIRE(outcome.status == 0);
    std::istringstream in(outcome.out);
    const ImpactingOrbit orbit(0.5, 2.0072, zeta, restitution);
    int rows = 0;
    for (std::string line; std::getline(in, line);) {
      const auto words = words_of(line);
      if (words.empty() || words[0][0] == '#') continue;
      REQUIRE(words.size() == 7);
      const State exact = orbit.at(std::stod(words[2]));
      for (std::size_t i = 0; i < 4; ++i) CHECK(std::abs(std::stod(words[3 + i]) - exact[i]) < 1e-7);
      ++rows;
    }
    CHECK(rows == 201);
  }
}

TEST_CASE("starting data as label 1 of a q-file, and a run from there") {
  const Workspace workspace;
  const Outcome made = workspace.tchat("dat linosc -c impacting -d impacting -o data");
  REQUIRE(made.status == 0);
  const auto data = workspace.solutions("data");
  REQUIRE(labels_of(data) == std::vector<int>{1});
  CHECK(data.front().parameter(2) == 2.0072);
  const Outcome table = workspace.tchat("labels q.data");
  CHECK(table.status == 0);
  CHECK(table.out.find("EP") != std::string::npos);
  workspace.run("-c impacting -s data -o branch IRS=1");
  check_impacting(workspace.points("branch"), workspace.solutions("branch"));
}

TEST_CASE("two equal runs write equal files") {
  const Workspace here, elsewhere;
  for (const Workspace* workspace : {&here, &elsewhere})
    workspace->run("-c impacting -d impacting --both NMX=25 GRSTOP=0 -o branch");
  for (const char* file : {"p.branch", "q.branch", "d.branch", "r.branch"}) {
    INFO(file);
    CHECK(here.read(file).size() > 100);
    CHECK(here.read(file) == elsewhere.read(file));
  }
}
