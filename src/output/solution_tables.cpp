#include "output/solution_tables.hpp"

#include <fmt/format.h>

#include "constants/user_error.hpp"
#include "hybrid/parameter_vector.hpp"

namespace tchat {

namespace {

double parameter(const LabelledSolution& solution, int k) {
  const auto index = static_cast<std::size_t>(k - 1);
  return index < solution.parameters.size() ? solution.parameters[index] : 0.0;
}

std::string number_or_dash(int number) { return number > 0 ? fmt::format("{}", number) : "-"; }

std::string free_parameters(const LabelledSolution& solution, int segments, const ProblemNames& names) {
  std::string list;
  for (const int k : solution.free_parameters)
    if (!is_duration(k, segments))
      list += fmt::format("{}{} = {:.9g}", list.empty() ? "" : ", ", names.parameter(k), parameter(solution, k));
  return list;
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

std::string heading(const LabelledSolution& solution, const std::string& name, const OrbitSizes& sizes,
                    const ProblemNames& names) {
  const std::string type = type_name(solution);
  double period = 0.0;
  for (int s = 0; s < sizes.segments; ++s) period += parameter(solution, first_duration + s);
  std::string text =
      fmt::format("# {}: label {}{}, {} segment{}, period {:.10g}\n", name, solution.label,
                  type.empty() ? "" : " (" + type + ")", sizes.segments, sizes.segments == 1 ? "" : "s", period);
  for (const int k : solution.free_parameters)
    if (!is_duration(k, sizes.segments))
      text += fmt::format("# {} = {:.10g}\n", names.parameter(k), parameter(solution, k));
  text += fmt::format("#{:>3}{:>19}{:>19}", "seg", "tau", "t");
  for (int k = 1; k <= sizes.dimension; ++k) text += fmt::format(" {:>18}", names.state(k));
  return text + '\n';
}

}  // namespace

std::string format_label_table(const SolutionFile& file, const ProblemNames& names) {
  std::string text = fmt::format("{:>5} {:>3} {:>4} {:>5} {:>5} {:>4} {:>9} {:>15}  {}\n", "LAB", "TY", "BR", "PT",
                                 "IPS", "SEG", "NTSTxNCOL", "PERIOD", "FREE PARAMETERS");
  for (const LabelledSolution& solution : file.solutions) {
    const int segments = segment_count(solution);
    const double duration = period(solution);
    const std::string mesh = fmt::format("{}x{}", solution.mesh_intervals, solution.collocation_points);
    const std::string what = description(solution, [&names](int k) { return names.parameter(k); });
    text += fmt::format("{:>5} {:>3} {:>4} {:>5} {:>5} {:>4} {:>9} {:>15}  {}{}{}\n", solution.label,
                        type_name(solution), solution.branch, solution.point, number_or_dash(solution.problem_type),
                        number_or_dash(segments), mesh, segments > 0 ? fmt::format("{:.9g}", duration) : "-",
                        free_parameters(solution, segments > 0 ? segments : max_segments, names),
                        what.empty() ? "" : "   ", what);
  }
  return text;
}

std::string format_orbit_table(const LabelledSolution& solution, const std::string& name, const ProblemNames& names,
                               int dimension) {
  const OrbitSizes sizes = sizes_of(solution, name, dimension > 0 ? dimension : solution.dimension);
  std::string text = heading(solution, name, sizes, names);
  double start = 0.0;
  for (int s = 0; s < sizes.segments; ++s) {
    const double duration = parameter(solution, first_duration + s);
    if (s > 0) text += '\n';
    for (std::size_t point = 0; point < solution.tau.size(); ++point) {
      const double tau = solution.tau[point];
      text += fmt::format("{:4}{:19.10E}{:19.10E}", s + 1, tau, start + tau * duration);
      for (int k = 0; k < sizes.dimension; ++k)
        text += fmt::format("{:19.10E}", solution.states(s * sizes.dimension + k, static_cast<Eigen::Index>(point)));
      text += '\n';
    }
    start += duration;
  }
  return text;
}

}  // namespace tchat
