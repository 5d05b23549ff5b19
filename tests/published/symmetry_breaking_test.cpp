// A branch point on a grazing curve: the grazing orbit of a symmetric field loses its symmetry. It is located whatever
// the step, passed, restarted from, and left for the other branch by ISW = -1 to both sides.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <tuple>

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

/// The branch stays on the orbits of z = 0, p = 1, and comes out on the other side of mu = 0.
void check_symmetric(const Workspace& workspace, const std::string& name) {
  const auto sections = workspace.points(name);
  REQUIRE(sections.size() == 1);
  const PointSection& section = sections.front();
  for (const PointRow& row : section.rows) {
    CHECK(std::abs(row.values[section.column("MAX z")]) < 1e-6);
    CHECK(std::abs(row.values[section.column("p")] - 1.0) < 1e-6);
  }
  const std::size_t mu = section.column("mu");
  CHECK(section.rows.front().values[mu] * section.rows.back().values[mu] < 0.0);
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
      check_symmetric(workspace, "symmetric");
      // And back from the other side: the end lies beyond RL1, by up to a step.
      run(workspace, "-s symmetric -o back IRS=EP2 RL1=1 DS=-" + std::to_string(largest) + steps);
      check_branch_point(workspace, "back");
      check_symmetric(workspace, "back");
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
  const std::size_t z_column = sections[0].column("MAX z");
  for (const PointSection& section : sections)
    for (const PointRow& row : section.rows) CHECK(row.values[z_column] * section.rows.back().values[z_column] > 0.0);
  CHECK(sections[0].rows.back().values[z_column] * sections[1].rows.back().values[z_column] < 0.0);

  // From the end of either side, beyond RL1, back through the branch point to the other one, with any step.
  for (const auto& [end, z_sign] : {std::pair{"EP1", 1.0}, std::pair{"EP2", -1.0}})
    for (const double largest : {0.0015, 0.004, 0.03, 0.1, 0.3}) {
      INFO("from " << end << ", DSMAX = " << largest);
      const std::string step = std::to_string(largest);
      run(workspace,
          std::string("-s sides -o through RL1=0.4 NMX=2000 IRS=") + end + " DS=-" + step + " DSMAX=" + step);
      check_branch_point(workspace, "through");
      const PointSection through = workspace.points("through").front();
      CHECK(z_sign * through.rows.front().values[z_column] > 0.1);
      CHECK(z_sign * through.rows.back().values[z_column] < -0.5);
    }
}
