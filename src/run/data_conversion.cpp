#include "run/data_conversion.hpp"

#include "base/user_error.hpp"
#include "files/run_set.hpp"
#include "files/solution_file.hpp"
#include "plugin/named_parameters.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_library.hpp"
#include "plugin/problem_setup.hpp"
#include "run/start_selection.hpp"
#include "settings/constants_file.hpp"
#include "settings/recorded_problem.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

std::string convert_data(const RunRequest& request, std::ostream& notices) {
  const std::string constants = constants_path(request.constants.value_or(request.name));
  RunSettings settings = read_constants_file(constants);
  apply_overrides(settings, request.overrides);
  settings.start = {};
  const std::string plugin =
      resolve_plugin_of_run(request.problem, request.name, recorded_problem(settings, constants), notices);
  const ProblemLibrary library(plugin, [&settings] { return problem_sizes(settings); });
  resolve_names(settings, library.system());
  check_settings_against(library.system(), settings, {constants, request.overrides});

  RunRequest from_data = request;
  from_data.data = request.data.value_or(request.name);
  from_data.start.reset();
  const SelectedStart selected = select_start(from_data, settings, library.system(), {});
  LabelledSolution solution = labelled_solution(selected.start.orbit, {}, {}, {});
  solution.type = static_cast<int>(PointType::end);
  solution.problem_type = settings.problem_type;
  solution.branch_mode = settings.branch_mode;
  const std::string name = request.output.value_or(request.name);
  replace_solution_file(name, format_solution(solution));
  return output_path('q', name);
}

}  // namespace tchat
