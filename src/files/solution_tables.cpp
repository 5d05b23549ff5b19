#include "files/solution_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "base/messages.hpp"
#include "settings/point_type.hpp"

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

namespace {

std::string number_or_dash(int number) { return number > 0 ? fmt::format("{}", number) : "-"; }

/// A start that was made by `tchat resegment` has no direction, and which parameters are free is for its constants.
std::string free_parameters(const LabelledSolution& solution, int segments, const ProblemNames& names) {
  if (solution.free_parameters.empty()) return "those of ICP";
  std::string list;
  for (const int k : solution.free_parameters)
    if (!solution.layout.is_duration(k, segments))
      list += fmt::format("{}{} = {:.9g}", list.empty() ? "" : ", ", names.parameter(k), stored_parameter(solution, k));
  return list;
}

std::string yes_or_no(const std::optional<bool>& answer) { return !answer ? "-" : *answer ? "yes" : "no"; }

/// What a point is, as the run has said it, else as the q-file tells it; its normal form, and what it violates.
std::vector<std::string> remarks(const LabelledSolution& solution, const RecordedLabel& label,
                                 const ProblemNames& names) {
  std::vector<std::string> list;
  const std::string what =
      !label.words.empty() ? label.words : description(solution, [&names](int k) { return names.parameter(k); });
  if (!what.empty()) list.push_back(what);
  if (label.normal_form) list.push_back(format_normal_form(*label.normal_form, ""));
  if (!label.admissible) list.push_back("inadmissible" + (label.violation.empty() ? "" : ": " + label.violation));
  return list;
}

/// A line of at most 100 characters where a remark fits, else lines of their own for the remarks.
std::string with_remarks(std::string line, const std::vector<std::string>& remarks) {
  constexpr std::size_t width = 100;
  const std::string indent(10, ' ');
  std::string below;
  for (const std::string& remark : remarks) {
    if (below.empty() && line.size() + 3 + remark.size() <= width) {
      line += "   " + remark;
      continue;
    }
    std::string rest = remark;
    for (std::size_t blank = 0; indent.size() + rest.size() > width; rest = rest.substr(blank + 1)) {
      blank = rest.rfind(' ', width - indent.size());
      if (blank == std::string::npos || blank == 0) break;
      below += indent + rest.substr(0, blank) + '\n';
    }
    below += indent + rest + '\n';
  }
  return line + '\n' + below;
}

/// n and m of an orbit, from the solution or from the n that the user gave.
struct OrbitSizes {
  int dimension;
  int segments;
};

OrbitSizes sizes_of(const LabelledSolution& solution, const std::string& name, int dimension) {
  const auto rows = static_cast<int>(solution.states.rows());
  if (dimension > 0 && rows % dimension != 0)
    throw UserError(
        fmt::format("{}: its {} states are not a whole number of segments of dimension {}; the dimension "
                    "must divide {}",
                    name, rows, dimension, rows));
  const int segments = dimension > 0 ? rows / dimension : segment_count(solution);
  if (segments == 0)
    throw UserError(
        fmt::format("{}: the file does not tell how many of its {} states belong to one segment; give the "
                    "dimension of the problem, as in --dimension 4",
                    name, rows));
  return {rows / segments, segments};
}

/// Parameters of the problem, from PAR(1) on: free ones, those with a name, and those that are not zero.
std::vector<int> known_parameters(const LabelledSolution& solution, const ProblemNames& names) {
  std::vector<int> known;
  const auto stored = static_cast<int>(solution.parameters.size());
  for (int k = 1; k <= stored; ++k) {
    if (!solution.layout.is_parameter(k, segment_count(solution))) continue;
    const auto& free = solution.free_parameters;
    const bool is_free = std::find(free.begin(), free.end(), k) != free.end();
    const bool is_named = names.parameter(k) != fmt::format("PAR({})", k);
    if (is_free || is_named || stored_parameter(solution, k) != 0.0) known.push_back(k);
  }
  return known;
}

std::string heading(const LabelledSolution& solution, const std::string& name, const OrbitSizes& sizes,
                    const ProblemNames& names) {
  const std::string type = type_name(solution);
  double period = 0.0;
  for (int s = 0; s < sizes.segments; ++s) period += duration(solution, s);
  std::string text =
      fmt::format("# {}: label {}{}, {} segment{}, period {:.10g}\n", name, solution.label,
                  type.empty() ? "" : " (" + type + ")", sizes.segments, sizes.segments == 1 ? "" : "s", period);
  for (const int k : known_parameters(solution, names))
    text += fmt::format("# {} = {:.10g}\n", names.parameter(k), stored_parameter(solution, k));
  std::vector<std::string> states;
  for (int k = 1; k <= sizes.dimension; ++k) {
    states.push_back(names.state(k));
    std::replace(states.back().begin(), states.back().end(), ' ', '_');  // a blank would make two columns of it
  }
  text += fmt::format("#{:>3}{:>19}{:>19}", "seg", own_heading("tau", states), own_heading("t", states));
  for (const std::string& state : states) text += fmt::format(" {:>18}", state);
  return text + '\n';
}

/// A point of an orbit in physical time.
struct OrbitPoint {
  int segment;  ///< from 1
  double tau;
  double t;
  Eigen::Ref<const Eigen::VectorXd> states;  ///< n
};

/// Calls use(OrbitPoint) for every point, segment after segment.
template <class Use>
void for_each_point(const LabelledSolution& solution, const OrbitSizes& sizes, const Use& use) {
  double start = 0.0;
  for (int s = 0; s < sizes.segments; ++s) {
    const double length = duration(solution, s);
    for (std::size_t k = 0; k < solution.tau.size(); ++k) {
      const double tau = solution.tau[k];
      const auto states = solution.states.col(static_cast<Eigen::Index>(k));
      use(OrbitPoint{s + 1, tau, start + tau * length, states.segment(s * sizes.dimension, sizes.dimension)});
    }
    start += length;
  }
}

}  // namespace

std::string format_label_table(const SolutionFile& file, const ProblemNames& names,
                               const std::map<int, RecordedLabel>& recorded) {
  std::string text = fmt::format("{:>5} {:>3} {:>3} {:>5} {:>4} {:>4} {:>9} {:>6} {:>13}  {}\n", "LAB", "TY", "BR",
                                 "PT", "IPS", "SEG", "NTSTxNCOL", "STABLE", "PERIOD", "FREE PARAMETERS");
  for (const LabelledSolution& solution : file.solutions) {
    const int segments = segment_count(solution);
    const auto found = recorded.find(solution.label);
    const RecordedLabel label = found != recorded.end() ? found->second : RecordedLabel{};
    const std::string line =
        fmt::format("{:>5} {:>3} {:>3} {:>5} {:>4} {:>4} {:>9} {:>6} {:>13}  {}", solution.label, type_name(solution),
                    solution.branch, solution.point, number_or_dash(solution.problem_type), number_or_dash(segments),
                    fmt::format("{}x{}", solution.mesh_intervals, solution.collocation_points), yes_or_no(label.stable),
                    segments > 0 ? fmt::format("{:.9g}", period(solution)) : "-",
                    free_parameters(solution, segments > 0 ? segments : max_segments, names));
    text += with_remarks(line, remarks(solution, label, names));
  }
  return text;
}

std::string format_orbit_table(const LabelledSolution& solution, const std::string& name, const ProblemNames& names,
                               int dimension) {
  const OrbitSizes sizes = sizes_of(solution, name, dimension > 0 ? dimension : solution.dimension);
  std::string text = heading(solution, name, sizes, names);
  int last_segment = 1;
  for_each_point(solution, sizes, [&](const OrbitPoint& point) {
    if (std::exchange(last_segment, point.segment) != point.segment) text += '\n';
    text += fmt::format("{:4}{:19.10E}{:19.10E}", point.segment, point.tau, point.t);
    for (const double state : point.states) text += fmt::format("{:19.10E}", state);
    text += '\n';
  });
  return text;
}

std::string format_orbit_csv(const LabelledSolution& solution, const std::string& name, const ProblemNames& names,
                             int dimension) {
  const OrbitSizes sizes = sizes_of(solution, name, dimension > 0 ? dimension : solution.dimension);
  std::vector<std::string> fields;
  for (int k = 1; k <= sizes.dimension; ++k) fields.push_back(names.state(k));
  fields = distinct_headings(fields);
  const std::vector<std::string> own{own_heading("segment", fields), own_heading("tau", fields),
                                     own_heading("t", fields)};
  fields.insert(fields.begin(), own.begin(), own.end());
  for (std::string& field : fields) field = csv_field(field);
  std::string text = csv_line(fields);
  for_each_point(solution, sizes, [&](const OrbitPoint& point) {
    fields = {csv_field(point.segment), csv_field(point.tau), csv_field(point.t)};
    for (const double state : point.states) fields.push_back(csv_field(state));
    text += csv_line(fields);
  });
  return text;
}

void write_point_types(TableWriter& out) {
  out.begin({{"type"}, {"number"}, {"kind"}, {"codimension_two"}, {"meaning"}});
  for (const PointTypeFacts& row : point_types())
    out.row({TableCell(std::string(row.name)), TableCell(row.number), TableCell(row.kind), TableCell(row.is_whole),
             TableCell(std::string(row.meaning))});
  out.end();
}

}  // namespace tchat
