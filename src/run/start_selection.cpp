#include "run/start_selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/user_error.hpp"
#include "files/labelled_solution.hpp"
#include "files/parameter_values.hpp"
#include "files/run_set.hpp"
#include "files/solution_file_reader.hpp"
#include "files/writable_file.hpp"
#include "settings/constants_table.hpp"
#include "settings/family.hpp"
#include "settings/point_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

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
  const LabelledSolution solution = in_layout(find_start(file, path, settings, request), system.layout());
  SelectedStart selected;
  selected.source = path;
  selected.from_solution = true;
  selected.label_start = false;
  const SolutionFamily& family = family_of(settings);
  family_of(solution.problem_type).check_restart(solution, settings, path);
  selected.start = orbit_from_solution(solution, family.restart_shape(settings, solution, path), free_parameters, path);
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
    return family_of(settings).start_from_data(data_path(request.data.value_or(request.name)), settings, system);
  }
  const std::string solutions = output_path('q', request.name);
  if (exists(solutions)) return start_from_solution(solutions, settings, system, free_parameters, request);
  if (is_first_label) return family_of(settings).start_from_data(data_path(request.name), settings, system);
  throw UserError(
      fmt::format("IRS = {}{}, but there is no q.{} to restart from; name a q-file with -s, or use IRS=0 "
                  "with starting data",
                  label.type, label.number, request.name));
}

}  // namespace tchat
