// The chain of problems/linosc as a user runs it: make -j2, every label restarts, equal runs write equal files.
#include <catch2/catch.hpp>

#include "published/makefile_run.hpp"

using namespace test_support;

namespace {

const std::vector<std::string> branches{"grazing",    "grazing_curve",         "impacting_20072", "impacting_18901",
                                        "unphysical", "period_doubling_curve", "fold_curve",      "doubled"};

void run_chain(const Workspace& workspace, const std::string& changes) {
  run_impacting(workspace, "20072");
  workspace.run("-c impacting_18901 -s grazing_curve -o impacting_18901");
  workspace.run("-c unphysical -s grazing_curve -o unphysical");
  workspace.run("-c period_doubling_curve -s impacting_20072 -o period_doubling_curve --both" + changes);
  workspace.run("-c fold_curve -s impacting_18901 -o fold_curve --both" + changes);
  workspace.run("-c doubled -s impacting_20072 -o doubled" + changes);
}

void check_restarts(const Workspace& workspace) {
  for (const std::string& name : branches)
    for (const SolutionEntry& stored : workspace.solutions(name)) {
      INFO(name << " label " << stored.label << " type " << stored.type);
      workspace.run("-c r." + name + " -s " + name + " -o again NMX=1 IRS=" + std::to_string(stored.label));
      CHECK(first_iterations(workspace.read("d.again")) <= 1);
      CHECK(difference(stored, workspace.solutions("again").front()) < 2e-10);
    }
}

}  // namespace

TEST_CASE("every label of every file restarts with at most one Newton step") {
  const Workspace workspace;
  run_chain(workspace, "");
  check_restarts(workspace);
}

TEST_CASE("every label restarts where the curves run on into inadmissible orbits") {
  const Workspace workspace;
  run_chain(workspace, " GRSTOP=0");
  check_restarts(workspace);
}

TEST_CASE("make -j2 in problems/linosc: the files of the chain") {
  const MakefileRun chain("linosc");
  chain.check_repeatable();
  chain.check_verified();
  for (const std::string& name : branches)
    for (const char* letter : {"p.", "q.", "d.", "r."}) CHECK(chain.read(letter + name).size() > 100);
  for (const char* orbit : {"orbit_5_7a", "orbit_5_7b", "orbit_5_8a", "orbit_5_8b", "orbit_5_10"})
    CHECK(chain.read(orbit).size() > 100);
  // Simulation from rest finds the orbit whose closed form is in the published values.
  const SolutionEntry start = chain.solutions("grazing").front();
  const double expected[] = {0.997785157856609, 0.0, 0.066519010523774, -0.997785157856609};
  for (std::size_t i = 0; i < 4; ++i) check_near(start.states.front()[i], expected[i]);
  check_near(start.parameter(61), 3.141592653589793);
  CHECK(first_iterations(chain.read("d.grazing")) <= 4);
}
