#include "files/solution_file.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <vector>

#include "files/labelled_solution.hpp"
#include "files/number_format.hpp"
#include "files/solution_identifier.hpp"
#include "model/parameter_layout.hpp"
#include "settings/family.hpp"
#include "settings/point_type.hpp"

namespace tchat {

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

}  // namespace

std::string format_solution(const LabelledSolution& solution) {
  const EntrySizes sizes = checked_sizes(solution);
  std::string text;
  append_identifier(text, solution, sizes);
  // Polynomials on the segments' own meshes are extended a little beyond the states that are written.
  const auto append_number = solution.own_mesh.empty() ? append_e19 : append_e26;
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

}  // namespace tchat
