#include "files/solution_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "files/auto_format.hpp"
#include "settings/constant_value.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

std::string type_name(const LabelledSolution& solution) { return type_name(solution.type, solution.kind); }

std::vector<std::string> type_names(const LabelledSolution& solution) {
  return type_names(solution.type, solution.kind, solution.further);
}

std::vector<int> basic_types(const LabelledSolution& solution, const std::string& asked_for) {
  std::vector<int> types{basic_type(solution.type)};
  for (const UserPointKind& other : solution.further)
    if (counts_beside(solution.type, other))
      types.push_back(other.kind == UserPointKind::other_type ? other.index : static_cast<int>(PointType::user));
  std::stable_partition(types.begin(), types.end(), [&](int type) { return type_name(type) == asked_for; });
  return types;
}

std::vector<UserPointKind> all_kinds(const LabelledSolution& solution) {
  std::vector<UserPointKind> kinds{solution.kind};
  kinds.insert(kinds.end(), solution.further.begin(), solution.further.end());
  return kinds;
}

std::string description(const LabelledSolution& solution, const std::function<std::string(int)>& parameter_name) {
  std::string text;
  for (const UserPointKind& kind : all_kinds(solution)) {
    const std::string what =
        description(kind, kind.kind == UserPointKind::user_value ? parameter_name(kind.index) : "");
    if (!what.empty()) text += (text.empty() ? "" : "; ") + what;
  }
  return text;
}

namespace {

/// Throws when a condition on the line at `place` does not hold.
struct Requirement {
  const std::string& place;
  void operator()(bool condition, const std::string& found) const {
    if (!condition)
      throw UserError(
          fmt::format("{}: {}; the first line of this solution is damaged: restore the file", place, found));
  }
};

/// The states are a whole number of segments, and PAR has room for their durations.
void check_segments(const SolutionIdentifier& id, const Requirement& need) {
  need(id.dimension() >= 1 && id.states() % id.dimension() == 0,
       fmt::format("{} states (integer 8 less 1) are not a whole number of segments of dimension {} (integer 14)",
                   id.states(), id.dimension()));
  const std::int64_t segments = id.states() / id.dimension();
  need(segments <= max_segments,
       fmt::format("{} segments (integer 8 less 1, over integer 14), at most {} allowed", segments, max_segments));
  need(id.values[15] >= 0 && id.values[15] <= most_parameters,
       fmt::format("{} parameters of the problem (integer 16), 0 to {} allowed", id.values[15], most_parameters));
  const int first = id.layout().first_duration();
  need(id.parameters() - id.internal_parameters() >= first - 1 + segments,
       fmt::format("NPAR = {} parameters (integer 12) have no room for the durations PAR({}..{})", id.parameters(),
                   first, first - 1 + segments));
}

}  // namespace

std::int64_t SolutionIdentifier::numbers(bool direction) const {
  const std::int64_t plain = time_points() * numbers_per_point() + parameters();
  return direction ? plain + 2 * free_parameters() + time_points() * states() : plain;
}

std::int64_t SolutionIdentifier::standard_lines(bool direction) const {
  const std::int64_t plain = (states() / 7 + 1) * time_points() + (parameters() + 6) / 7;
  if (!direction) return plain;
  return plain + (free_parameters() + 19) / 20 + (free_parameters() + 6) / 7 + (states() + 6) / 7 * time_points();
}

void check_numbering(const SolutionIdentifier& id, const std::string& place) {
  constexpr int largest = 999'999'999;
  const Requirement need{place};
  need(id.branch() <= largest, fmt::format("branch {} (integer 1) is greater than {}", id.values[0], largest));
  need(id.label() >= 0, fmt::format("label {} (integer 4) is negative", id.label()));
  need(id.label() <= largest, fmt::format("label {} (integer 4) is greater than {}", id.label(), largest));
}

void check_counts(const SolutionIdentifier& id, const std::string& place) {
  const Requirement need{place};
  need(id.free_parameters() >= 0, fmt::format("NFPR = {} free parameters (integer 5)", id.free_parameters()));
  need(id.time_points() >= 1, fmt::format("NTPL = {} time points (integer 7), at least 1 expected", id.time_points()));
  need(id.numbers_per_point() >= 2, fmt::format("NAR = {} numbers per time point (integer 8), t and at least one state "
                                                "expected",
                                                id.numbers_per_point()));
  need(id.lines() >= 1, fmt::format("NROWPR = {} lines (integer 9), at least 1 expected", id.lines()));
  need(id.mesh_intervals() >= 0 && id.collocation_points() >= 0,
       fmt::format("NTST = {} or NCOL = {} (integers 10 and 11) is negative", id.mesh_intervals(),
                   id.collocation_points()));
  const std::int64_t nodes = id.mesh_intervals() * id.collocation_points() + 1;
  need(id.time_points() == nodes,
       fmt::format("NTPL = {} time points (integer 7), but NTST NCOL + 1 = {}", id.time_points(), nodes));
  need(id.parameters() >= 0, fmt::format("NPAR = {} parameters (integer 12)", id.parameters()));
  need(id.internal_parameters() >= 0 && id.internal_parameters() <= id.parameters(),
       fmt::format("NPARI = {} internal values (integer 13) of NPAR = {} parameters", id.internal_parameters(),
                   id.parameters()));
  need(id.dimension() >= 0, fmt::format("NDIM = {} (integer 14)", id.dimension()));
  if (id.is_ours()) check_segments(id, need);
}

void check_line_count(const SolutionIdentifier& id, const std::string& place) {
  const Requirement need{place};
  need(
      id.lines() == id.standard_lines(false) || id.lines() == id.standard_lines(true),
      fmt::format("NROWPR = {} lines (integer 9) are announced, the file has fewer, and the other counts make it {} or "
                  "{} lines",
                  id.lines(), id.standard_lines(false), id.standard_lines(true)));
}

namespace {

constexpr int numbers_per_line = 7;
constexpr int integers_per_line = 20;

/// Lines that `count` items take, `per_line` on each.
int lines_for(int count, int per_line) { return (count + per_line - 1) / per_line; }

void require(bool condition, const char* what) {
  if (!condition) throw std::invalid_argument(what);
}

/// The sizes of an entry.
struct EntrySizes {
  int points = 0;
  int states = 0;
  int segments = 0;
  int free_parameters = 0;
  int parameters = 0;  ///< NPAR
  int internal = 0;    ///< NPARI, the last of them
  int recorded = 0;    ///< P

  int lines(bool direction) const {
    const int record = lines_for(states + 1, numbers_per_line);
    const int plain = record * points + lines_for(parameters, numbers_per_line);
    if (!direction) return plain;
    return plain + lines_for(free_parameters, integers_per_line) + lines_for(free_parameters, numbers_per_line) +
           lines_for(states, numbers_per_line) * points;
  }
};

EntrySizes checked_sizes(const LabelledSolution& solution) {
  EntrySizes sizes;
  sizes.points = static_cast<int>(solution.states.cols());
  sizes.states = static_cast<int>(solution.states.rows());
  sizes.free_parameters = static_cast<int>(solution.free_parameters.size());
  require(sizes.points == solution.mesh_intervals * solution.collocation_points + 1, "time points do not fit the mesh");
  require(solution.tau.size() == static_cast<std::size_t>(sizes.points), "tau does not fit the states");
  require(solution.dimension > 0 && sizes.states > 0 && sizes.states % solution.dimension == 0,
          "states are not a whole number of segments");
  sizes.segments = sizes.states / solution.dimension;
  sizes.internal = kind_values * (1 + static_cast<int>(solution.further.size()));
  if (!solution.own_mesh.empty())
    sizes.internal +=
        kind_values + static_cast<int>(own_mesh_values(static_cast<std::int64_t>(solution.own_mesh.size())));
  const bool has_rotation = family_of(solution.problem_type).facts().has_rotation;
  sizes.parameters = solution.layout.stored(sizes.segments, has_rotation) + sizes.internal;
  sizes.recorded = solution.layout.recorded(has_rotation);
  if (solution.has_direction()) {
    require(solution.parameter_direction.size() == solution.free_parameters.size(),
            "direction does not fit the free parameters");
    require(solution.state_direction.rows() == solution.states.rows() &&
                solution.state_direction.cols() == solution.states.cols(),
            "direction does not fit the states");
  }
  return sizes;
}

void append_numbers(std::string& text, std::span<const double> numbers,
                    void (*append_number)(std::string&, double) = append_e19) {
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    if (k % numbers_per_line == 0) text += k == 0 ? "    " : "\n    ";
    append_number(text, numbers[k]);
  }
  if (!numbers.empty()) text += '\n';
}

void append_integers(std::string& text, const std::vector<int>& integers) {
  for (std::size_t k = 0; k < integers.size(); ++k) {
    if (k > 0 && k % integers_per_line == 0) text += '\n';
    text += integer_field(integers[k], 5);
  }
  if (!integers.empty()) text += '\n';
}

void append_identifier(std::string& text, const LabelledSolution& solution, const EntrySizes& sizes) {
  const int lines = sizes.lines(solution.has_direction());
  for (const int value : {std::abs(solution.branch), wrapped_point(std::abs(solution.point)), solution.type,
                          solution.label, sizes.free_parameters, solution.branch_mode})
    text += integer_field(value, 6);
  text += integer_field(sizes.points, 8) + integer_field(sizes.states + 1, 6) + integer_field(lines, 8);
  for (const int value : {solution.mesh_intervals, solution.collocation_points, sizes.parameters, sizes.internal,
                          solution.dimension, solution.problem_type, sizes.recorded})
    text += integer_field(value, 5);
  text += '\n';
}

/// PAR(1..NPAR): the solution's own, zeros, what a UZ point is, and the meshes of segments.
std::vector<double> all_parameters(const LabelledSolution& solution, const EntrySizes& sizes) {
  const auto ordinary = static_cast<std::size_t>(sizes.parameters - sizes.internal);
  std::vector<double> parameters = solution.parameters;
  require(std::all_of(parameters.begin() + static_cast<std::ptrdiff_t>(std::min(ordinary, parameters.size())),
                      parameters.end(), [](double value) { return value == 0.0; }),
          "more parameters than the file has room for");
  parameters.resize(ordinary, 0.0);
  for (const UserPointKind& kind : all_kinds(solution))
    parameters.insert(parameters.end(), {static_cast<double>(kind.kind), static_cast<double>(kind.segment),
                                         static_cast<double>(kind.index), kind.tau});
  if (!solution.own_mesh.empty()) {
    parameters.insert(parameters.end(), {own_mesh_mark, static_cast<double>(sizes.segments),
                                         static_cast<double>(solution.own_mesh.size()), 0.0});
    parameters.insert(parameters.end(), solution.own_mesh.begin(), solution.own_mesh.end());
    parameters.resize(static_cast<std::size_t>(sizes.parameters), 0.0);
  }
  return parameters;
}

/// Polynomials on the segments' own meshes are extended a little beyond the states that are written; times that lie
/// close together differ in their last digits only.
bool needs_all_digits(const LabelledSolution& solution) {
  constexpr double closest = level::located;
  const std::vector<double>& tau = solution.tau;
  return !solution.own_mesh.empty() ||
         std::adjacent_find(tau.begin(), tau.end(), [](double a, double b) { return b - a < closest; }) != tau.end();
}

}  // namespace

std::string format_solution(const LabelledSolution& solution) {
  const EntrySizes sizes = checked_sizes(solution);
  std::string text;
  append_identifier(text, solution, sizes);
  const auto append_number = needs_all_digits(solution) ? append_e26 : append_e19;
  std::vector<double> record(static_cast<std::size_t>(sizes.states) + 1);
  for (Eigen::Index point = 0; point < sizes.points; ++point) {
    record[0] = solution.tau[static_cast<std::size_t>(point)];
    for (Eigen::Index row = 0; row < sizes.states; ++row)
      record[static_cast<std::size_t>(row) + 1] = solution.states(row, point);
    append_numbers(text, record, append_number);
  }
  if (solution.has_direction()) {
    append_integers(text, solution.free_parameters);
    append_numbers(text, solution.parameter_direction);
    for (Eigen::Index point = 0; point < sizes.points; ++point)
      append_numbers(text,
                     std::span(solution.state_direction.col(point).data(), static_cast<std::size_t>(sizes.states)),
                     append_number);
  }
  // Nothing corrects a fixed parameter at a restart: it has to be the same number again.
  append_numbers(text, all_parameters(solution, sizes), append_e26);
  return text;
}

namespace {

constexpr std::size_t label_place = 3;
constexpr std::size_t points_place = 6;
constexpr std::size_t lines_place = 8;

/// The integers of a solution's first line; nothing when it is none.
std::optional<std::vector<int>> identifier(const std::string& line) {
  std::vector<int> integers;
  for (const std::string_view word : split_words(line)) {
    const auto value = parse_integer(word);
    if (!value || integers.size() == 16) return std::nullopt;
    integers.push_back(*value);
  }
  if (integers.size() != 12 && integers.size() != 16) return std::nullopt;
  return integers;
}

/// False when the file ends before so many lines, or in the last one.
bool skip(TextLines& in, int lines) {
  std::string line;
  for (int k = 0; k < lines; ++k)
    if (!in.next(line) || in.ended_within_line()) return false;
  return true;
}

}  // namespace

std::optional<std::vector<int>> whole_solution_labels(const std::string& path) {
  std::vector<int> labels;
  TextLines in(path, "labelled solutions");
  for (std::string line; in.next(line);) {
    if (split_words(line).empty()) continue;
    const auto integers = identifier(line);
    if (!integers) return in.ended_within_line() ? std::optional(labels) : std::nullopt;
    if (!skip(in, (*integers)[lines_place])) break;
    if ((*integers)[points_place] > 0) labels.push_back((*integers)[label_place]);
  }
  return labels;
}

}  // namespace tchat
