#include "files/point_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "files/labelled_solution.hpp"
#include "files/number_format.hpp"
#include "settings/family.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

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

}  // namespace tchat
