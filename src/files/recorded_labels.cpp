#include "files/recorded_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "files/auto_format.hpp"
#include "files/diagnostics_file.hpp"
#include "files/point_file_reader.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

bool is_identifier(const std::string& line) {
  const auto words = split_words(line);
  return (words.size() == 12 || words.size() == 16) &&
         std::all_of(words.begin(), words.end(), [](std::string_view word) { return parse_integer(word).has_value(); });
}

RunFileKind kind_by_name(const std::string& name) {
  const auto is_one_of = [&name](const char* prefixes, const char* fort) {
    return name == fort ||
           (name.size() > 1 && name[1] == '.' && std::string(prefixes).find(name[0]) != std::string::npos);
  };
  if (is_one_of("d", "fort.9")) return RunFileKind::diagnostics;
  if (is_one_of("qs", "fort.8")) return RunFileKind::solutions;
  return is_one_of("pb", "fort.7") ? RunFileKind::points : RunFileKind::other;
}

}  // namespace

RunFileKind run_file_kind(const std::string& path) {
  TextLines file(path, "a file of a run");
  std::string line;
  file.next(line);
  if (is_identifier(line)) return RunFileKind::solutions;
  const RunFileKind named = kind_by_name(std::filesystem::path(path).filename().string());
  return named != RunFileKind::diagnostics && looks_like_point_file(line) ? RunFileKind::points : named;
}

namespace {

constexpr int most_names = 1000;

/// `most`: whatever number a file says.
std::vector<std::string> list_of(const std::map<int, std::string>& names, const char* symbol, int most) {
  std::vector<std::string> list;
  const int last = names.empty() ? 0 : std::min(names.rbegin()->first, most);
  for (int k = 1; k <= last; ++k) list.push_back(names.contains(k) ? names.at(k) : fmt::format("{}({})", symbol, k));
  return list;
}

}  // namespace

RecordedNames recorded_names(const std::string& solution_path) {
  std::error_code error;
  RecordedNames recorded;
  const std::string path = sibling_path(solution_path, 'p');
  if (path.empty() || !std::filesystem::is_regular_file(path, error)) return recorded;
  try {
    const PointFile file = read_point_file(path);
    const PointSection& section = file.sections.front();
    recorded.names.states = list_of(section.states, "U", most_names);
    recorded.names.parameters = list_of(section.parameters, "PAR", most_names + section.layout.parameters());
  } catch (const UserError&) {
    recorded.warning = fmt::format("{} cannot be read: names of states and parameters are left out", path);
  }
  return recorded;
}

void require_recorded_parameters(const std::string& solution_path, const HybridSystem& system) {
  const std::vector<std::string> recorded = recorded_names(solution_path).names.parameters;
  for (int k = 1; k <= std::min(system.parameters(), static_cast<int>(recorded.size())); ++k) {
    const std::string unnamed = fmt::format("PAR({})", k);
    const std::string& was = recorded[static_cast<std::size_t>(k - 1)];
    const std::string is = system.parameter_name(k);
    if (was == is || was == unnamed || is == unnamed) continue;
    throw UserError(fmt::format(
        "{}: PAR({}) was {} when the file was written, and is {} in problem {} now; its labels and its constants have "
        "parameters by their numbers. Put new parameters behind the others and keep the names of those there are, or "
        "compute the branch again",
        solution_path, k, was, is, system.name()));
  }
}

namespace {

constexpr std::string_view violation_begin = "Inadmissible: ";

std::string existing_sibling(const std::string& path, char letter) {
  const std::string sibling = sibling_path(path, letter);
  std::error_code error;
  return !sibling.empty() && std::filesystem::is_regular_file(sibling, error) ? sibling : "";
}

/// |PT| of the labels in the q-file: files of another run have other points.
std::map<int, int> points_of(const SolutionFile& solutions) {
  std::map<int, int> points;
  for (const LabelledSolution& solution : solutions.solutions) points[solution.label] = solution.point;
  return points;
}

void take_stability(const std::string& path, const std::map<int, int>& points, std::map<int, RecordedLabel>& labels) {
  for (const PointSection& section : read_point_file(path).sections) {
    if (!section.has_stability() || section.curve_type != 0) continue;
    for (const PointRow& row : section.rows)
      if (const auto at = points.find(row.label); at != points.end() && at->second == std::abs(row.point))
        labels[row.label].stable = row.point < 0;
  }
}

/// The first note of a special point says what it is; others have notes of other kinds only.
void take_words(const std::string& path, const std::map<int, int>& points, std::map<int, RecordedLabel>& labels) {
  for (const DiagnosticPoint& point : read_diagnostics_file(path)) {
    const auto at = points.find(point.label);
    if (at == points.end() || at->second != std::abs(point.point)) continue;
    RecordedLabel& label = labels[point.label];
    label.admissible = point.admissible;
    const bool is_special = !point.type.empty() && point.type != "EP" && point.type != "RG";
    label.violation = violation_in(point.notes);
    label.normal_form = point.normal_form;
    const bool has_words = is_special && !point.notes.empty() && !point.notes.front().starts_with(violation_begin);
    if (has_words) label.words = point.notes.front();
  }
}

}  // namespace

std::string violation_in(const std::vector<std::string>& notes) {
  for (const std::string& note : notes)
    if (note.starts_with(violation_begin)) return note.substr(violation_begin.size());
  return "";
}

std::map<int, RecordedLabel> recorded_labels(const std::string& solution_path, const SolutionFile& solutions) {
  const std::map<int, int> points = points_of(solutions);
  std::map<int, RecordedLabel> labels;
  using Take = void (*)(const std::string&, const std::map<int, int>&, std::map<int, RecordedLabel>&);
  for (const auto& [letter, take] : {std::pair<char, Take>{'p', take_stability}, {'d', take_words}}) {
    try {
      if (const std::string path = existing_sibling(solution_path, letter); !path.empty()) take(path, points, labels);
    } catch (const UserError&) {  // the table is made without it; a p-file that cannot be read is told with the names
    }
  }
  return labels;
}

}  // namespace tchat
