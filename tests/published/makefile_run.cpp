#include "published/makefile_run.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <set>

#include "published/kept_folder.hpp"

namespace test_support {

namespace fs = std::filesystem;

namespace {

constexpr std::chrono::seconds time_limit{250};

/// The text without the folder where the chain has been run, which stands in it where the plugin is named.
std::string without_folder(std::string text, const std::string& folder) {
  for (auto at = text.find(folder); at != std::string::npos; at = text.find(folder, at)) text.erase(at, folder.size());
  return text;
}

std::set<std::string> files_in(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

}  // namespace

MakefileRun::MakefileRun(const std::string& problem, const std::string& targets)
    : problem_(problem), targets_(targets) {
  const std::vector<fs::path> sources = files_of({fs::path(PROBLEMS) / problem, fs::path(CONSTANTS) / problem});
  std::vector<fs::path> all = files_of({CONTRACT});
  all.insert(all.end(), sources.begin(), sources.end());
  const KeptFolder kept(problem, all);
  for (const fs::path& source : sources) {
    const fs::path target = kept.path() / source.lexically_relative(fs::path(PROBLEMS).parent_path());
    fs::create_directories(target.parent_path());
    if (!fs::exists(target)) fs::copy_file(source, target);
  }
  const Outcome outcome = make(kept.path(), {"-j2"}, "out");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  copy_with_times(kept.path(), folder_.file(""));
  kept_ = kept.path();
}

Outcome MakefileRun::make(const std::string& folder, const std::vector<std::string>& words,
                          const std::string& out) const {
  const std::string results = (fs::path(folder) / out).string();
  std::vector<std::string> all{
      "/usr/bin/env",  "make", "-C", (fs::path(folder) / "problems" / problem_).string(), "TCHAT=" TCHAT_EXECUTABLE,
      "OUT=" + results};
  all.insert(all.end(), words.begin(), words.end());
  const bool names_target =
      std::any_of(words.begin(), words.end(), [](const std::string& word) { return word.front() != '-'; });
  if (!names_target)
    for (const std::string& target : words_of(targets_))
      all.push_back(target.find('.') == std::string::npos ? target : results + "/" + target);
  return Process(all, folder_.file(""), logs_.file(std::to_string(++runs_))).wait(time_limit);
}

void MakefileRun::check_repeatable(Chain length) const {
  const std::string folder = folder_.file("");
  const Outcome again = make(folder, {}, "out");
  CHECK(again.status == 0);
  CHECK(again.text().find("Nothing to be done") != std::string::npos);
  CHECK(again.text().find("tchat run") == std::string::npos);

  if (length == Chain::is_long && !all_tests()) return;
  const Outcome serial = make(folder, {}, "serial");
  INFO(serial.text());
  REQUIRE(serial.status == 0);
  const auto names = files_in(folder_.file("serial"));
  CHECK_FALSE(names.empty());
  for (const std::string& name : names) {
    INFO(name);
    CHECK_FALSE(read(name).empty());
    CHECK(
        (without_folder(folder_.read("serial/" + name), folder_.file("")) == without_folder(read(name), kept_ + "/")));
  }

  CHECK(make(folder, {"clean"}, "serial").status == 0);
  CHECK(files_in(folder_.file("serial")).empty());
}

void MakefileRun::check_verified() const {
  const Outcome outcome = make(folder_.file(""), {"verify"}, "out");
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
