// tchat sweep --map: composite maps of the linear oscillator's grazing orbit, and what is refused.
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "end_to_end/bad_input.hpp"
#include "simulate/sweep_file.hpp"

using namespace test_support;

namespace {

/// The orbit without impact of amplitude 1: label 2 of q.smooth.
double run_to_contact(const Workspace& workspace) {
  workspace.run("-c to_grazing -d nonimpacting -o smooth -q");
  return workspace.solutions("smooth").back().parameter(1);
}

}  // namespace

TEST_CASE(
    "sweep of a map: without contact the penetration is that of the linear response, and contact begins at zero") {
  const Workspace workspace;
  const double grazing = run_to_contact(workspace);
  const std::string over =
      "--over alpha=" + std::to_string(grazing - 0.2) + ":" + std::to_string(grazing - 0.001) + ":9";
  const Outcome outcome = workspace.succeed("sweep linosc --map q.smooth:GR1 " + over + " --lyapunov -o below");
  CHECK(contains(outcome.out, "Composite map of label 2 of q.smooth"));
  const tchat::SweepTable table = tchat::read_sweep_file(workspace.file("below.sweep"));
  REQUIRE(table.rows() == 9);
  for (std::size_t i = 0; i < table.rows(); ++i) {
    // The amplitude is proportional to alpha: the first order of P_smooth is exact.
    const double alpha = (*table.column("alpha"))[i];
    CHECK((*table.column("penetration"))[i] == Approx(alpha / grazing - 1.0).margin(1e-8));
    CHECK((*table.column("impacts"))[i] == 0.0);
    CHECK(table.kinds[i] == tchat::AttractorKind::periodic);
    // Free oscillations decay as exp(-zeta t).
    CHECK((*table.column("lambda1"))[i] == Approx(-0.05).margin(1e-6));
    CHECK((*table.column("lambda2"))[i] == Approx(-0.05).margin(1e-6));
  }
  const std::string above =
      "--over alpha=" + std::to_string(grazing + 1e-4) + ":" + std::to_string(grazing + 2e-4) + ":2";
  workspace.succeed("sweep linosc --map q.smooth:GR1 " + above + " -o above");
  const tchat::SweepTable beyond = tchat::read_sweep_file(workspace.file("above.sweep"));
  // Beyond it some return of each value is in contact.
  for (const double index : {0.0, 1.0}) {
    double largest = -1.0;
    for (std::size_t i = 0; i < beyond.rows(); ++i)
      if ((*beyond.column("index"))[i] == index) largest = std::max(largest, (*beyond.column("penetration"))[i]);
    CHECK(largest > 0.0);
  }
}

TEST_CASE("sweep of a map: the same bytes for two workers and in parts") {
  const Workspace workspace;
  const double grazing = run_to_contact(workspace);
  const std::string arguments =
      "sweep linosc --map q.smooth:GR1 --order 1 --over alpha=" + std::to_string(grazing - 0.01) + ":" +
      std::to_string(grazing + 0.002) + ":40 -q";
  workspace.succeed(arguments + " -o one");
  workspace.succeed(arguments + " -o two -j 2");
  for (const char* part : {"1/3", "2/3", "3/3"}) workspace.succeed(arguments + " -o three --part " + part);
  workspace.succeed(arguments + " -o three --gather");
  CHECK(workspace.read("one.sweep") == workspace.read("two.sweep"));
  CHECK(workspace.read("one.sweep") == workspace.read("three.sweep"));
}

TEST_CASE("sweep of a map: what is refused") {
  const Workspace workspace;
  run_to_contact(workspace);
  const auto refused = [&](const std::string& arguments, const std::vector<std::string>& parts) {
    INFO("tchat sweep linosc " << arguments);
    check_refused(workspace.tchat("sweep linosc " + arguments), parts);
    CHECK_FALSE(workspace.has("linosc.sweep"));
  };
  const std::string map = "--map q.smooth:GR1 ";
  const std::string over = "--over alpha=1:2:3 ";
  refused(over + "--map q.smooth:GR7", {"q.smooth", "GR7", "1 (EP)"});
  refused(over + "--map q.smooth:1", {"label 1 of q.smooth", "no grazing point"});
  refused(over + "--map q.nosuch:GR1", {"q.nosuch", "no such file"});
  refused(over + "--map nosuch.events", {"nosuch.events", "no such file", "O.events"});
  refused("--map q.smooth:GR1 --over x1=0:1:3", {"no parameter is swept", "--over mu="});
  refused(map + over + "--order 2", {"--order 2", "1/2, 1, 3/2, exact"});
  refused(map + over + "--smooth-order 3", {"--smooth-order"});
  refused(map + over + "--reduced", {"--reduced", "torus"});
  refused(map + over + "--section wall", {"tangent", "wall"});
  refused(map + over + "--section 9", {"--section 9", "no such event function or state"});
  refused(map + over + "--lyapunov 4", {"--lyapunov 4", "3 exponents"});
  refused(map + over + "--time 5", {"--map and --time", "--events"});
  refused(map + over + "--mode 1,1,1", {"--map and --mode"});
  refused(map + over + "-d nonimpacting", {"--map and -d", "--state"});
  refused(map + over + "--follow sideways", {"--follow sideways"});
  workspace.write("short.events", "1 1 2 2 0.5 0 -1 1 0 0 1 1 0 0 1 event\n");
  refused(over + "--map short.events --wall 1 --section 2", {"short.events", "1 points", "too few"});
  workspace.write("wide.events", "1 1 2 2 0.5 0 -1 1 0 0 1 1 0 0 event\n");
  refused(over + "--map wide.events --wall 1", {"wide.events:1", "15 columns", "16"});
  workspace.write("other.events", "1 1 17 2 0.5 0 -1 1 0 0 1 1 0 0 1 event\n");
  refused(over + "--map other.events --wall 1", {"other.events:1", "event function 17", "another problem"});
  workspace.write("word.events", "1 1 2 2 0.5 0 -1 1 zero 0 1 1 0 0 1 event\n");
  refused(over + "--map word.events --wall 1", {"word.events:1", "'zero'"});
  workspace.write("empty.events", "# nothing\n");
  refused(over + "--map empty.events --wall 1", {"empty.events", "no event"});
}
