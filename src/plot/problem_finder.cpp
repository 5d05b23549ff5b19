#include "plot/problem_finder.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "constants/constants_file.hpp"
#include "constants/user_error.hpp"
#include "output/recorded_names.hpp"
#include "plugin/plugin_build.hpp"
#include "start/run_file_names.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

bool has_plugin(const fs::path& path) {
  std::error_code error;
  for (const char* suffix : {".cpp", ".f", ".f90", ".so"})
    if (fs::is_regular_file(path.string() + suffix, error)) return true;
  return false;
}

/// The only NAME.so of a folder, without extension; empty when there are none or several.
fs::path only_plugin(const fs::path& folder) {
  std::error_code error;
  fs::path found;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, error)) {
    if (entry.path().extension() != ".so" || entry.path().filename().string().starts_with('.')) continue;
    if (!found.empty()) return {};
    found = entry.path();
    found.replace_extension();
  }
  return found;
}

std::vector<fs::path> candidates(const std::string& solution_path) {
  const fs::path folder = fs::path(solution_path).parent_path();
  const std::string name = run_name(solution_path);
  return {folder / name, fs::path(name), only_plugin(folder)};
}

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
  for (const fs::path& path : candidates(solution_path)) {
    if (path.empty() || !has_plugin(path)) continue;
    try {
      auto library = load(path.string(), solution_path);
      if (library->system().dimension() != dimension) continue;
      take(choice, std::move(library));
      return choice;
    } catch (const UserError&) {
      continue;  // the picture does without
    }
  }
  RecordedNames recorded = recorded_names(solution_path);
  choice.states = std::move(recorded.names.states);
  choice.parameters = std::move(recorded.names.parameters);
  choice.warning = std::move(recorded.warning);
  return choice;
}

}  // namespace tchat
