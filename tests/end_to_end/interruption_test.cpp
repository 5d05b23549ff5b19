// Runs that are stopped from outside: what they leave can be read, and what was there before is not lost.
#include <signal.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>
#include <sstream>
#include <string>
#include <thread>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

// A branch that takes far longer than any test waits.
const std::string endless =
    "run linosc -c impacting -d impacting -o branch NMX=1000000 DS=1e-6 DSMAX=1e-6 NPR=3 NTST=100 UZR={}";

/// Until q.branch, written after `begun`, has so many bytes.
void wait_for_points(const Workspace& workspace, Process& process, std::size_t bytes,
                     std::filesystem::file_time_type begun = std::filesystem::file_time_type::min()) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  const auto is_there = [&] {
    std::error_code none;  // of a file that is being replaced
    return workspace.has("q.branch") && std::filesystem::last_write_time(workspace.file("q.branch"), none) > begun &&
           workspace.read("q.branch").size() >= bytes;
  };
  while (!is_there()) {
    REQUIRE_FALSE(process.ended());
    REQUIRE(std::chrono::steady_clock::now() < deadline);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

constexpr std::size_t some_solutions = 400'000;

void kill(Process& process) {
  process.send(SIGKILL);
  CHECK(process.wait(std::chrono::seconds(30)).signal == SIGKILL);
}

/// Up to the end of the last whole line.
std::string whole_lines(const std::string& text) { return text.substr(0, text.rfind('\n') + 1); }

/// A q-file up to the end of its last whole entry: the ninth number of an entry's first line counts the lines after it.
std::string whole_entries(const std::string& text) {
  std::size_t end = 0;
  for (std::size_t at = 0;; end = at) {
    std::istringstream first(text.substr(at, text.find('\n', at) - at));
    int lines = 0;
    for (int k = 0; k < 9; ++k) first >> lines;
    if (!first) return text.substr(0, end);
    for (int k = 0; k <= lines; ++k) {
      const auto newline = text.find('\n', at);
      if (newline == std::string::npos) return text.substr(0, end);
      at = newline + 1;
    }
  }
}

bool is_complete(const std::string& diagnostics) {
  return diagnostics.size() > 11 && diagnostics.compare(diagnostics.size() - 11, 11, "end of run\n") == 0;
}

}  // namespace

TEST_CASE("Ctrl-C and SIGTERM end the branch with EP and complete files") {
  struct Stop {
    int signal, status;
  };
  for (const Stop& stop : {Stop{SIGINT, 130}, Stop{SIGTERM, 143}}) {
    const Workspace workspace;
    const auto process = workspace.start_tchat(endless);
    wait_for_points(workspace, *process, some_solutions);
    process->send(stop.signal);
    const Outcome outcome = process->wait(std::chrono::seconds(30));
    CHECK_FALSE(outcome.timed_out);
    CHECK(outcome.signal == 0);
    CHECK(outcome.status == stop.status);
    CHECK(outcome.out.find("interrupted") != std::string::npos);
    const auto sections = workspace.points("branch");
    const auto solutions = workspace.solutions("branch");
    CHECK(sections.front().rows.back().type == 9);
    CHECK(solutions.back().type == 9);
    CHECK(labels_of(sections) == labels_of(solutions));
    CHECK(is_complete(workspace.read("d.branch")));
    workspace.run("-c impacting -s branch -o on NMX=3 NTST=100 IRS=" + std::to_string(solutions.back().label));
  }
}

TEST_CASE("a signal stops --both in both directions at once") {
  const Workspace workspace;
  const auto process = workspace.start_tchat(endless + " --both");
  wait_for_points(workspace, *process, some_solutions);
  process->send(SIGINT);
  CHECK(process->wait(std::chrono::seconds(30)).status == 130);
  CHECK(workspace.points("branch").size() == 1);
}

TEST_CASE("after SIGKILL the files load, an incomplete set never replaces a complete one") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch NMX=5");
  const std::string complete = workspace.read("q.branch");
  for (int attempt = 0; attempt < 2; ++attempt) {
    const auto begun = std::filesystem::file_time_type::clock::now();
    const auto process = workspace.start_tchat(endless);
    wait_for_points(workspace, *process, some_solutions, begun);  // not those that the last one left
    kill(*process);
    CHECK_FALSE(is_complete(workspace.read("d.branch")));
    // A kill within a write leaves a part of an entry, which is left out with a warning.
    const std::string text = workspace.read("q.branch"), whole = whole_entries(text);
    const Outcome listed = workspace.tchat("labels q.branch");
    CHECK(listed.status == 0);
    // Blanks, as the first line of an entry begins with, are no part of one.
    const bool is_cut = text.find_first_not_of(" \n", whole.size()) != std::string::npos;
    CHECK((listed.err.find("not complete and is left out") != std::string::npos) == is_cut);
    CHECK(listed.err.empty() == !is_cut);
    const auto solutions = read_solutions(whole);
    CHECK(solutions.size() > 3);
    // The p-file is behind the q-file by at most one solution.
    const auto labels = labels_of(read_points(whole_lines(workspace.read("p.branch"))));
    CHECK(labels.size() <= solutions.size());
    CHECK(labels.size() + 1 >= solutions.size());
    CHECK(workspace.read("q.branch~") == complete);
  }
  workspace.run("-c impacting -s branch -o on NMX=3 NTST=100 IRS=2");
  workspace.run("-c impacting -d impacting -o branch NMX=4");
  CHECK(workspace.read("q.branch~") == complete);
  workspace.run("-c impacting -d impacting -o branch NMX=3");
  CHECK(workspace.read("q.branch~") != complete);
}

TEST_CASE("two runs with one output name: the second is refused while the first goes on") {
  const Workspace workspace;
  const auto process = workspace.start_tchat(endless + " NPR=200");  // the others wait: few labels, or 200 MB
  wait_for_points(workspace, *process, 1);
  for (const std::string second : {"run linosc -c impacting -d impacting -o branch NMX=3",
                                   "run linosc -c impacting -d impacting -o branch --append NMX=3",
                                   "dat linosc -c impacting -d impacting -o branch"}) {
    const Outcome outcome = workspace.tchat(second);
    CHECK(outcome.status == 2);
    CHECK(outcome.err.find("another tchat (process ") != std::string::npos);
    CHECK(outcome.err.find("-o") != std::string::npos);
  }
  workspace.run("-c impacting -d impacting -o other NMX=3");
  process->send(SIGINT);
  CHECK(process->wait(std::chrono::seconds(30)).status == 130);
  CHECK(labels_of(workspace.points("branch")) == labels_of(workspace.solutions("branch")));
  workspace.run("-c impacting -d impacting -o branch NMX=3");
}

TEST_CASE("a complete set, an --append that is killed, a plain run: the set is kept") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch NMX=3");
  workspace.run("-c impacting -d impacting -o branch NMX=5");
  const std::string points = workspace.read("p.branch"), solutions = workspace.read("q.branch");
  const auto process = workspace.start_tchat(endless + " --append");
  wait_for_points(workspace, *process, solutions.size() + some_solutions);
  kill(*process);
  workspace.run("-c impacting -d impacting -o branch NMX=4");
  CHECK(workspace.read("p.branch~").compare(0, points.size(), points) == 0);
  CHECK(workspace.read("q.branch~").compare(0, solutions.size(), solutions) == 0);
}

TEST_CASE("a q-file cut anywhere in its last solution gives a warning and the solutions before") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch NMX=9 NPR=4 NTST=10");
  const std::string whole = workspace.read("q.branch");
  const auto solutions = workspace.solutions("branch");
  REQUIRE(solutions.size() >= 3);
  for (const std::size_t lost : {1u, 2u, 40u, 500u, 3000u}) {
    INFO(lost << " bytes lost");
    workspace.write("q.cut", whole.substr(0, whole.size() - lost));
    const Outcome outcome = workspace.tchat("labels q.cut");
    CHECK(outcome.status == 0);
    const Outcome run = workspace.tchat("run linosc -c impacting -s cut -o on NTST=10 NMX=2 IRS=2");
    CHECK(run.status == 0);
    if (lost > 1) CHECK(outcome.err.find("q.cut") != std::string::npos);
    if (lost > 1) CHECK(run.err.find("warning") != std::string::npos);
  }
}

TEST_CASE("appending to an incomplete set mends it first") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch NMX=9 NPR=4 NTST=10");
  for (const char* name : {"p.branch", "q.branch", "d.branch"}) {
    const std::string text = workspace.read(name);
    workspace.write(name, text.substr(0, text.size() - 30));
  }
  workspace.run("-c impacting -d impacting -o branch --append NMX=9 NPR=4 NTST=10");
  const auto sections = workspace.points("branch");
  CHECK(sections.size() == 2);
  const auto labels = labels_of(workspace.solutions("branch"));
  for (std::size_t k = 1; k < labels.size(); ++k) CHECK(labels[k] > labels[k - 1]);
}

TEST_CASE("a full disk ends the run with status 1 and files that load") {
  const Workspace workspace;
  const Outcome outcome = workspace.tchat_on_small_disk(200, "run linosc -c impacting -d impacting -o branch NPR=2");
  INFO(outcome.text());
  CHECK(outcome.signal == 0);
  CHECK(outcome.status == 1);
  CHECK(outcome.err.find("q.branch") != std::string::npos);
  CHECK(outcome.err.find("cannot be written") != std::string::npos);
  const auto solutions = workspace.solutions("branch");
  CHECK(solutions.size() >= 2);
  CHECK_FALSE(is_complete(workspace.read("d.branch")));
  workspace.run("-c impacting -s branch -o on NMX=2 IRS=" + std::to_string(solutions.back().label));
}

TEST_CASE("Ctrl-C while the plugin is compiled") {
  const Workspace workspace(Workspace::Plugin::source);
  const auto process = workspace.start_tchat(endless);
  const auto begun = [&] { return workspace.has(".linosc.so.lock"); };
  for (int k = 0; k < 5000 && !begun(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  process->send(SIGINT);
  CHECK(process->wait(std::chrono::seconds(60)).status == 130);
}

TEST_CASE("a folder that cannot be written is refused before anything is computed") {
  const Workspace workspace;
  const Outcome missing = workspace.tchat("run linosc -c impacting -d impacting -o nowhere/branch");
  CHECK(missing.status == 2);
  CHECK(missing.err.find("nowhere/p.branch") != std::string::npos);
}
