// What cannot be stored or printed is told, and what was there before stays.
#include <catch2/catch.hpp>
#include <filesystem>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

const std::string few_points = "run linosc -c impacting -d impacting -o branch NMX=3 NPR=1 NTST=10";

}  // namespace

TEST_CASE("output lost on a full or closed standard output is told") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o start NMX=3 NPR=1 NTST=100");
  for (const std::string& command :
       {std::string("labels q.start"), std::string("orbit q.start 1"), std::string("constants impacting"),
        std::string("constants"), std::string("check linosc"), std::string("--help"), few_points}) {
    for (const std::string redirection : {"> /dev/full", ">&-"}) {
      INFO(command << " " << redirection);
      const Outcome outcome = workspace.tchat_redirected(command, redirection);
      CHECK(outcome.signal == 0);
      CHECK(outcome.status == 1);
      CHECK(outcome.err.find("standard output cannot be written") != std::string::npos);
      CHECK(outcome.err.find("internal error") == std::string::npos);
    }
  }
  // The files of the run are complete all the same.
  CHECK(labels_of(workspace.points("branch")) == labels_of(workspace.solutions("branch")));
  CHECK(workspace.tchat_redirected(few_points + " -q", ">&-").status == 0);
  CHECK(workspace.tchat_redirected("labels q.start", "> /dev/null").status == 0);
}

TEST_CASE("a folder where the old file is to be kept: refused, nothing is lost") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch NMX=3");
  workspace.tchat("dat linosc -c impacting -d impacting -o data");
  for (const std::string name : {"branch", "data"}) {
    const std::string before = workspace.read("q." + name);
    std::filesystem::create_directory(workspace.file("q." + name + "~"));
    for (const std::string command :
         {"run linosc -c impacting -d impacting NMX=4 -o ", "dat linosc -c impacting -d impacting NTST=11 -o ",
          "resegment q.start 1 --to double -c impacting -p linosc -o "}) {
      INFO(command << name);
      workspace.tchat("dat linosc -c impacting -d impacting -o start");
      const Outcome outcome = workspace.tchat(command + name);
      CHECK(outcome.status == 2);
      CHECK(outcome.err.find("q." + name + "~") != std::string::npos);
      CHECK(outcome.err.find("is a directory") != std::string::npos);
      CHECK(workspace.read("q." + name) == before);
      CHECK_FALSE(workspace.has("p." + name + "~"));
    }
  }
}

TEST_CASE("starting data in place of a run's solutions: the run is kept as a whole") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch NMX=3");
  workspace.run("-c impacting -d impacting -o branch NMX=4");
  const std::string points = workspace.read("p.branch"), solutions = workspace.read("q.branch");
  CHECK(workspace.tchat("dat linosc -c impacting -d impacting -o branch").status == 0);
  CHECK(workspace.read("p.branch~") == points);
  CHECK(workspace.read("q.branch~") == solutions);
  CHECK(workspace.read("q.branch") != solutions);
  workspace.run("-c impacting -d impacting -o branch NMX=5");
  CHECK(workspace.read("p.branch~") == points);
  CHECK(workspace.read("q.branch~") == solutions);
}

TEST_CASE("a label that leaves no room for further ones is refused") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch NMX=3 NTST=10");
  std::string solutions = workspace.read("q.branch");
  solutions.replace(18, 6, " 2147483647");
  workspace.write("q.branch", solutions);
  for (const char* arguments : {"-s branch -o on IRS=2147483647", "-d impacting -o branch --append"}) {
    const Outcome outcome = workspace.tchat(std::string("run linosc -c impacting NTST=10 ") + arguments);
    CHECK(outcome.status == 2);
    CHECK(outcome.err.find("label 2147483647") != std::string::npos);
  }
}

TEST_CASE("IPLT of any size is refused or has its column") {
  const Workspace workspace;
  for (const char* const measure : {"2147483647", "-2147483647", "-2147483648"}) {
    const Outcome outcome = workspace.tchat(few_points + " IPLT=" + measure);
    CHECK(outcome.status == 2);
    CHECK(outcome.err.find("IPLT") != std::string::npos);
  }
  CHECK(workspace.tchat(few_points + " IPLT=0").status == 0);
  CHECK(workspace.points("branch").front().names[1] == "L2-NORM");
}
