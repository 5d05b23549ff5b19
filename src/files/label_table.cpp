#include "files/label_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>
#include <utility>
#include <vector>

#include "files/table_format.hpp"

namespace tchat {

namespace {

constexpr const char* label_headings[] = {"label",
                                          "type",
                                          "name",
                                          "branch",
                                          "point",
                                          "problem_type",
                                          "branch_mode",
                                          "segments",
                                          "dimension",
                                          "mesh_intervals",
                                          "collocation_points",
                                          "stable",
                                          "admissible",
                                          "period",
                                          "signature",
                                          "free",
                                          "normal_form",
                                          "coefficient",
                                          "uncertainty",
                                          "verdict",
                                          "kind"};

TableCell known(int number) { return number > 0 ? TableCell(number) : TableCell(); }

TableCell known(const std::string& text) { return text.empty() ? TableCell() : TableCell(text); }

/// Those of any solution that are worth a column.
std::set<int> parameters_of(const SolutionFile& file, const ProblemNames& names) {
  std::set<int> result;
  for (const LabelledSolution& solution : file.solutions) {
    const int segments = segment_count(solution);
    for (int k = 1; k <= static_cast<int>(solution.parameters.size()); ++k) {
      const bool has_name = k <= static_cast<int>(names.parameters.size());
      const bool is_used =
          solution.layout.is_parameter(k, segments) && solution.parameters[static_cast<std::size_t>(k - 1)] != 0.0;
      if (has_name || is_used || solution.layout.is_duration(k, segments)) result.insert(k);
    }
  }
  return result;
}

std::string free_names(const LabelledSolution& solution, const ProblemNames& names) {
  std::vector<std::string> list;
  for (const int k : solution.free_parameters) list.push_back(names.parameter(k));
  return fmt::format("{}", fmt::join(list, ","));
}

}  // namespace

void write_label_table(TableWriter& out, const SolutionFile& file, const ProblemNames& names,
                       const std::map<int, RecordedLabel>& recorded, const std::string& signature) {
  const std::set<int> parameters = parameters_of(file, names);
  std::vector<std::string> headings(std::begin(label_headings), std::end(label_headings));
  for (const int k : parameters) headings.push_back(names.parameter(k));
  std::vector<TableColumn> columns;
  for (const std::string& heading : distinct_headings(headings)) columns.push_back({heading});
  out.begin(columns);
  const std::vector<std::vector<std::string>> counted = counted_names(file.solutions);
  for (std::size_t i = 0; i < file.solutions.size(); ++i) {
    const LabelledSolution& solution = file.solutions[i];
    const auto record = recorded.find(solution.label);
    const bool is_recorded = record != recorded.end();
    const int segments = segment_count(solution);
    std::vector<TableValue> row;
    const auto add = [&row](TableCell cell) { row.emplace_back(std::move(cell)); };
    add(solution.label);
    add(known(type_name(solution)));
    add(known(fmt::format("{}", fmt::join(counted[i], " "))));
    add(solution.branch);
    add(solution.point);
    add(known(solution.problem_type));
    add(solution.branch_mode);
    add(known(segments));
    add(known(segments > 0 ? static_cast<int>(solution.states.rows()) / segments : 0));
    add(solution.mesh_intervals);
    add(solution.collocation_points);
    add(is_recorded && record->second.stable ? TableCell(*record->second.stable) : TableCell());
    add(is_recorded ? TableCell(record->second.admissible) : TableCell());
    add(segments > 0 ? TableCell(period(solution)) : TableCell());
    add(known(signature));
    add(known(free_names(solution, names)));
    const NormalFormNote* const form =
        is_recorded && record->second.normal_form ? &*record->second.normal_form : nullptr;
    add(form == nullptr ? TableCell() : known(form->name));
    add(form == nullptr ? TableCell() : TableCell(form->value));
    add(form == nullptr ? TableCell() : TableCell(form->uncertainty));
    add(form == nullptr ? TableCell() : known(form->verdict));
    add(known(description(solution, [&names](int k) { return names.parameter(k); })));
    for (const int k : parameters) {
      const auto index = static_cast<std::size_t>(k - 1);
      const bool has = index < solution.parameters.size() &&
                       (solution.layout.is_parameter(k, segments) || solution.layout.is_duration(k, segments));
      add(has ? TableCell(solution.parameters[index]) : TableCell());
    }
    out.row(row);
  }
  out.end();
}

}  // namespace tchat
