#include "files/branch_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <set>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "files/auto_format.hpp"
#include "files/solution_file_reader.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

/// A new branch begins where the points are counted from 1 again; after 9999 that is only the count's end.
std::vector<BranchPiece> split_into_pieces(const std::vector<PointSection>& sections) {
  std::vector<BranchPiece> pieces;
  for (std::size_t s = 0; s < sections.size(); ++s) {
    const auto& rows = sections[s].rows;
    std::size_t begin = 0;
    for (std::size_t k = 1; k <= rows.size(); ++k) {
      const bool ends = k == rows.size() || std::abs(rows[k].branch) != std::abs(rows[k - 1].branch) ||
                        (std::abs(rows[k].point) == 1 && std::abs(rows[k - 1].point) < 9990);
      if (!ends) continue;
      pieces.push_back({s, begin, k});
      begin = k;
    }
  }
  return pieces;
}

/// Same number as far as a file shows it: d-files and older p-files have 6 digits.
bool agree(double a, double b) {
  constexpr double six_digits = level::same;
  return !(std::abs(a - b) > six_digits * std::max(std::abs(a), std::abs(b)));
}

[[noreturn]] void tell_other_run(const BranchFile& file, const std::string& path, char letter,
                                 const std::string& what) {
  const std::string own = sibling_path(file.path, letter);
  const bool is_beside = own.empty() || own == path;
  throw UserError(fmt::format("{}: {}; it is of another run{}", path, what,
                              is_beside ? ": take it away, or compute the run anew" : ", the one needed is " + own));
}

/// Refuses a value of ICP(1) that is not that of the row.
void check_value(const BranchFile& file, std::size_t section, const PointRow& row, double value,
                 const std::string& path, char letter) {
  if (agree(value, row.values.front())) return;
  tell_other_run(file, path, letter,
                 fmt::format("point {}, label {} has {:.6g} where {} has {} = {:.6g}", std::abs(row.point), row.label,
                             value, file.path, file.sections[section].columns.front(), row.values.front()));
}

/// Calls use(section, row index, row) for every point.
void for_each_row(const BranchFile& file, const std::function<void(std::size_t, std::size_t, const PointRow&)>& use) {
  for (std::size_t s = 0; s < file.sections.size(); ++s)
    for (std::size_t k = 0; k < file.sections[s].rows.size(); ++k) use(s, k, file.sections[s].rows[k]);
}

/// ICP(1) of a section at a solution, when its column is a parameter.
std::optional<double> first_parameter(const PointSection& section, const LabelledSolution& solution) {
  const auto k = section.parameter_of_column(0);
  if (!k || *k < 1 || static_cast<std::size_t>(*k) > solution.parameters.size()) return std::nullopt;
  return solution.parameters[static_cast<std::size_t>(*k) - 1];
}

void match_solutions(BranchFile& file, const std::string& path) {
  std::map<int, int> by_label;
  for (std::size_t k = 0; k < file.solutions.size(); ++k) by_label[file.solutions[k].label] = static_cast<int>(k);
  int missing = 0;
  bool any = false;
  for_each_row(file, [&](std::size_t s, std::size_t k, const PointRow& row) {
    const auto found = row.label > 0 ? by_label.find(row.label) : by_label.end();
    if (row.label > 0 && found == by_label.end()) ++missing;
    if (found == by_label.end()) return;
    const LabelledSolution& solution = file.solutions[static_cast<std::size_t>(found->second)];
    if (solution.point != std::abs(row.point)) return;
    if (const auto value = first_parameter(file.sections[s], solution)) check_value(file, s, row, *value, path, 'q');
    file.solution[s][k] = found->second;
    any = true;
  });
  if (!any && missing > 0 && !file.solutions.empty())
    tell_other_run(file, path, 'q', fmt::format("it has none of the labels of {}", file.path));
  if (missing > 0)
    file.warnings.push_back(
        fmt::format("{}: {} of the labels of {} {} not in it (was the run that wrote it interrupted?)", path, missing,
                    file.path, missing == 1 ? "is" : "are"));
}

/// Both files list the points in the order of their computation; the d-file may lack some (IID = 0).
void match_diagnostics(BranchFile& file, const std::string& path) {
  if (file.diagnostics.empty())
    throw UserError(fmt::format("{}: no point in it; a run writes its diagnostics to d.NAME (fort.9)", path));
  using Key = std::array<int, 3>;
  std::map<Key, std::vector<int>> places;  // in descending order: the next one is the last
  for (int k = static_cast<int>(file.diagnostics.size()) - 1; k >= 0; --k) {
    const DiagnosticPoint& point = file.diagnostics[static_cast<std::size_t>(k)];
    places[{point.branch, point.point, point.label}].push_back(k);
  }
  std::size_t matched = 0;
  for_each_row(file, [&](std::size_t s, std::size_t k, const PointRow& row) {
    const auto found = places.find({row.branch, row.point, row.label});
    if (found == places.end() || found->second.empty()) return;
    const int place = found->second.back();
    found->second.pop_back();
    if (const auto value = file.diagnostics[static_cast<std::size_t>(place)].parameter)
      check_value(file, s, row, *value, path, 'd');
    file.diagnostic[s][k] = place;
    ++matched;
  });
  if (matched == file.diagnostics.size()) return;
  if (matched == 0) tell_other_run(file, path, 'd', fmt::format("it has none of the points of {}", file.path));
  file.warnings.push_back(fmt::format("{}: {} of its {} points are not in {}", path, file.diagnostics.size() - matched,
                                      file.diagnostics.size(), file.path));
}

void take_from_solutions(BranchFile& file) {
  for_each_row(file, [&file](std::size_t s, std::size_t k, const PointRow& row) {
    const LabelledSolution* solution = file.solution_of(s, k);
    if (solution == nullptr) return;
    file.types[s][k] = type_name(*solution);
    for (const UserPointKind& kind : all_kinds(*solution))
      if (kind.kind == UserPointKind::xi) file.xi_zeros[row.label].push_back(kind.index);
    if (file.parameters[s].empty())
      for (std::size_t p = 0; p < solution->parameters.size(); ++p)
        file.parameters[s][static_cast<int>(p) + 1] = solution->parameters[p];
  });
}

void take_from_diagnostics(BranchFile& file) {
  for_each_row(file, [&file](std::size_t s, std::size_t k, const PointRow& row) {
    const DiagnosticPoint* point = file.diagnostic_of(s, k);
    if (point == nullptr) return;
    file.admissible[s][k] = point->admissible;
    if (row.label > 0 && !point->xi_zeros.empty())
      file.xi_zeros[row.label] = point->xi_zeros;  // older q-files have one n
    if (file.types[s][k] == "UZ" && !point->type.empty()) file.types[s][k] = point->type;
  });
}

SegmentEnds ends_of_segments(const LabelledSolution& solution) {
  const int segments = segment_count(solution);
  if (segments == 0 || solution.states.cols() == 0 || solution.states.rows() % segments != 0) return {};
  const Eigen::Index n = solution.states.rows() / segments, last = solution.states.cols() - 1;
  SegmentEnds ends{Eigen::MatrixXd(n, segments), Eigen::MatrixXd(n, segments)};
  for (Eigen::Index s = 0; s < segments; ++s) {
    ends.first.col(s) = solution.states.col(0).segment(s * n, n);
    ends.last.col(s) = solution.states.col(last).segment(s * n, n);
  }
  return ends;
}

/// Only what a branch needs of them: the states are most of a q-file.
std::vector<LabelledSolution> without_states(std::vector<LabelledSolution> solutions) {
  for (LabelledSolution& solution : solutions) {
    solution.tau = {};
    solution.states.resize(0, 0);
    solution.state_direction.resize(0, 0);
    solution.parameter_direction = {};
  }
  return solutions;
}

void read_solutions(BranchFile& file, const std::string& path) {
  SolutionFile read = read_solution_file(path);
  file.ends.clear();
  for (const LabelledSolution& solution : read.solutions) file.ends.push_back(ends_of_segments(solution));
  file.solutions = without_states(std::move(read.solutions));
  file.warnings.insert(file.warnings.end(), read.warnings.begin(), read.warnings.end());
  match_solutions(file, path);
  take_from_solutions(file);
}

void read_diagnostics(BranchFile& file, const std::string& path) {
  file.diagnostics = read_diagnostics_file(path);
  match_diagnostics(file, path);
  take_from_diagnostics(file);
}

/// Forgets what has been matched.
void reset(std::vector<std::vector<int>>& places, const std::vector<PointSection>& sections) {
  places.clear();
  for (const PointSection& section : sections) places.emplace_back(section.rows.size(), -1);
}

/// The file named, or the one beside the p-file; what cannot be used of that one is a warning with `lost`.
void read_further(BranchFile& file, const std::string& named, char letter, const std::string& lost,
                  const std::function<void(const std::string&)>& read, const std::function<void()>& forget) {
  if (!named.empty()) return read(named);
  const std::string path = sibling_path(file.path, letter);
  std::error_code error;
  if (path.empty() || !std::filesystem::is_regular_file(path, error)) return;
  try {
    read(path);
  } catch (const UserError& refused) {
    forget();
    file.warnings.push_back(fmt::format("{}\n  ({} are left out)", refused.what(), lost));
  }
}

/// all[place], nullptr at -1.
template <class T>
const T* element(const std::vector<T>& all, int place) {
  return place < 0 ? nullptr : &all[static_cast<std::size_t>(place)];
}

}  // namespace

const LabelledSolution* BranchFile::solution_of(std::size_t section, std::size_t row) const {
  return element(solutions, solution[section][row]);
}

const SegmentEnds* BranchFile::ends_of(std::size_t section, std::size_t row) const {
  // The other direction of a run begins at the same point, which has its label in the first one.
  const bool is_other_begin = row == 0 && section > 0 && solution[section][row] < 0 &&
                              sections[section].rows[0].values == sections[section - 1].rows[0].values;
  return element(ends, solution[is_other_begin ? section - 1 : section][row]);
}

const DiagnosticPoint* BranchFile::diagnostic_of(std::size_t section, std::size_t row) const {
  return element(diagnostics, diagnostic[section][row]);
}

BranchFile read_branch_file(const std::string& path, const std::string& solutions, const std::string& diagnostics) {
  PointFile points = read_point_file(path);
  BranchFile file;
  file.path = path;
  file.name = run_name(path);
  file.sections = std::move(points.sections);
  file.warnings = std::move(points.warnings);
  file.pieces = split_into_pieces(file.sections);
  file.parameters.resize(file.sections.size());
  for (const PointSection& section : file.sections) {
    file.admissible.emplace_back(section.rows.size(), true);
    file.types.emplace_back();
    for (const PointRow& row : section.rows) file.types.back().push_back(type_name(row.type));
  }
  reset(file.solution, file.sections);
  reset(file.diagnostic, file.sections);
  read_further(
      file, solutions, 'q', "names of UZ points and fixed parameters",
      [&file](const std::string& q) { read_solutions(file, q); }, [&file] { reset(file.solution, file.sections); });
  read_further(
      file, diagnostics, 'd', "multipliers and admissibility",
      [&file](const std::string& d) { read_diagnostics(file, d); }, [&file] { reset(file.diagnostic, file.sections); });
  return file;
}

BranchFile read_branch_file(const std::string& path) { return read_branch_file(path, "", ""); }

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
