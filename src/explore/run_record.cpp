#include "explore/branch_ends.hpp"

#include <cstdlib>
#include <string_view>

#include "base/levels.hpp"
#include "base/words.hpp"
#include "files/diagnostics_file.hpp"
#include "files/solution_file_reader.hpp"

namespace tchat {

namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    lines.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  return lines;
}

/// A long message without its explanations, which the log has.
std::string first_part(const std::string& text) {
  constexpr std::size_t short_enough = 120;
  if (text.size() <= short_enough) return text;
  const std::size_t end = text.find_first_of(":;", short_enough / 3);
  return end <= short_enough ? text.substr(0, end) : text.substr(0, short_enough) + "...";
}

}  // namespace

std::vector<std::string> branch_ends(const std::string& log) {
  constexpr std::string_view mark = "  stopped: ";
  constexpr std::string_view folded = "    ";  // of the further lines of a long one
  std::vector<std::string> ends;
  bool is_in_one = false;
  for (const std::string& line : lines_of(log)) {
    if (line.starts_with(mark)) {
      ends.push_back(line.substr(mark.size()));
      is_in_one = true;
    } else if (is_in_one && line.starts_with(folded)) {
      ends.back() += " " + std::string(trimmed(line));
    } else {
      is_in_one = false;
    }
  }
  return ends;
}

std::string failure_text(const std::string& log) {
  constexpr std::string_view mark = "tchat: ";
  std::string text;
  for (const std::string& line : lines_of(log)) {
    if (line.starts_with("tchat: warning")) continue;
    if (line.starts_with(mark))
      text = line.substr(mark.size());
    else if (text.empty() && !trimmed(line).empty())
      text = line;
  }
  return first_part(text);
}

AdmissiblePoints admissible_points(const std::string& path) {
  AdmissiblePoints result;
  bool some_beyond = false, some_left = false;
  for (const DiagnosticPoint& point : read_diagnostics_file(path)) {
    ++result.points;
    result.inadmissible += point.admissible ? 0 : 1;
    if (std::abs(point.point) > 1) {
      some_beyond = true;
      some_left = some_left || point.admissible;
    }
    if (point.label > 0) result.labels[point.label] = point.admissible;
  }
  result.only_at_start = some_beyond && !some_left;
  return result;
}

int other_field_at_rest(const HybridSystem& system, const LabelledSolution& solution, int field) {
  constexpr double at_rest = level::located;  // a located point is known to EPSS
  const LabelledSolution own = in_layout(solution, system.layout());
  const int n = system.dimension();
  if (own.states.rows() < n || own.states.cols() < 1) return 0;
  const Eigen::VectorXd x = own.states.col(0).head(n);
  for (int i = 1; i <= system.count(FunctionKind::field); ++i) {
    if (i == field) continue;
    Eigen::VectorXd f(n);
    system.value(FunctionKind::field, i, x.data(), own.parameters.data(), f.data());
    if (f.norm() <= at_rest * (1.0 + x.norm())) return i;
  }
  return 0;
}

}  // namespace tchat
