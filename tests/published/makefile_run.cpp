#include "published/makefile_run.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <set>

namespace test_support {

namespace fs = std::filesystem;

namespace {

constexpr std::chrono::seconds time_limit{250};

std::set<std::string> files_in(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

}  // namespace

MakefileRun::MakefileRun(const std::string& problem, const std::string& targets)
    : problem_(problem), targets_(targets) {
  for (const std::string kind : {"problems", "constants"}) {
    const fs::path source = fs::path(kind == "problems" ? PROBLEMS : CONSTANTS) / problem;
    const fs::path target = folder_.file(kind + "/" + problem);
    if (!fs::exists(source)) continue;  // constants of a chain that begins with a simulation
    fs::create_directories(target);
    for (const auto& entry : fs::directory_iterator(source))
      if (entry.is_regular_file() && entry.path().extension() != ".so")
        fs::copy_file(entry.path(), target / entry.path().filename());
  }
  const Outcome outcome = make({"-j2"}, "out");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
}

Outcome MakefileRun::make(const std::vector<std::string>& words, const std::string& out) const {
  std::vector<std::string> all{"/usr/bin/env",
                               "make",
                               "-C",
                               folder_.file("problems/" + problem_),
                               "TCHAT=" TCHAT_EXECUTABLE,
                               "OUT=" + folder_.file(out)};
  all.insert(all.end(), words.begin(), words.end());
  const bool names_target =
      std::any_of(words.begin(), words.end(), [](const std::string& word) { return word.front() != '-'; });
  if (!names_target)
    for (const std::string& target : words_of(targets_))
      all.push_back(target.find('.') == std::string::npos ? target : folder_.file(out + "/" + target));
  return Process(all, folder_.file(""), logs_.file(std::to_string(++runs_))).wait(time_limit);
}

void MakefileRun::check_repeatable() const {
  const Outcome again = make({}, "out");
  CHECK(again.status == 0);
  CHECK(again.text().find("Nothing to be done") != std::string::npos);
  CHECK(again.text().find("tchat run") == std::string::npos);

  const Outcome serial = make({}, "serial");
  INFO(serial.text());
  REQUIRE(serial.status == 0);
  const auto names = files_in(folder_.file("out"));
  CHECK(files_in(folder_.file("serial")) == names);
  for (const std::string& name : names) {
    INFO(name);
    CHECK_FALSE(read(name).empty());
    CHECK((folder_.read("serial/" + name) == read(name)));
  }

  CHECK(make({"clean"}, "serial").status == 0);
  CHECK(files_in(folder_.file("serial")).empty());
}

void MakefileRun::check_verified() const {
  const Outcome outcome = make({"verify"}, "out");
  INFO(outcome.text());
  CHECK(outcome.status == 0);
  CHECK(outcome.text().find("agree with forward integration") != std::string::npos);
  CHECK(outcome.text().find("<<") == std::string::npos);
}

Outcome MakefileRun::tchat(std::vector<std::string> words) const {
  words.insert(words.begin(), TCHAT_EXECUTABLE);
  return Process(words, folder_.file("out"), logs_.file(std::to_string(++runs_))).wait(time_limit);
}

void MakefileRun::run(const std::string& arguments) const {
  std::vector<std::string> words{"run", problem_, "-p", plugin()};
  for (const std::string& word : words_of(arguments)) words.push_back(word);
  const Outcome outcome = tchat(words);
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
}

SolutionEntry MakefileRun::solution(const std::string& name, const std::string& type, std::size_t n) const {
  return with_label(solutions(name), point(name, type, n).label);
}

DiagnosticPoint MakefileRun::point(const std::string& name, const std::string& type, std::size_t n) const {
  const auto found = of_type(diagnostics(name), type);
  INFO(type << n << " in d." << name);
  REQUIRE(found.size() >= n);
  return found[n - 1];
}

SolutionEntry MakefileRun::only(const std::string& name, const std::string& type) const {
  const auto found = of_type(diagnostics(name), type);
  INFO(type << " in d." << name);
  REQUIRE(found.size() == 1);
  return with_label(solutions(name), found.front().label);
}

void check_near(double found, double expected, double tolerance) {
  CAPTURE(found, expected);
  CHECK(std::abs(found - expected) <= tolerance);
}

}  // namespace test_support
