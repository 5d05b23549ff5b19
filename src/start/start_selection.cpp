#include "start/start_selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "constants/constants_table.hpp"
#include "constants/settings_type.hpp"
#include "files/labelled_solution.hpp"
#include "files/solution_file_reader.hpp"
#include "files/writable_file.hpp"
#include "setup/parameter_values.hpp"
#include "setup/problem_setup.hpp"
#include "special_points/point_type.hpp"
#include "text/user_error.hpp"

namespace tchat {

namespace {

OrbitShape shape_of(const RunSettings& settings) {
  if (is_point(settings.problem_type)) return OrbitShape::point(settings.dimension);
  return {settings.dimension, segment_count(settings), settings.mesh_intervals, settings.collocation_points};
}

bool given_on_command_line(const HybridSystem& system, const RunSettings& settings, int k) {
  for (const RunSettings::ParameterValue& value : settings.parameter_values)
    if (parameter_index(system, value.name, "command line") == k) return true;
  return false;
}

/// Of a label with a torus: as many orbits of one return as it has segments for.
OrbitShape torus_shape(const RunSettings& settings, const LabelledSolution& solution, const std::string& path) {
  const int m = segment_count(settings);
  const auto segments = static_cast<int>(solution.states.rows()) / settings.dimension;
  const bool fits = segments % m == 0 && (segments / m) % 2 == 1 && segments / m >= 3;
  if (!fits || (tells_problem_type(solution.problem_type) && !is_torus(solution.problem_type)))
    throw UserError(fmt::format(
        "{}: label {} is no torus, of which there are an odd number of orbits of {} segment{} each, but has {} "
        "segment{} "
        "(IPS = {}); start from a label of a run with IPS = {}, or at a torus bifurcation (TR) with ISW = -1",
        path, solution.label, m, m == 1 ? "" : "s", segments, segments == 1 ? "" : "s", solution.problem_type,
        settings.problem_type));
  return {settings.dimension, segments, settings.mesh_intervals, settings.collocation_points};
}

/// Of a label: at a Hopf bifurcation a run of periodic orbits begins from an equilibrium.
OrbitShape shape_of(const RunSettings& settings, const LabelledSolution& solution, const std::string& path) {
  if (is_torus(settings.problem_type) && !problem_type(settings).facts().switches_branch)
    return torus_shape(settings, solution, path);
  if (is_torus(solution.problem_type) && !is_torus(settings.problem_type))
    throw UserError(fmt::format(
        "{}: label {} is a torus (IPS = {}), and no run with IPS = {} begins there; IPS = {} goes on with it, "
        "IPS = {} with tori in grazing contact",
        path, solution.label, solution.problem_type, settings.problem_type, invariant_torus.number,
        grazing_torus.number));
  const bool begins_at_point = problem_type(settings).facts().switches_branch && solution.tau.size() == 1;
  return begins_at_point ? OrbitShape::point(settings.dimension) : shape_of(settings);
}

void set_parameters(const DatFile& data, const HybridSystem& system, const std::string& path, ParameterVector& par) {
  for (const auto& [k, value] : data.parameters) par(k - 1) = value;
  for (const auto& [name, value] : data.named_parameters) par(parameter_index(system, name, path) - 1) = value;
}

SelectedStart point_from_data(const std::string& path, const RunSettings& settings, const HybridSystem& system) {
  const DatFile data = read_point_dat_file(path, settings.dimension);
  SelectedStart selected;
  selected.source = path;
  selected.known_parameters = initial_parameters(system);
  set_parameters(data, system, path, selected.known_parameters);
  ParameterVector par = selected.known_parameters;
  apply_command_line(system, settings, par);
  par(first_duration - 1) = 0.0;
  selected.start.orbit = point_from_data(data, par);
  selected.label_start = settings.start.from_data();
  selected.last_label = selected.label_start ? 0 : 1;
  return selected;
}

SelectedStart start_from_data(const std::string& path, const RunSettings& settings, const HybridSystem& system) {
  if (is_point(settings.problem_type)) return point_from_data(path, settings, system);
  if (is_torus(settings.problem_type))
    throw UserError(fmt::format(
        "{}: tori (IPS = {}) do not begin from data; `tchat simulate --torus` makes a label of a torus that "
        "a motion goes round, ISW = -1 begins at a torus bifurcation (-s NAME IRS=TR1), or give a label of "
        "a torus with -s",
        path, settings.problem_type));
  const int m = segment_count(settings);
  const DatFile data = read_dat_file(path, settings.dimension, m);
  ParameterVector par = initial_parameters(system);
  std::vector<bool> given(static_cast<std::size_t>(m), false);
  const auto set = [&](int k, double value) {
    par(k - 1) = value;
    if (is_duration(k, m)) given[static_cast<std::size_t>(duration_segment(k))] = true;
  };
  const tchat_problem& table = system.table();
  for (int s = 0; table.initial_durations != nullptr && s < std::min(m, table.durations); ++s)
    if (std::isfinite(table.initial_durations[s])) set(first_duration + s, table.initial_durations[s]);
  for (const auto& [k, value] : data.parameters) set(k, value);
  for (const auto& [name, value] : data.named_parameters) set(parameter_index(system, name, path), value);
  const ParameterVector known = par;
  apply_command_line(system, settings, par);
  for (int s = 0; s < m; ++s) {
    if (given[static_cast<std::size_t>(s)] || given_on_command_line(system, settings, first_duration + s)) continue;
    if (m > 1)
      throw UserError(fmt::format(
          "{}: the duration of segment {} is not given; with several segments every one is needed, add a line "
          "`# PAR({}) = value` to the file or 'PAR({})=value' to the command line",
          path, s + 1, first_duration + s, first_duration + s));
    par(first_duration - 1) = data.span;
  }
  SelectedStart selected;
  selected.source = path;
  selected.start.orbit = orbit_from_data(data, shape_of(settings), par);
  selected.second = orbit_from_rows(data, shape_of(settings), par);
  selected.known_parameters = known;
  selected.known_parameters.segment(first_duration - 1, m) = par.segment(first_duration - 1, m);
  selected.label_start = settings.start.from_data();
  selected.last_label = selected.label_start ? 0 : 1;
  return selected;
}

bool gives_label(const std::string& override_text) {
  return override_text.size() > 3 && find_constant(override_text.substr(0, 3)) == find_constant("IRS") &&
         (override_text[3] == '=' || override_text[3] == ' ');
}

/// The label of IRS; where there is none and IRS is not from the command line, the message says where it is from.
const LabelledSolution& find_start(const SolutionFile& file, const std::string& path, const RunSettings& settings,
                                   const RunRequest& request) {
  try {
    return find_solution(file.solutions, settings.start, path);
  } catch (const UserError& error) {
    if (std::any_of(request.overrides.begin(), request.overrides.end(), gives_label)) throw;
    throw UserError(fmt::format("{}; IRS = {}{} is from {}: give another one, as in IRS=LABEL", error.what(),
                                settings.start.type, settings.start.number,
                                constants_path(request.constants.value_or(request.name))));
  }
}

SelectedStart start_from_solution(const std::string& path, const RunSettings& settings, const HybridSystem& system,
                                  const std::vector<int>& free_parameters, const RunRequest& request) {
  const SolutionFile file = read_solution_file(path, settings.start);
  const LabelledSolution& solution = find_start(file, path, settings, request);
  SelectedStart selected;
  selected.source = path;
  selected.from_solution = true;
  selected.label_start = false;
  selected.start = orbit_from_solution(solution, shape_of(settings, solution, path), free_parameters, path);
  selected.known_parameters = selected.start.orbit.par;
  selected.parameters_changed = apply_command_line(system, settings, selected.start.orbit.par);
  selected.branch = std::max(solution.branch, 1);
  selected.last_label = file.last_label;
  selected.problem_type = solution.problem_type;
  selected.label = solution.label;
  selected.type = solution.type;
  selected.kind = solution.kind;
  selected.types = basic_types(solution, settings.start.type);
  selected.warnings = file.warnings;
  return selected;
}

[[noreturn]] void refuse_solution_without_label(const std::string& path) {
  const SolutionFile file = read_solution_file(path);
  std::string labels;
  for (const LabelledSolution& s : file.solutions)
    labels += fmt::format("{}{}{}", labels.empty() ? "" : ", ", s.label,
                          type_name(s).empty() ? "" : fmt::format(" ({})", type_name(s)));
  throw UserError(
      fmt::format("-s {}: IRS is 0, so no label is chosen; add IRS=LABEL, or IRS=PD1 and the like; labels: {}", path,
                  labels.empty() ? "none" : labels));
}

}  // namespace

SelectedStart select_start(const RunRequest& request, const RunSettings& settings, const HybridSystem& system,
                           const std::vector<int>& free_parameters) {
  const StartLabel& label = settings.start;
  if (request.data && request.start)
    throw UserError("-d and -s are both given; a run starts from data (-d, IRS = 0) or from a label of a q-file (-s)");
  if (request.start) {
    const std::string path = solution_path(*request.start);
    if (label.from_data()) refuse_solution_without_label(path);
    return start_from_solution(path, settings, system, free_parameters, request);
  }
  const bool is_first_label = label.type.empty() && label.number <= 1;
  if (request.data || label.from_data()) {
    if (!is_first_label)
      throw UserError(
          fmt::format("IRS = {}{}, but starting data count as label 1; use IRS=0 or 1, or name a q-file with "
                      "-s",
                      label.type, label.number));
    return start_from_data(data_path(request.data.value_or(request.name)), settings, system);
  }
  const std::string solutions = default_solution_path(request.name);
  if (exists(solutions)) return start_from_solution(solutions, settings, system, free_parameters, request);
  if (is_first_label) return start_from_data(data_path(request.name), settings, system);
  throw UserError(
      fmt::format("IRS = {}{}, but there is no q.{} to restart from; name a q-file with -s, or use IRS=0 "
                  "with starting data",
                  label.type, label.number, request.name));
}

}  // namespace tchat
