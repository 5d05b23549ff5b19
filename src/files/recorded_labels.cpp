#include "files/recorded_labels.hpp"

#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "base/user_error.hpp"
#include "files/diagnostics_file_reader.hpp"
#include "files/point_file_reader.hpp"
#include "files/run_file_names.hpp"

namespace tchat {

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
