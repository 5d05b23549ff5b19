// Too little memory from the start: a sentence and status 1 as soon as the program itself runs. Below that the dynamic
// loader and the constructors of libraries end the process (status 127, or a signal in the constructor of libgfortran).
#include <catch2/catch.hpp>

#include "end_to_end/bad_input.hpp"

using namespace test_support;

namespace {

constexpr int step = 64;  // kB
constexpr int enough = 200'000;

/// The least of these limits with which --version is printed.
int least_limit(const Workspace& workspace) {
  for (int kilobytes = 4096; kilobytes < enough; kilobytes += step)
    if (workspace.tchat_in_memory(kilobytes, "--version").status == 0) return kilobytes;
  FAIL("--version needs more than " << enough << " kB");
  return enough;
}

}  // namespace

TEST_CASE("no memory is a sentence with status 1, in labels, constants and run") {
  const Workspace workspace;
  workspace.run("-q -c impacting -d impacting -o branch NMX=3");
  const int least = least_limit(workspace) + step;
  for (const std::string arguments :
       {"labels q.branch", "constants impacting", "run linosc -q -c impacting -d impacting -o other NMX=3"}) {
    int failures = 0;
    bool succeeds = false;
    for (int kilobytes = least; kilobytes < enough && !succeeds; kilobytes += step) {
      const Outcome outcome = workspace.tchat_in_memory(kilobytes, arguments);
      INFO(arguments << " in " << kilobytes << " kB\n" << outcome.text());
      CHECK(outcome.signal == 0);
      succeeds = outcome.status == 0;
      if (succeeds) break;
      ++failures;
      CHECK(outcome.status == 1);
      CHECK(contains(outcome.err, "memory"));
      CHECK_FALSE(contains(outcome.err, "internal error"));
    }
    CHECK(succeeds);
    if (arguments.starts_with("run")) CHECK(failures > 3);
  }
}

TEST_CASE("threads that cannot be started are no fault of the plugin") {
  const Workspace workspace;
  workspace.write("clock.tch",
                  "par rate=1\ninit x=1\nx' = -rate\nevent zero = x\njump reset: x -> 1\nafter any: zero -> reset\n");
  REQUIRE(workspace.tchat("check clock").status == 0);
  // 999 stacks of 8 MB do not fit into 3 GB.
  const Outcome outcome = workspace.tchat_in_memory(3'000'000, "sweep clock --over rate=1:2:2000 -j 999");
  INFO(outcome.text());
  CHECK(outcome.status == 1);
  CHECK(contains(outcome.err, "of 999 threads can be started"));
  CHECK(contains(outcome.err, "(-j "));
  CHECK_FALSE(contains(outcome.err, "plugin"));
}
