#include "end_to_end/workspace.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <sstream>

namespace test_support {

namespace fs = std::filesystem;

namespace {

constexpr std::chrono::seconds time_limit{120};

/// The program under test: the one that the build has made, or the sanitized one that the environment names.
std::string executable() {
  const char* const chosen = std::getenv("TCHAT_EXECUTABLE");
  return chosen ? chosen : TCHAT_EXECUTABLE;
}

}  // namespace

double number_after(const std::string& text, const std::string& key) {
  const auto at = text.find(key);
  INFO(text);
  REQUIRE(at != std::string::npos);
  return std::stod(text.substr(at + key.size()));
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

Workspace::Workspace(Plugin plugin) {
  for (const auto& entry : fs::directory_iterator(LINOSC_CONSTANTS))
    fs::copy_file(entry.path(), file(entry.path().filename().string()));
  const fs::path code = plugin == Plugin::compiled ? LINOSC_LIBRARY : LINOSC_SOURCE;
  fs::copy_file(code, file(code.filename().string()));
}

Outcome Workspace::tchat(const std::vector<std::string>& words) const {
  std::vector<std::string> all{executable()};
  all.insert(all.end(), words.begin(), words.end());
  return Process(all, file(""), logs_.file(std::to_string(++runs_))).wait(time_limit);
}

Outcome Workspace::tchat(const std::string& arguments) const { return tchat(words_of(arguments)); }

std::unique_ptr<Process> Workspace::start_tchat(const std::string& arguments) const {
  std::vector<std::string> all = words_of(arguments);
  all.insert(all.begin(), executable());
  return std::make_unique<Process>(all, file(""), logs_.file(std::to_string(++runs_)));
}

Outcome Workspace::tchat_on_small_disk(int blocks, const std::string& arguments) const {
  // Without the trap the system would end the program before it is told that its file is full.
  const std::string script =
      "trap '' XFSZ; ulimit -f " + std::to_string(blocks) + "; exec '" + executable() + "' " + arguments;
  return Process({"/bin/sh", "-c", script}, file(""), logs_.file(std::to_string(++runs_))).wait(time_limit);
}

Outcome Workspace::tchat_in_memory(int kilobytes, const std::string& arguments) const {
  const std::string script = "ulimit -v " + std::to_string(kilobytes) + "; exec '" + executable() + "' " + arguments;
  return Process({"/bin/sh", "-c", script}, file(""), logs_.file(std::to_string(++runs_))).wait(time_limit);
}

Outcome Workspace::tchat_redirected(const std::string& arguments, const std::string& redirection) const {
  const std::string script = "exec '" + executable() + "' " + arguments + " " + redirection;
  return Process({"/bin/sh", "-c", script}, file(""), logs_.file(std::to_string(++runs_))).wait(time_limit);
}

Outcome Workspace::tchat_preloaded(const std::string& library, const std::string& record,
                                   const std::string& arguments) const {
  const std::string script =
      "RECORDED_CALLS='" + record + "' LD_PRELOAD='" + library + "' exec '" + executable() + "' " + arguments;
  return Process({"/bin/sh", "-c", script}, file(""), logs_.file(std::to_string(++runs_))).wait(time_limit);
}

Outcome Workspace::shell(const std::string& line) const {
  const std::string script = "tchat() { '" + executable() + "' \"$@\"; }; " + line;
  return Process({"/bin/sh", "-c", script}, file(""), logs_.file(std::to_string(++runs_))).wait(time_limit);
}

Outcome Workspace::make(const std::string& folder, const std::string& targets) const {
  std::vector<std::string> words{"/usr/bin/env", "make", "-C", folder, "TCHAT=" + executable()};
  for (const std::string& target : words_of(targets)) words.push_back(target);
  return Process(words, file(""), logs_.file(std::to_string(++runs_))).wait(time_limit);
}

Outcome Workspace::succeed(const std::vector<std::string>& words) const {
  Outcome outcome = tchat(words);
  INFO(fmt::format("{}\n{}", fmt::join(words, " "), outcome.text()));
  REQUIRE(outcome.signal == 0);
  REQUIRE(outcome.status == 0);
  return outcome;
}

Outcome Workspace::succeed(const std::string& arguments) const { return succeed(words_of(arguments)); }

Outcome Workspace::run(const std::vector<std::string>& words) const {
  std::vector<std::string> all{"run", "linosc"};
  all.insert(all.end(), words.begin(), words.end());
  return succeed(all);
}

Outcome Workspace::run(const std::string& arguments) const { return run(words_of(arguments)); }

std::vector<PointSection> Workspace::points(const std::string& name) const { return read_points(read("p." + name)); }

std::vector<SolutionEntry> Workspace::solutions(const std::string& name) const {
  return read_solutions(read("q." + name));
}

bool Workspace::has_unfinished() const {
  return std::any_of(fs::directory_iterator(file("")), fs::directory_iterator(),
                     [](const fs::directory_entry& entry) { return entry.path().extension() == ".new"; });
}

void Workspace::edit(const std::string& name, const std::string& old, const std::string& text) const {
  std::string contents = read(name);
  const auto at = contents.find(old);
  INFO(name << " holds one " << old);
  REQUIRE(at != std::string::npos);
  REQUIRE(contents.find(old, at + 1) == std::string::npos);
  write(name, contents.replace(at, old.size(), text));
}

std::vector<PointRow> rows_of(const std::vector<PointSection>& sections) {
  std::vector<PointRow> rows;
  for (const PointSection& section : sections) rows.insert(rows.end(), section.rows.begin(), section.rows.end());
  return rows;
}

std::vector<int> labels_of(const std::vector<PointSection>& sections) {
  std::vector<int> labels;
  for (const PointRow& row : rows_of(sections))
    if (row.label > 0) labels.push_back(row.label);
  return labels;
}

std::vector<int> labels_of(const std::vector<SolutionEntry>& entries) {
  std::vector<int> labels;
  for (const SolutionEntry& entry : entries) labels.push_back(entry.label);
  return labels;
}

const SolutionEntry& with_label(const std::vector<SolutionEntry>& entries, int label) {
  for (const SolutionEntry& entry : entries)
    if (entry.label == label) return entry;
  FAIL("no label " << label << " in the q-file");
  return entries.front();
}

const PointRow& with_label(const std::vector<PointSection>& sections, int label) {
  for (const PointSection& section : sections)
    for (const PointRow& row : section.rows)
      if (row.label == label) return row;
  FAIL("no label " << label << " in the p-file");
  return sections.front().rows.front();
}

}  // namespace test_support
