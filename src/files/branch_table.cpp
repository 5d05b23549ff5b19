#include "files/branch_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "files/labelled_solution.hpp"
#include "files/number_format.hpp"
#include "files/solution_file_reader.hpp"
#include "files/table_format.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

constexpr const char* point_headings[] = {"section", "branch", "point",  "type",      "name",
                                          "label",   "kind",   "stable", "admissible"};
constexpr const char* multipliers_heading = "multipliers";
constexpr const char* iterations_heading = "newton_iterations";

bool is_not_finite(double value) { return !std::isfinite(value) || std::abs(value) == capped_value; }

TableCell number_cell(double value) { return is_not_finite(value) ? TableCell() : TableCell(value); }

TableCell text_cell(const std::string& text) { return text.empty() ? TableCell() : TableCell(text); }

double finite_or_infinite(double value) {
  return is_not_finite(value) ? std::copysign(std::numeric_limits<double>::infinity(), value) : value;
}

/// The parameters worth a column: those with a name, those that are not zero, durations.
std::set<int> parameters_of(const PointSection& section, const std::map<int, double>& values) {
  std::set<int> result;
  for (const auto& [k, name] : section.parameters) result.insert(k);
  for (const auto& [k, value] : values)
    if (section.layout.is_duration(k, section.segments) ||
        (section.layout.is_parameter(k, section.segments) && value != 0.0))
      result.insert(k);
  return result;
}

/// The numbers of a point: columns of the p-file and parameters, by their names over all sections.
class PointNumbers {
 public:
  explicit PointNumbers(const BranchFile& file) : file_(file) {
    for (const PointSection& section : file.sections) {
      places_.emplace_back();
      const std::vector<std::string> names = distinct_headings(section.columns);
      for (std::size_t k = 0; k < names.size(); ++k) {
        places_.back().emplace(names[k], k);
        add(names[k]);
      }
    }
    for (std::size_t s = 0; s < file.sections.size(); ++s) {
      parameters_.emplace_back();
      for (const int k : parameters_of(file.sections[s], file.parameters[s])) {
        const std::string name = file.sections[s].parameter_name(k);
        parameters_.back().emplace(name, k);
        add(name);
      }
    }
  }

  const std::vector<std::string>& names() const { return names_; }

  void append(std::vector<TableCell>& cells, std::size_t section, std::size_t row) const {
    for (const std::string& name : names_) {
      const auto place = places_[section].find(name);
      const auto parameter = parameters_[section].find(name);
      if (place != places_[section].end())
        cells.push_back(number_cell(file_.sections[section].rows[row].values[place->second]));
      else if (parameter != parameters_[section].end())
        cells.push_back(parameter_cell(section, row, parameter->second));
      else
        cells.emplace_back();
    }
  }

 private:
  void add(const std::string& name) {
    if (known_.insert(name).second) names_.push_back(name);
  }

  /// A parameter without a column: one that is free, or may be, is known at labels only.
  TableCell parameter_cell(std::size_t s, std::size_t row, int k) const {
    const PointSection& section = file_.sections[s];
    const auto period = places_[s].find("PERIOD");
    if (section.segments == 1 && k == section.layout.first_duration() && period != places_[s].end())
      return number_cell(section.rows[row].values[period->second]);
    const auto& active = section.active_parameters;
    const bool fixed = !active.empty() && std::find(active.begin(), active.end(), k) == active.end();
    if (fixed && !section.layout.is_duration(k, section.segments)) {
      const auto value = file_.parameters[s].find(k);
      return value == file_.parameters[s].end() ? TableCell() : number_cell(value->second);
    }
    const LabelledSolution* solution = file_.solution_of(s, row);
    const auto index = static_cast<std::size_t>(k - 1);
    return solution == nullptr || index >= solution->parameters.size() ? TableCell()
                                                                       : number_cell(solution->parameters[index]);
  }

  const BranchFile& file_;
  std::vector<std::map<std::string, std::size_t>> places_;  // by section: columns by name
  std::vector<std::map<std::string, int>> parameters_;      // by section: PAR indices by name
  std::vector<std::string> names_;
  std::set<std::string> known_;
};

class BranchTable {
 public:
  explicit BranchTable(const BranchFile& file) : file_(file), numbers_(file), names_(counted_names(file.solutions)) {}

  /// All but the multipliers and the iterations.
  std::vector<std::string> headings() const {
    std::vector<std::string> all(std::begin(point_headings), std::end(point_headings));
    all.insert(all.end(), {multipliers_heading, iterations_heading});  // a column of such a name gets another one
    all.insert(all.end(), numbers_.names().begin(), numbers_.names().end());
    all = distinct_headings(all);
    const auto reserved = all.begin() + static_cast<std::ptrdiff_t>(std::size(point_headings));
    all.erase(reserved, reserved + 2);
    return all;
  }

  std::vector<TableCell> cells(std::size_t section, std::size_t row) const {
    const PointRow& point = file_.sections[section].rows[row];
    const LabelledSolution* solution = file_.solution_of(section, row);
    const DiagnosticPoint* diagnostic = file_.diagnostic_of(section, row);
    std::vector<TableCell> cells{static_cast<int>(section) + 1, std::abs(point.branch), std::abs(point.point),
                                 text_cell(file_.types[section][row])};
    cells.push_back(solution == nullptr ? TableCell() : name(section, row));
    cells.emplace_back(point.label);
    cells.push_back(solution == nullptr ? TableCell() : kind(section, *solution));
    cells.push_back(has_stability(section) ? TableCell(point.point < 0) : TableCell());
    cells.push_back(diagnostic == nullptr ? TableCell() : TableCell(diagnostic->admissible));
    numbers_.append(cells, section, row);
    return cells;
  }

  /// Empty where they are not known.
  ComplexList multipliers(std::size_t section, std::size_t row) const {
    const DiagnosticPoint* diagnostic = file_.diagnostic_of(section, row);
    ComplexList list;
    if (diagnostic != nullptr)
      for (const std::complex<double>& mu : diagnostic->multipliers)
        list.emplace_back(finite_or_infinite(mu.real()), finite_or_infinite(mu.imag()));
    return list;
  }

  TableCell iterations(std::size_t section, std::size_t row) const {
    const DiagnosticPoint* diagnostic = file_.diagnostic_of(section, row);
    return diagnostic == nullptr || !diagnostic->iterations ? TableCell() : TableCell(*diagnostic->iterations);
  }

  std::size_t most_multipliers() const {
    std::size_t most = 0;
    each_point([&](std::size_t s, std::size_t k) { most = std::max(most, multipliers(s, k).size()); });
    return most;
  }

  template <class Use>
  void each_point(const Use& use) const {
    for (std::size_t s = 0; s < file_.sections.size(); ++s)
      for (std::size_t k = 0; k < file_.sections[s].rows.size(); ++k) use(s, k);
  }

 private:
  TableCell name(std::size_t section, std::size_t row) const {
    const auto place = static_cast<std::size_t>(file_.solution[section][row]);
    return text_cell(fmt::format("{}", fmt::join(names_[place], " ")));
  }

  TableCell kind(std::size_t section, const LabelledSolution& solution) const {
    return text_cell(description(solution, [&](int k) { return file_.sections[section].shown_parameter(k); }));
  }

  /// Not along curves of folds, period doublings and torus bifurcations.
  bool has_stability(std::size_t section) const {
    const PointSection& s = file_.sections[section];
    return s.has_stability() && s.curve_type == 0 && !has_critical_multiplier(s.problem_type, s.branch_mode);
  }

  const BranchFile& file_;
  PointNumbers numbers_;
  std::vector<std::vector<std::string>> names_;
};

}  // namespace

void write_branch_table(TableWriter& out, const BranchFile& file) {
  const BranchTable table(file);
  std::vector<TableColumn> columns;
  for (const std::string& heading : table.headings()) columns.push_back({heading});
  columns.push_back({multipliers_heading, table.most_multipliers(), "multiplier"});
  columns.push_back({iterations_heading});
  out.begin(columns);
  table.each_point([&](std::size_t section, std::size_t row) {
    std::vector<TableValue> values;
    for (TableCell& cell : table.cells(section, row)) values.emplace_back(std::move(cell));
    values.emplace_back(table.multipliers(section, row));
    values.emplace_back(table.iterations(section, row));
    out.row(values);
  });
  out.end();
}

}  // namespace tchat
