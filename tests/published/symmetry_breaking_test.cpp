// A branch point on a grazing curve: the grazing orbit of a symmetric field loses its symmetry. It is located whatever
// the step, passed, restarted from, and left for the other branch by ISW = -1 to both sides.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "published/chain.hpp"

using namespace test_support;

namespace {

constexpr double c = 0.3, e = 0.2;  // of symmetric.cpp

/// The wall's place p where the orbit of constant z grazes.
double wall(double z) { return std::sqrt(1.0 + c * z * z) + e * z; }

const char* const constants = R"(# Grazing curve of the symmetric orbit in mu and p.
NDIM = 3, IPS = 150, IRS = 0
ICP = [1, 2, 61], THL = {61: 0}
NTST = 20, NCOL = 4, IAD = 3, ISP = 2
NMX = 300, NPR = 0, RL0 = -0.3, RL1 = 0.3
EPSL = 1e-10, EPSU = 1e-10, EPSS = 1e-9
DS = 0.03, DSMAX = 0.03
GCFIND = [1], GCHIND = [1], GCGIND = [2], GCSEGTYP = [2]
GCHGRZIND = [[]]
)";

/// The circle from its contact with the wall.
std::string circle() {
  std::string text = "# PAR(1) = -0.2\n# PAR(2) = 1\n";
  for (int k = 0; k <= 64; ++k) {
    const double t = 2.0 * M_PI * k / 64;
    char row[160];
    std::snprintf(row, sizeof row, "%.15f %.15f %.15f 0\n", t, std::cos(t), std::sin(t));
    text += row;
  }
  return text;
}

void enter(const Workspace& workspace) {
  std::filesystem::copy_file(SYMMETRIC_LIBRARY, workspace.file("symmetric.so"));
  workspace.write("gc.symmetric", constants);
  workspace.write("symmetric.dat", circle());
}

void run(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat("run symmetric " + arguments);
  INFO(arguments << '\n' << outcome.text());
  REQUIRE(outcome.status == 0);
}

/// One BP at mu = 0, no other special point, nothing noted but shorter steps.
void check_branch_point(const Workspace& workspace, const std::string& name) {
  const SolutionEntry found = only(workspace, name, "BP");
  CHECK(std::abs(found.parameter(1)) < 1e-6);
  CHECK(std::abs(found.parameter(2) - 1.0) < 1e-6);
  for (const DiagnosticPoint& point : read_diagnostics(workspace.read("d." + name))) {
    INFO("point " << point.point);
    CHECK((point.type.empty() || point.type == "EP" || point.type == "BP"));
    for (const std::string& note : point.notes) CHECK(note.find("Possible special point") == std::string::npos);
  }
}

}  // namespace

TEST_CASE("symmetry breaking on a grazing curve: located with any step, passed on the symmetric branch") {
  const Workspace workspace;
  enter(workspace);
  for (const double largest : {0.0015, 0.004, 0.01, 0.03, 0.07, 0.2, 0.6})
    for (const char* mesh : {"", " NTST=50 NCOL=5"}) {
      INFO("DSMAX = " << largest << mesh);
      const std::string steps = " NMX=2000 DSMAX=" + std::to_string(largest) + mesh;
      run(workspace, "DS=" + std::to_string(largest) + steps);
      check_branch_point(workspace, "symmetric");
      for (const PointRow& row : rows_of(workspace.points("symmetric"))) CHECK(row.values[2] == Approx(1.0));
      // And back from the other side.
      run(workspace, "-s symmetric -o back IRS=EP2 DS=-" + std::to_string(largest) + steps);
      check_branch_point(workspace, "back");
    }
}

TEST_CASE("symmetry breaking on a grazing curve: restart, and both sides of the other branch by ISW = -1") {
  const Workspace workspace;
  enter(workspace);
  run(workspace, "");
  run(workspace, "-s symmetric -o again IRS=BP1 NMX=1");
  CHECK(first_iterations(workspace.read("d.again")) <= 1);
  CHECK(difference(only(workspace, "symmetric", "BP"), workspace.solutions("again").front()) < 2e-10);

  run(workspace, "-s symmetric -o sides IRS=BP1 ISW=-1 --both NPR=1");
  int up = 0, down = 0;
  for (const SolutionEntry& solution : workspace.solutions("sides")) {
    const double z = solution.states.front().at(2);
    INFO("z = " << z);
    CHECK(solution.parameter(1) == Approx(z * z).margin(1e-9));
    CHECK(solution.parameter(2) == Approx(wall(z)).epsilon(1e-9));
    (z > 0.0 ? up : down) += 1;
  }
  CHECK(up > 5);
  CHECK(down > 5);
  // Each side is a branch of its own.
  const auto sections = workspace.points("sides");
  REQUIRE(sections.size() == 2);
  CHECK(std::abs(sections[0].rows.back().values[2] - sections[1].rows.back().values[2]) > 0.1);

  // Back along one side, through the branch point, to the other one.
  run(workspace, "-s sides -o through IRS=EP1 DS=-0.03");
  check_branch_point(workspace, "through");
  const auto ends = workspace.solutions("through");
  CHECK(ends.front().states.front().at(2) * ends.back().states.front().at(2) <= 0.0);
  CHECK(std::abs(ends.back().states.front().at(2)) > 0.5);
}
