#include <unistd.h>

#include <CLI/CLI.hpp>
#include <catch2/catch.hpp>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "app/commands.hpp"
#include "base/messages.hpp"
#include "files/sample_orbits.hpp"
#include "files/solution_file.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using test_support::message_of;
using test_support::TemporaryFolder;

namespace {

/// Standard output of a call, caught in a file.
class CaughtOutput {
 public:
  explicit CaughtOutput(const std::string& path) {
    std::fflush(stdout);
    before_ = ::dup(STDOUT_FILENO);
    std::FILE* file = std::fopen(path.c_str(), "w");
    ::dup2(::fileno(file), STDOUT_FILENO);
    std::fclose(file);
  }
  ~CaughtOutput() {
    std::fflush(stdout);
    ::dup2(before_, STDOUT_FILENO);
    ::close(before_);
  }
  CaughtOutput(const CaughtOutput&) = delete;
  CaughtOutput& operator=(const CaughtOutput&) = delete;

 private:
  int before_;
};

/// Parses the arguments as the program does and runs what was chosen; what it printed.
std::string output_of(const TemporaryFolder& folder, std::vector<std::string> arguments) {
  CLI::App app("tchat");
  std::function<int()> chosen;
  add_labels_command(app, chosen);
  add_orbit_command(app, chosen);
  std::reverse(arguments.begin(), arguments.end());
  app.parse(arguments);
  REQUIRE(chosen);
  int status = -1;
  {
    const CaughtOutput output(folder.file("output"));
    status = chosen();
  }
  CHECK(status == 0);
  return folder.read("output");
}

std::string sample_file() {
  LabelledSolution first = test_support::sample_orbit(2, 2, 3, 2);
  LabelledSolution second = first;
  second.label = 6;
  second.type = 9;
  return format_solution(first) + format_solution(second);
}

}  // namespace

TEST_CASE("tchat labels", "[output]") {
  const TemporaryFolder folder;
  folder.write("q.x", sample_file());
  const std::string text = output_of(folder, {"labels", folder.file("q.x")});
  CHECK_THAT(text, Contains("    5  PD   2    17") && Contains("    6  EP   2    17"));
  CHECK(output_of(folder, {"labels", folder.file("x")}) == text);
  folder.write("q.empty", "");
  CHECK_THAT(output_of(folder, {"labels", folder.file("q.empty")}), Contains("holds no labelled solution"));
}

TEST_CASE("tchat orbit", "[output]") {
  const TemporaryFolder folder;
  folder.write("q.x", sample_file());
  CHECK_THAT(output_of(folder, {"orbit", folder.file("q.x"), "6"}), Contains("label 6 (EP)"));
  CHECK_THAT(output_of(folder, {"orbit", folder.file("x"), "PD1"}), Contains("label 5 (PD)"));
  CHECK_THAT(output_of(folder, {"orbit", "--dimension", "4", folder.file("x"), "5"}), Contains("1 segment,"));
}

TEST_CASE("Wrong arguments of the commands", "[output]") {
  const TemporaryFolder folder;
  folder.write("q.x", sample_file());
  const auto message = [&](std::vector<std::string> arguments) {
    return message_of<UserError>([&] { output_of(folder, arguments); });
  };
  CHECK_THAT(message({"labels", folder.file("none")}), Contains("none: there is no such file"));
  CHECK_THAT(message({"orbit", folder.file("x"), "7"}), Contains("no label 7") && Contains("5 (PD), 6 (EP)"));
  CHECK_THAT(message({"orbit", folder.file("x"), "TR1"}), Contains("no point TR1"));
  CHECK_THAT(message({"orbit", folder.file("x"), "first"}), Contains("'first' is no label"));
  CHECK_THAT(message({"orbit", folder.file("x"), "-3"}), Contains("no label"));
  CHECK_THROWS_AS(output_of(folder, {"orbit", folder.file("x")}), CLI::ParseError);
  CHECK_THROWS_AS(output_of(folder, {"labels"}), CLI::ParseError);
}
