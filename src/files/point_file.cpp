#include "files/point_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <numeric>

#include "files/auto_format.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

constexpr int most_screen_columns = 7;

std::string name_at(const std::vector<std::string>& names, int k, const char* symbol) {
  if (k >= 1 && static_cast<std::size_t>(k) <= names.size()) return names[static_cast<std::size_t>(k) - 1];
  return fmt::format("{}({})", symbol, k);
}

PointColumn parameter_column(int k, const RunSettings& settings, const ProblemNames& names) {
  const int segment = is_duration(settings, k) ? settings.layout.duration_segment(k) + 1 : 0;
  return {PointColumn::Kind::parameter, k, names.parameter(k), segment};
}

}  // namespace

ProblemNames ProblemNames::of(const HybridSystem& system) {
  ProblemNames names;
  for (int k = 1; k <= system.dimension(); ++k) names.states.push_back(system.state_name(k));
  for (int k = 1; k <= system.parameters(); ++k) names.parameters.push_back(system.parameter_name(k));
  const tchat_problem& table = system.table();
  for (int k = 0; k < table.user_values; ++k) {
    const bool named = table.user_value_names != nullptr && table.user_value_names[k] != nullptr;
    names.user_functions.push_back(named ? table.user_value_names[k] : fmt::format("PVLS({})", k + 1));
  }
  for (int k = 1; k <= system.count(FunctionKind::event); ++k)
    names.events.push_back(system.function_name(FunctionKind::event, k));
  for (int k = 1; k <= system.count(FunctionKind::jump); ++k)
    names.jumps.push_back(system.function_name(FunctionKind::jump, k));
  return names;
}

ProblemNames ProblemNames::of(const HybridSystem& system, const RunSettings& settings) {
  ProblemNames names = of(system);
  if (settings.monitors.empty()) return names;
  while (names.parameters.size() + 1 < static_cast<std::size_t>(first_monitor(settings)))
    names.parameters.push_back(fmt::format("PAR({})", names.parameters.size() + 1));
  names.parameters.insert(names.parameters.end(), settings.monitors.begin(), settings.monitors.end());
  return names;
}

void ProblemNames::set_parameter(int k, const std::string& name) {
  while (parameters.size() < static_cast<std::size_t>(k))
    parameters.push_back(fmt::format("PAR({})", parameters.size() + 1));
  parameters[static_cast<std::size_t>(k) - 1] = name;
}

std::string ProblemNames::state(int k) const { return name_at(states, k, "U"); }

std::string ProblemNames::parameter(int k) const { return name_at(parameters, k, "PAR"); }

PointColumn measure_column(int selector, int dimension, const ProblemNames& names) {
  using Kind = PointColumn::Kind;
  if (selector == 0 || selector > 3 * dimension || selector < -dimension) return {Kind::l2_norm, 0, "L2-NORM"};
  const int k = (std::abs(selector) - 1) % dimension + 1;
  const std::string name = names.state(k);
  if (selector < 0) return {Kind::minimum, k, "MIN " + name};
  if (selector <= dimension) return {Kind::maximum, k, "MAX " + name};
  if (selector <= 2 * dimension) return {Kind::integral, k, "INTEGRAL " + name};
  return {Kind::component_l2_norm, k, "L2-NORM " + name};
}

std::vector<PointColumn> point_columns(const RunSettings& settings, const ProblemNames& names) {
  const std::vector<int>& free = settings.free_parameters;
  const auto problem_parameters =
      static_cast<int>(std::count_if(free.begin(), free.end(), [&](int k) { return !is_duration(settings, k); }));
  const int maxima = std::clamp(most_screen_columns - problem_parameters, 0, settings.dimension);

  std::vector<PointColumn> columns;
  if (!free.empty()) columns.push_back(parameter_column(free.front(), settings, names));
  columns.push_back(measure_column(settings.measure, settings.dimension, names));
  const FileHeadings& headings = family_of(settings.problem_type).facts().headings;
  for (int k = 1; k <= maxima; ++k)
    columns.push_back({PointColumn::Kind::maximum, k, headings.maximum + names.state(k)});
  for (std::size_t i = 1; i < free.size(); ++i) columns.push_back(parameter_column(free[i], settings, names));
  const auto is_listed = [&](const std::string& name) {
    return std::any_of(free.begin(), free.end(),
                       [&](int k) { return is_monitor(settings, k) && names.parameter(k) == name; });
  };
  for (std::size_t i = 0; i < names.user_functions.size(); ++i)
    if (!is_listed(names.user_functions[i]))
      columns.push_back({PointColumn::Kind::user_function, static_cast<int>(i) + 1, names.user_functions[i]});
  if (headings.has_period) columns.push_back({PointColumn::Kind::period, 0, "PERIOD"});
  return columns;
}

namespace {

constexpr const char* line_start = "   0";
constexpr int point_column_width = 19;
constexpr std::size_t longest_heading = point_column_width - 2;

/// One header line of `KEY = value` pairs in AUTO's columns.
class ConstantsLine {
 public:
  ConstantsLine& integer(const char* key, int value) { return text(key, fmt::format("{:>4}", value)); }
  ConstantsLine& count(const char* key, int value) { return append(key, 7, fmt::format("{:>5}", value)); }
  ConstantsLine& real(const char* key, double value) { return text(key, es(value, 11, 4)); }
  ConstantsLine& text(const char* key, const std::string& value) { return append(key, 8, value); }
  /// An entry of any length.
  ConstantsLine& pair(const char* key, const std::string& value) {
    line_ += fmt::format("   {} = {}", key, value);
    return *this;
  }
  std::string str() const { return line_ + '\n'; }

 private:
  ConstantsLine& append(const char* key, int width, const std::string& value) {
    line_ += fmt::format("{:>{}}{}", fmt::format("{:<4}=", key), width, value);
    return *this;
  }
  std::string line_ = line_start;
};

std::string start_text(const StartLabel& start) {
  return fmt::format("{:>4}", start.type + fmt::format("{}", start.number));
}

std::string number(double value) { return fmt::format("{}", finite(value)); }

std::string weights(const std::vector<IndexedValue>& values) {
  std::string list;
  for (const IndexedValue& value : values)
    list += fmt::format("{}{}: {}", list.empty() ? "" : ", ", value.index, number(value.value));
  return "{" + list + "}";
}

/// {1: [2.5, 3.0], 2: 4.0}: the values of one parameter stand together.
std::string user_values(const std::vector<UserValue>& all, bool stop) {
  std::map<int, std::vector<std::string>> by_parameter;
  for (const UserValue& value : all)
    if (value.stop == stop) by_parameter[value.parameter].push_back(number(value.value));
  std::string list;
  for (const auto& [parameter, values] : by_parameter) {
    const bool one = values.size() == 1;
    list += fmt::format("{}{}: {}{}{}", list.empty() ? "" : ", ", parameter, one ? "" : "[", fmt::join(values, ", "),
                        one ? "" : "]");
  }
  return list.empty() ? "" : "{" + list + "}";
}

std::string name_dictionary(const std::vector<std::string>& names, const char* symbol) {
  std::string list;
  for (std::size_t k = 1; k <= names.size(); ++k)
    if (names[k - 1] != fmt::format("{}({})", symbol, k))
      list += fmt::format("{}{}: '{}'", list.empty() ? "" : ", ", k, plain_name(names[k - 1]));
  return list.empty() ? "" : "{" + list + "}";
}

/// Names of columns whose headings are cut, in full, by the number of the column.
std::string long_names(const std::vector<PointColumn>& columns) {
  std::string list;
  for (std::size_t k = 1; k <= columns.size(); ++k)
    if (const std::string name = plain_name(columns[k - 1].name); name.size() > longest_heading)
      list += fmt::format("{}{}: '{}'", list.empty() ? "" : ", ", k, name);
  return list.empty() ? "" : "{" + list + "}";
}

std::string signature_text(const RunSettings& settings) {
  std::string list;
  for (const SegmentSettings& segment : settings.segments)
    list += fmt::format("{}[{}, {}, {}]", list.empty() ? "" : ", ", segment.index.field, segment.index.event,
                        segment.index.jump);
  return "[" + list + "]";
}

std::string stop_text(const std::vector<StopRule>& rules) {
  std::string list;
  for (const StopRule& rule : rules) list += fmt::format("{}'{}{}'", list.empty() ? "" : ", ", rule.type, rule.count);
  return "[" + list + "]";
}

std::string constants_lines(const RunSettings& s) {
  std::string text = line_start + std::string(" ") + es(s.parameter_min, 12, 4) + es(s.parameter_max, 12, 4) +
                     es(s.measure_min, 12, 4) + es(s.measure_max, 12, 4) + '\n';
  text += ConstantsLine()
              .real("EPSL", s.tolerance_parameters)
              .real("EPSU", s.tolerance_states)
              .real("EPSS", s.tolerance_special)
              .str();
  text += ConstantsLine().real("DS", s.step).real("DSMIN", s.step_min).real("DSMAX", s.step_max).str();
  text += ConstantsLine()
              .integer("NDIM", s.dimension)
              .integer("IPS", s.problem_type)
              .text("IRS", start_text(s.start))
              .integer("ILP", s.detect_folds)
              .str();
  text += ConstantsLine()
              .integer("NTST", s.mesh_intervals)
              .integer("NCOL", s.collocation_points)
              .integer("IAD", s.adapt_mesh_every)
              .integer("ISP", s.detect_bifurcations)
              .str();
  text += ConstantsLine()
              .integer("ISW", s.branch_mode)
              .integer("IPLT", s.measure)
              .integer("NBC", s.boundary_conditions)
              .integer("NINT", s.integral_conditions)
              .str();
  text += ConstantsLine()
              .count("NMX", s.max_points)
              .count("NPR", s.print_every)
              .integer("MXBF", s.max_bifurcations)
              .integer("IID", s.diagnostics_level)
              .integer("IADS", s.adapt_step_every)
              .str();
  text += ConstantsLine()
              .integer("ITMX", s.max_location_iterations)
              .integer("ITNW", s.max_newton)
              .integer("NWTN", s.full_newton)
              .integer("JAC", s.jacobian)
              .integer("NUZR", static_cast<int>(s.user_values.size()))
              .str();
  return text;
}

std::string list_lines(const PointFileHeader& header) {
  const RunSettings& s = header.settings;
  const int segments = static_cast<int>(s.segments.size());
  const bool has_rotation = family_of(s.problem_type).facts().has_rotation;
  std::string text = ConstantsLine()
                         .integer("NPAR", s.layout.stored(segments, has_rotation))
                         .pair("THL", weights(s.parameter_weights))
                         .pair("THU", weights(s.state_weights))
                         .str();
  const auto add = [&text](const char* key, const std::string& value) {
    if (!value.empty()) text += ConstantsLine().pair(key, value).str();
  };
  add("UZR", user_values(s.user_values, false));
  add("UZSTOP", user_values(s.user_values, true));
  if (!s.stop_rules.empty()) add("STOP", stop_text(s.stop_rules));
  add("unames", name_dictionary(header.names.states, "U"));
  add("parnames", name_dictionary(header.names.parameters, "PAR"));
  add("eventnames", name_dictionary(header.names.events, "h"));
  add("jumpnames", name_dictionary(header.names.jumps, "g"));
  text += ConstantsLine()
              .integer("NSEG", segments)
              .integer("GRSTOP", s.stop_at_grazing ? 1 : 0)
              .integer("GRJUMP", s.grazing_jump)
              .pair("SIGNATURE", signature_text(s))
              .str();
  if (const int parameters = s.layout.recorded(has_rotation); parameters > 0)
    text += ConstantsLine().pair("PARAMETERS", fmt::format("{}", parameters)).str();
  return text;
}

std::string parameter_line(const char* title, const std::vector<int>& parameters) {
  std::string line =
      fmt::format("{}   {} {}:   ", line_start, title, parameters.size() == 1 ? "parameter" : "parameters");
  for (const int k : parameters) line += fmt::format("{:4}", k);
  return line + '\n';
}

}  // namespace

std::string format_point_header(const PointFileHeader& header, const std::vector<PointColumn>& columns) {
  std::string text = constants_lines(header.settings) + list_lines(header);
  text += parameter_line("User-specified", header.settings.free_parameters);
  text += parameter_line("Active continuation", header.active_parameters);
  if (header.curve_type != 0)
    text += fmt::format("{}   Branch type: {}  TY = '{}'\n", line_start, header.curve_type,
                        curve_name(header.settings.problem_type, header.curve_type));
  if (const std::string names = long_names(columns); !names.empty())
    text += ConstantsLine().pair("columns", names).str();
  text += std::string(line_start) + '\n' + line_start + "    PT  TY  LAB ";
  for (const PointColumn& column : columns) text += heading_field(column.name, point_column_width);
  return text + '\n';
}

void append_point(std::string& text, const PointLine& point) {
  append_branch_and_point(text, point.branch, point.point, point.stable ? -1 : 1);
  append_integer_field(text, point.type, 4);
  append_integer_field(text, point.label, 5);
  for (const double value : point.values) append_e19(text, value);
  text += '\n';
}

std::string format_point(const PointLine& point) {
  std::string text;
  append_point(text, point);
  return text;
}

namespace {

constexpr std::size_t most_columns = 5;
constexpr int column_width = 13;

bool is_of_duration(const PointColumn& column) { return column.segment > 0; }

/// What the screen shows first: 0 always, then in this order as far as there is room.
int rank(const PointColumn& column, std::size_t place) {
  using Kind = PointColumn::Kind;
  const bool is_parameter = column.kind == Kind::parameter;
  if (place == 0 || column.kind == Kind::period || (is_parameter && !is_of_duration(column))) return 0;
  if (place == 1) return 1;  // the solution measure
  if (column.kind == Kind::user_function) return 2;
  return is_of_duration(column) ? 4 : 3;
}

/// The columns shown, in the file's order.
std::vector<std::size_t> shown(const std::vector<PointColumn>& columns) {
  std::vector<std::size_t> chosen(columns.size());
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  std::stable_sort(chosen.begin(), chosen.end(),
                   [&](std::size_t a, std::size_t b) { return rank(columns[a], a) < rank(columns[b], b); });
  chosen.resize(std::min(chosen.size(), most_columns));
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace

std::string shown_name(const PointColumn& column) {
  return is_of_duration(column) ? fmt::format("T{}", column.segment) : column.name;
}

std::string format_table_heading(const std::vector<PointColumn>& columns) {
  std::string line = "  BR    PT  TY  LAB";
  for (const std::size_t k : shown(columns)) {
    const std::string heading = heading_field(shown_name(columns[k]), column_width);
    const bool touches = line.back() != ' ' && heading.front() != ' ';  // a long name in the first column
    line += touches ? " " + heading.substr(0, heading.size() - 1) : heading;
  }
  return line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
}

std::string format_table_line(const PointLine& point, const std::vector<PointColumn>& columns) {
  const bool shows_type = basic_type(point.type) != static_cast<int>(PointType::regular);
  std::string line;
  append_branch_and_point(line, point.branch, point.point, point.stable ? -1 : 1);
  line += fmt::format("{:>4}", shows_type ? type_name(point.type, point.kind) : "");
  append_integer_field(line, point.label, 5);
  for (const std::size_t k : shown(columns))
    line += fmt::format(" {:>{}.5E}", finite(point.values[k]), column_width - 1);
  if (!point.admissible) line += "  inadmissible";
  return line + '\n';
}

}  // namespace tchat
