#include "plot/problem_finder.hpp"

#include <fmt/format.h>

#include "base/user_error.hpp"
#include "files/recorded_names.hpp"
#include "files/run_file_names.hpp"
#include "plugin/plugin_build.hpp"
#include "settings/constants_file.hpp"

namespace tchat {

namespace {

void take(ProblemChoice& choice, std::shared_ptr<ProblemLibrary> library) {
  const ProblemNames names = ProblemNames::of(library->system());
  choice.library = std::move(library);
  choice.states = names.states;
  choice.parameters = names.parameters;
}

/// The library; a Fortran plugin needs r.O, the constants of the run that wrote q.O.
std::shared_ptr<ProblemLibrary> load(const std::string& plugin, const std::string& solution_path) {
  return std::make_shared<ProblemLibrary>(resolve_plugin(plugin), [&solution_path] {
    return problem_sizes(read_constants_file(sibling_path(solution_path, 'r')));
  });
}

}  // namespace

ProblemChoice find_problem(const std::string& solution_path, const std::string& plugin, int dimension) {
  ProblemChoice choice;
  if (!plugin.empty()) {
    take(choice, load(plugin, solution_path));
    if (choice.system()->dimension() != dimension)
      throw UserError(fmt::format("-p {}: problem {} has {} states, the orbits of {} have {}", plugin,
                                  choice.system()->name(), choice.system()->dimension(), solution_path, dimension));
    return choice;
  }
  RecordedNames recorded = recorded_names(solution_path);
  choice.states = std::move(recorded.names.states);
  choice.parameters = std::move(recorded.names.parameters);
  choice.warning = std::move(recorded.warning);
  return choice;
}

}  // namespace tchat
