#include "output/run_files.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <string>

#include "constants/user_error.hpp"
#include "output/diagnostics_file.hpp"
#include "output/file_size_limit.hpp"
#include "output/sample_orbits.hpp"
#include "output/solution_file.hpp"
#include "start/solution_file_reader.hpp"
#include "start/temporary_folder.hpp"

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

/// A run that writes one block of each kind; `what` tells runs apart.
void run(const TemporaryFolder& folder, const std::string& what, bool complete,
         RunFiles::Mode mode = RunFiles::Mode::replace) {
  RunFiles files(folder.file("x"), mode);
  files.check_writable();
  files.open("constants " + what + "\n");
  files.write_points("points " + what + "\n");
  files.write_solution(entry(files.last_label() + 1));
  files.write_diagnostics("diagnostics " + what + "\n");
  if (complete) files.finish();
}

}  // namespace

TEST_CASE("Names of the four files", "[output]") {
  CHECK(output_path('p', "mems") == "p.mems");
  CHECK(output_path('q', "results/mems.2") == "results/q.mems.2");
}

TEST_CASE("Nothing is created before open", "[output]") {
  const TemporaryFolder folder;
  RunFiles files(folder.file("x"));
  files.check_writable();
  CHECK(std::filesystem::is_empty(folder.file(".")));
  CHECK_FALSE(files.is_open());
  files.finish();
  CHECK(std::filesystem::is_empty(folder.file(".")));
}

TEST_CASE("A complete run", "[output]") {
  const TemporaryFolder folder;
  run(folder, "one", true);
  CHECK(folder.read("p.x") == "points one\n");
  CHECK(folder.read("q.x") == entry(1));
  CHECK(folder.read("d.x") == "diagnostics one\n" + format_end_of_run());
  CHECK(folder.read("r.x") == "constants one\n");
  CHECK(is_complete_run(folder.file("d.x")));
  CHECK_FALSE(folder.has("p.x~"));
}

TEST_CASE("Blocks are on the disk at once", "[output]") {
  const TemporaryFolder folder;
  RunFiles files(folder.file("x"));
  files.open("");
  files.write_points("point\n");
  files.write_solution(entry(1));
  files.write_diagnostics("note\n");
  CHECK(folder.read("p.x") == "point\n");
  CHECK(read_solution_file(folder.file("q.x")).solutions.size() == 1);
  CHECK(folder.read("d.x") == "note\n");
}

TEST_CASE("A complete run is kept as p.x~ when another replaces it", "[output]") {
  const TemporaryFolder folder;
  run(folder, "one", true);
  run(folder, "two", true);
  CHECK(folder.read("p.x") == "points two\n");
  for (const std::string name : {"p.x~", "q.x~", "d.x~", "r.x~"}) CHECK(folder.has(name));
  CHECK(folder.read("p.x~") == "points one\n");
  CHECK(folder.read("r.x~") == "constants one\n");
}

TEST_CASE("An incomplete run never replaces a complete p.x~", "[output]") {
  const TemporaryFolder folder;
  run(folder, "one", true);
  run(folder, "two", false);
  CHECK_FALSE(is_complete_run(folder.file("d.x")));
  run(folder, "three", true);
  CHECK(folder.read("p.x") == "points three\n");
  CHECK(folder.read("p.x~") == "points one\n");
  CHECK(folder.read("d.x~") == "diagnostics one\n" + format_end_of_run());
  run(folder, "four", true);
  CHECK(folder.read("p.x~") == "points three\n");
}

TEST_CASE("An incomplete run is kept while there is nothing better", "[output]") {
  const TemporaryFolder folder;
  run(folder, "one", false);
  run(folder, "two", false);
  CHECK(folder.read("p.x~") == "points one\n");
  run(folder, "three", true);
  CHECK(folder.read("p.x~") == "points two\n");
  run(folder, "four", false);
  CHECK(folder.read("p.x~") == "points three\n");
}

TEST_CASE("Files that no run of ours made are kept", "[output]") {
  const TemporaryFolder folder;
  run(folder, "one", true);
  run(folder, "two", true);
  std::filesystem::remove(folder.file("d.x"));
  folder.write("q.x", "solutions from elsewhere\n");
  run(folder, "three", true);
  CHECK(folder.read("q.x~") == "solutions from elsewhere\n");
}

TEST_CASE("Appending: labels go on counting, nothing is lost", "[output]") {
  const TemporaryFolder folder;
  run(folder, "one", true);
  run(folder, "two", true, RunFiles::Mode::append);
  CHECK(folder.read("p.x") == "points one\npoints two\n");
  CHECK(folder.read("q.x") == entry(1) + entry(2));
  CHECK(folder.read("r.x") == "constants two\n");
  CHECK(is_complete_run(folder.file("d.x")));
  CHECK_FALSE(folder.has("p.x~"));
  RunFiles files(folder.file("x"), RunFiles::Mode::append);
  files.check_writable();
  CHECK(files.last_label() == 2);
  CHECK(files.last_branch() == 2);
}

TEST_CASE("Appending to nothing begins new files", "[output]") {
  const TemporaryFolder folder;
  run(folder, "one", true, RunFiles::Mode::append);
  CHECK(folder.read("p.x") == "points one\n");
  CHECK(folder.read("q.x") == entry(1));
}

TEST_CASE("Appending to files that were cut off removes the incomplete end first", "[output]") {
  const TemporaryFolder folder;
  folder.write("p.x", "points one\nhalf a li");
  folder.write("q.x", entry(1) + entry(2) + entry(3).substr(0, 700));
  folder.write("d.x", "half");
  run(folder, "two", true, RunFiles::Mode::append);
  CHECK(folder.read("p.x") == "points one\npoints two\n");
  CHECK(folder.read("q.x") == entry(1) + entry(2) + entry(3));
  folder.write("q.x", entry(1).substr(0, entry(1).size() - 1));  // only its newline is missing
  run(folder, "three", true, RunFiles::Mode::append);
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
  files.write_solution(entry(1));
  const test_support::FileSizeLimit limit(entry(1).size() + 300);
  CHECK_THAT(message_of<ComputationError>([&] { files.write_solution(entry(2)); }), Contains("q.x"));
  const SolutionFile file = read_solution_file(folder.file("q.x"));
  CHECK(file.solutions.size() == 1);
  CHECK(file.warnings.empty());
}
