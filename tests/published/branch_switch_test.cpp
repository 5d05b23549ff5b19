// Branch points that are hard to meet on coarse meshes: located, and left for the other branch.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "published/chain.hpp"

using namespace test_support;

namespace {

void enter(const Workspace& workspace, const std::string& library, const std::string& name) {
  std::filesystem::copy_file(library, workspace.file(name + ".so"));
  const Outcome simulated = workspace.tchat("simulate " + name + " --dat " + name);
  INFO(simulated.text());
  REQUIRE(simulated.status == 0);
}

void run(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat("run " + arguments);
  INFO(arguments << '\n' << outcome.text());
  REQUIRE(outcome.status == 0);
}

/// How far the first duration is from that of the symmetric orbit, at every point.
std::vector<double> asymmetry(const Workspace& workspace, const std::string& name) {
  std::vector<double> result;
  for (const SolutionEntry& solution : workspace.solutions(name))
    result.push_back(solution.parameter(61) * solution.parameter(2) / M_PI - 1.0);
  return result;
}

}  // namespace

TEST_CASE("two walls: ISW = -1 leaves the symmetric orbit to both sides, on any mesh") {
  const Workspace workspace;
  enter(workspace, TWO_SIDED_LIBRARY, "two_sided");
  for (const int mesh : {10, 15, 20, 25, 30, 40})
    for (const char* parameter : {"[F] DS=0.02 RL1=3.6", "[omega] DS=-0.02 RL0=1.8"}) {
      INFO("NTST = " << mesh << ", " << parameter);
      const std::string size = " NTST=" + std::to_string(mesh);
      run(workspace, "two_sided -d two_sided -o symmetric" + size + " ICP=" + parameter);
      REQUIRE(of_type(read_diagnostics(workspace.read("d.symmetric")), "BP").size() == 1);
      std::vector<std::vector<double>> sides;
      for (const char* step : {"0.01", "-0.01"}) {
        run(workspace, "two_sided -c r.symmetric -s symmetric -o side IRS=BP1 ISW=-1 NMX=6 NPR=1 RL0=0 RL1=9" + size +
                           " DSMAX=0.1 DS=" + step);
        sides.push_back(asymmetry(workspace, "side"));
      }
      REQUIRE(sides[0].size() == sides[1].size());
      REQUIRE(sides[0].size() >= 5);
      for (std::size_t k = 0; k < sides[0].size(); ++k) {
        CHECK(std::abs(sides[0][k]) > (k == 0 ? 1e-3 : std::abs(sides[0][k - 1])));
        CHECK(sides[0][k] + sides[1][k] == Approx(0.0).margin(1e-2 * std::abs(sides[0][k])));  // its mirror image
      }
    }
}

TEST_CASE("coupled pendula: the branch points of the rotations out of phase, on coarse meshes, EPSS loose or tight") {
  const Workspace workspace;
  enter(workspace, PENDULA_LIBRARY, "pendula");
  for (const int mesh : {20, 30})
    for (const char* tolerance : {"1e-4", "1e-6", "1e-9"}) {
      INFO("NTST = " << mesh << ", EPSS = " << tolerance);
      const std::string size = " NTST=" + std::to_string(mesh);
      run(workspace, "pendula -d pendula -o in_phase ICP=[I] DS=-0.01 NMX=40" + size);
      run(workspace,
          "pendula -c r.in_phase -s in_phase -o out_of_phase IRS=PD1 ISW=-1 DS=-0.01 DSMAX=0.5 NMX=90 "
          "RL0=0.1 RL1=15 EPSS=" +
              std::string(tolerance) + size);
      const auto points = of_type(read_diagnostics(workspace.read("d.out_of_phase")), "BP");
      REQUIRE(points.size() == 2);
      // AUTO-07p: I = 0.17551.
      const auto solutions = workspace.solutions("out_of_phase");
      CHECK(with_label(solutions, points[1].label).parameter(3) == Approx(0.17551).margin(1e-5).epsilon(0));
    }
}
