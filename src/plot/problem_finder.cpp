#include "plot/problem_finder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "constants/constants_file.hpp"
#include "constants/user_error.hpp"
#include "output/point_columns.hpp"
#include "plot/branch_file.hpp"
#include "plugin/plugin_build.hpp"

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

/// Names as the run that wrote the q-file had them.
void take_names_from_points(const std::string& solution_path, ProblemChoice& choice) {
  std::error_code error;
  const std::string path = sibling_path(solution_path, 'p');
  if (path.empty() || !fs::is_regular_file(path, error)) return;
  try {
    const PointFile file = read_point_file(path);
    const PointSection& section = file.sections.front();
    const auto list = [](const std::map<int, std::string>& names, const char* symbol) {
      std::vector<std::string> result;
      const int last = names.empty() ? 0 : std::min(names.rbegin()->first, 1000);
      for (int k = 1; k <= last; ++k)
        result.push_back(names.contains(k) ? names.at(k) : fmt::format("{}({})", symbol, k));
      return result;
    };
    choice.states = list(section.states, "U");
    choice.parameters = list(section.parameters, "PAR");
  } catch (const UserError&) {
    choice.warning = fmt::format("{} cannot be read: names of states are left out", path);
  }
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
  take_names_from_points(solution_path, choice);
  return choice;
}

}  // namespace tchat
