#include "files/run_files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include "base/messages.hpp"
#include "files/diagnostics_file.hpp"
#include "files/file_size_limit.hpp"
#include "files/sample_orbits.hpp"
#include "files/solution_file.hpp"
#include "files/solution_file_reader.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using test_support::message_of;
using test_support::TemporaryFolder;

namespace {

std::string entry(int label) {
  LabelledSolution orbit = test_support::sample_orbit(2, 1, 2, 2);
  orbit.label = label;
  return format_solution(orbit);
}

/// A section with one point; `value` tells runs apart.
std::string points(int value, int label) {
  return fmt::format("   0\n   0    PT  TY  LAB             alpha\n   1     1   9{:5}  {}.0000000000E+000\n", label,
                     value);
}

std::string diagnostics(int value, int label) {
  return fmt::format("  BR    PT  TY  LAB         alpha\n   1     1  EP {:4}   {}.00000E+00\n", label, value);
}

/// A run of one point.
void run(const TemporaryFolder& folder, int value, bool complete, RunFiles::Mode mode = RunFiles::Mode::replace) {
  RunFiles files(folder.file("x"), mode);
  files.check_writable();
  files.open(fmt::format("constants {}\n", value));
  const int label = files.last_label() + 1;
  files.add_solution(entry(label));
  files.add_points(points(value, label));
  files.add_diagnostics(diagnostics(value, label));
  if (complete) files.finish();
}

RunSetState state(const TemporaryFolder& folder, const std::string& suffix = "") {
  return run_set_state(folder.file("x"), suffix);
}

/// Which run's points are there: "" without a file.
std::string run_in(const TemporaryFolder& folder, const std::string& suffix) {
  for (int value = 1; value < 9; ++value)
    if (folder.read("p.x" + suffix) == points(value, 1)) return std::to_string(value);
  return folder.has("p.x" + suffix) ? "other" : "";
}

}  // namespace

TEST_CASE("Names of the four files", "[output]") {
  CHECK(output_path('p', "mems") == "p.mems");
  CHECK(output_path('q', "results/mems.2") == "results/q.mems.2");
}

TEST_CASE("Nothing but the lock is created before open") {
  const TemporaryFolder folder;
  {
    RunFiles files(folder.file("x"));
    CHECK(std::filesystem::is_empty(folder.file(".")));
    files.check_writable();
    for (const auto& file : std::filesystem::directory_iterator(folder.file(".")))
      CHECK(file.path().filename() == ".x.lock");
    CHECK_FALSE(files.is_open());
    files.finish();
  }
  CHECK(std::filesystem::is_empty(folder.file(".")));
}

TEST_CASE("A complete run", "[output]") {
  const TemporaryFolder folder;
  run(folder, 1, true);
  CHECK(folder.read("p.x") == points(1, 1));
  CHECK(folder.read("q.x") == entry(1));
  CHECK(folder.read("d.x") == diagnostics(1, 1) + format_end_of_run());
  CHECK(folder.read("r.x") == "constants 1\n");
  CHECK(state(folder) == RunSetState::complete);
  CHECK(state(folder, "~") == RunSetState::absent);
  CHECK_FALSE(folder.has(".x.lock"));
}

TEST_CASE("Blocks are gathered: a label is in the files at once, all others soon") {
  const TemporaryFolder folder;
  RunFiles files(folder.file("x"));
  files.open("");
  files.add_points("first\n");
  files.write_if_due();  // nothing was written before
  CHECK(folder.read("p.x") == "first\n");
  files.add_points("point\n");
  files.add_diagnostics("note\n");
  CHECK(folder.read("p.x") == "first\n");
  files.add_solution(entry(1));
  files.write_if_due();
  CHECK(folder.read("p.x") == "first\npoint\n");
  CHECK(read_solution_file(folder.file("q.x")).solutions.size() == 1);
  CHECK(folder.read("d.x") == "note\n");
  const std::string many(300'000, '-');
  files.add_diagnostics(many);
  files.write_if_due();
  CHECK(folder.read("d.x") == "note\n" + many);
  files.add_points("late\n");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  files.write_if_due();
  CHECK(folder.read("p.x") == "first\npoint\nlate\n");
}

TEST_CASE("What was gathered is written when a run ends by an exception") {
  const TemporaryFolder folder;
  try {
    RunFiles files(folder.file("x"));
    files.open("");
    files.add_points("point\n");
    files.add_diagnostics("note\n");
    throw ComputationError("no memory");
  } catch (const ComputationError&) {
  }
  CHECK(folder.read("p.x") == "point\n");
  CHECK(folder.read("d.x") == "note\n");
}

TEST_CASE("A complete run is kept as p.x~ when another replaces it", "[output]") {
  const TemporaryFolder folder;
  run(folder, 1, true);
  run(folder, 2, true);
  CHECK(run_in(folder, "") == "2");
  CHECK(run_in(folder, "~") == "1");
  CHECK(state(folder, "~") == RunSetState::complete);
  CHECK(folder.read("r.x~") == "constants 1\n");
  run(folder, 3, true);
  CHECK(run_in(folder, "~") == "2");
  CHECK(state(folder, "~") == RunSetState::complete);
}

TEST_CASE("An incomplete run never replaces a complete p.x~", "[output]") {
  const TemporaryFolder folder;
  run(folder, 1, true);
  run(folder, 2, false);
  CHECK(state(folder) == RunSetState::interrupted);
  run(folder, 3, true);
  CHECK(run_in(folder, "") == "3");
  CHECK(run_in(folder, "~") == "1");
  CHECK(folder.read("d.x~") == diagnostics(1, 1) + format_end_of_run());
  run(folder, 4, true);
  CHECK(run_in(folder, "~") == "3");
}

TEST_CASE("An incomplete run is kept while there is nothing better", "[output]") {
  const TemporaryFolder folder;
  run(folder, 1, false);
  run(folder, 2, false);
  CHECK(run_in(folder, "~") == "1");
  run(folder, 3, true);
  CHECK(run_in(folder, "~") == "2");
  run(folder, 4, false);
  CHECK(run_in(folder, "~") == "3");
}

TEST_CASE("A complete set is complete in all of its files, not in the last line of one") {
  const TemporaryFolder folder;
  run(folder, 1, true);
  const std::string solutions = folder.read("q.x");
  folder.write("q.x", solutions.substr(0, solutions.size() / 2));
  CHECK(state(folder) == RunSetState::foreign);
  folder.write("q.x", solutions);
  CHECK(state(folder) == RunSetState::complete);
  folder.write("p.x", points(1, 7));
  CHECK(state(folder) == RunSetState::foreign);
  folder.write("p.x", "");
  CHECK(state(folder) == RunSetState::foreign);
  folder.write("p.x", points(1, 1));
  folder.write("d.x", format_end_of_run());
  CHECK(state(folder) == RunSetState::foreign);
  folder.write("d.x", "");
  CHECK(state(folder) == RunSetState::interrupted);
  std::filesystem::remove(folder.file("d.x"));
  CHECK(state(folder) == RunSetState::foreign);
}

TEST_CASE("A complete set that an interrupted run was appended to is kept") {
  const TemporaryFolder folder;
  run(folder, 1, true);
  run(folder, 2, true);
  run(folder, 3, false, RunFiles::Mode::append);
  CHECK(state(folder) == RunSetState::complete);
  run(folder, 4, false);
  CHECK(folder.read("p.x~") == points(2, 1) + points(3, 2));
  CHECK(folder.read("q.x~") == entry(1) + entry(2));
  CHECK(state(folder, "~") == RunSetState::complete);
}

TEST_CASE("Files that no run of ours made are kept, and so is a complete set") {
  const TemporaryFolder folder;
  run(folder, 1, true);
  run(folder, 2, true);
  std::filesystem::remove(folder.file("d.x"));
  folder.write("q.x", "solutions from elsewhere\n");
  run(folder, 3, true);
  CHECK(folder.read("q.x~~") == "solutions from elsewhere\n");
  CHECK(run_in(folder, "~") == "1");
  CHECK(state(folder, "~") == RunSetState::complete);
  const TemporaryFolder other;
  other.write("q.x", "solutions from elsewhere\n");
  run(other, 1, true);
  CHECK(other.read("q.x~") == "solutions from elsewhere\n");
}

TEST_CASE("A set that cannot be kept is not touched") {
  const TemporaryFolder folder;
  run(folder, 1, true);
  std::filesystem::create_directory(folder.file("q.x~"));
  RunFiles files(folder.file("x"));
  CHECK_THAT(message_of<UserError>([&] { files.check_writable(); }), Contains("q.x~") && Contains("is a directory"));
  CHECK_THROWS_AS(keep_run_set(folder.file("x")), ComputationError);
  CHECK(state(folder) == RunSetState::complete);
}

TEST_CASE("A full disk at the beginning leaves the old set") {
  for (const RunFiles::Mode mode : {RunFiles::Mode::replace, RunFiles::Mode::append}) {
    const TemporaryFolder folder;
    run(folder, 1, true);
    RunFiles files(folder.file("x"), mode);
    files.check_writable();
    const test_support::FileSizeLimit limit(100);
    CHECK_THROWS_AS(files.open(std::string(1000, 'c')), ComputationError);
    CHECK(state(folder) == RunSetState::complete);
    CHECK(folder.read("r.x") == "constants 1\n");
    CHECK_FALSE(folder.has("p.x~"));
  }
}

TEST_CASE("Two runs at once: the second is told who writes these files") {
  const TemporaryFolder folder;
  RunFiles first(folder.file("x"));
  first.check_writable();
  RunFiles second(folder.file("x"));
  CHECK_THAT(message_of<UserError>([&] { second.check_writable(); }),
             Contains(fmt::format("process {}", getpid())) && Contains("-o"));
  first.open("");
  first.finish();
  second.check_writable();
}

TEST_CASE("Appending where the kept set has the same files leaves that set alone") {
  const TemporaryFolder folder;
  run(folder, 1, true);
  keep_run_set(folder.file("x"));  // as a run that is killed before it has replaced anything
  run(folder, 2, false, RunFiles::Mode::append);
  CHECK(run_in(folder, "~") == "1");
  CHECK(folder.read("p.x") == points(1, 1) + points(2, 2));
}

TEST_CASE("What a killed process left is removed by the next run") {
  const TemporaryFolder folder;
  folder.write(".q.x~.aB3dE6.new", "");
  folder.write(".d.x.aB3dE6.new", "");
  folder.write(".d.y.aB3dE6.new", "another name's");
  folder.write(".d.x.some_notes.new", "somebody's own");
  run(folder, 1, true);
  CHECK_FALSE(folder.has(".q.x~.aB3dE6.new"));
  CHECK_FALSE(folder.has(".d.x.aB3dE6.new"));
  CHECK(folder.has(".d.y.aB3dE6.new"));
  CHECK(folder.has(".d.x.some_notes.new"));
}

TEST_CASE("Appending: labels go on counting, nothing is lost", "[output]") {
  const TemporaryFolder folder;
  run(folder, 1, true);
  run(folder, 2, true, RunFiles::Mode::append);
  CHECK(folder.read("p.x") == points(1, 1) + points(2, 2));
  CHECK(folder.read("q.x") == entry(1) + entry(2));
  CHECK(folder.read("r.x") == "constants 2\n");
  CHECK(state(folder) == RunSetState::complete);
  CHECK_FALSE(folder.has("p.x~"));
  RunFiles files(folder.file("x"), RunFiles::Mode::append);
  files.check_writable();
  CHECK(files.last_label() == 2);
  CHECK(files.last_branch() == 2);
}

TEST_CASE("Appending to nothing begins new files", "[output]") {
  const TemporaryFolder folder;
  run(folder, 1, true, RunFiles::Mode::append);
  CHECK(folder.read("p.x") == points(1, 1));
  CHECK(folder.read("q.x") == entry(1));
}

TEST_CASE("Appending to files that were cut off removes the incomplete end first", "[output]") {
  const TemporaryFolder folder;
  folder.write("p.x", points(1, 1) + "   0 a header\n   0\n   0 half a li");
  folder.write("q.x", entry(1) + entry(2) + entry(3).substr(0, 700));
  folder.write("d.x", diagnostics(1, 1) + "half");
  run(folder, 2, true, RunFiles::Mode::append);
  CHECK(folder.read("p.x") == points(1, 1) + points(2, 3));
  CHECK(folder.read("q.x") == entry(1) + entry(2) + entry(3));
  CHECK(folder.read("d.x") == diagnostics(1, 1) + format_bar() + diagnostics(2, 3) + format_end_of_run());
  folder.write("q.x", entry(1).substr(0, entry(1).size() - 1));  // only its newline is missing
  run(folder, 3, true, RunFiles::Mode::append);
  CHECK(folder.read("q.x") == entry(1) + entry(2));
}

TEST_CASE("Appending to a file that is no q-file is refused before anything is touched", "[output]") {
  const TemporaryFolder folder;
  folder.write("q.x", "prose\n");
  RunFiles files(folder.file("x"), RunFiles::Mode::append);
  CHECK_THAT(message_of<UserError>([&] { files.check_writable(); }), Contains("q.x:1"));
  CHECK(folder.read("q.x") == "prose\n");
}

TEST_CASE("Outputs that cannot be written are refused before the computation", "[output]") {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& name) {
    RunFiles files(name == "" ? name : folder.file(name));
    return message_of<UserError>([&] { files.check_writable(); });
  };
  CHECK_THAT(refusal("none/x"), Contains("there is no folder") && Contains("none") && Contains("-o"));
  std::filesystem::create_directory(folder.file("q.dir"));
  CHECK_THAT(refusal("dir"), Contains("q.dir") && Contains("is a directory"));
  std::filesystem::create_symlink("/dev/null", folder.file("d.device"));
  CHECK_THAT(refusal("device"), Contains("d.device") && Contains("device"));
  CHECK_THAT(refusal(""), Contains("no name for output files"));
  folder.write("file", "");
  CHECK_THAT(refusal("file/x"), Contains("there is no folder"));
}

TEST_CASE("A disk that fills up leaves files that load", "[output]") {
  const TemporaryFolder folder;
  RunFiles files(folder.file("x"));
  files.open("");
  files.add_solution(entry(1));
  files.write_if_due();
  const test_support::FileSizeLimit limit(entry(1).size() + 300);
  files.add_solution(entry(2));
  files.add_points("point\n");
  CHECK_THAT(message_of<ComputationError>([&] { files.write_if_due(); }), Contains("q.x"));
  CHECK(folder.read("p.x").empty());  // it may name the solution that is not there
  const SolutionFile file = read_solution_file(folder.file("q.x"));
  CHECK(file.solutions.size() == 1);
  CHECK(file.warnings.empty());
}
