#include "plot/restart_command.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <set>
#include <system_error>

#include "base/user_error.hpp"
#include "base/words.hpp"
#include "files/run_file_names.hpp"
#include "files/run_request.hpp"
#include "files/run_set.hpp"
#include "plugin/plugin_build.hpp"
#include "settings/constants_file.hpp"
#include "settings/recorded_problem.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

/// The problem of the only plugin in the folder, with its path; nothing where there are none or several.
std::optional<std::string> only_problem(const fs::path& folder) {
  std::set<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.empty() ? "." : folder, error)) {
    const fs::path name = entry.path().filename();
    const bool is_source = !source_of(entry.path().string()).empty() && name.has_extension();
    if (is_source || name.extension() == ".so") names.insert((folder / name.stem().stem()).string());
  }
  return names.size() == 1 ? std::optional(*names.begin()) : std::nullopt;
}

/// The problem that the constants name; nothing where they cannot be read.
std::optional<std::string> problem_in(const std::string& constants) {
  try {
    return recorded_problem(read_constants_file(constants), constants);
  } catch (const UserError&) {
    return std::nullopt;
  }
}

std::optional<std::string> problem_words(const BranchFile& file, const std::string& plugin,
                                         const std::string& constants) {
  if (!plugin.empty()) return problem_arguments(plugin);
  const std::string run = run_path(file.path);
  if (!source_of(run).empty()) return problem_arguments(run);
  if (const auto recorded = problem_in(constants)) return problem_arguments(*recorded);
  const auto only = only_problem(fs::path(file.path).parent_path());
  return only ? std::optional(problem_arguments(*only)) : std::nullopt;
}

}  // namespace

RestartCommand restart_command(const BranchFile& file, const std::string& plugin) {
  const std::string solutions = sibling_path(file.path, 'q');
  std::string constants;
  try {
    constants = constants_of_run(std::nullopt, solutions);
  } catch (const UserError&) {
    return {"", "", fmt::format("There is no {} with the constants of the run.", sibling_path(file.path, 'r'))};
  }
  const auto problem = problem_words(file, plugin, constants);
  const std::string run = run_path(file.path);
  const bool has_usual_name = output_path('q', run) == solutions;
  RestartCommand command;
  command.to_output =
      fmt::format("tchat run {} -c {} -s {} -o {}_", problem.value_or("PROBLEM"), quoted_for_shell(constants),
                  quoted_for_shell(has_usual_name ? run : solutions), quoted_for_shell(run));
  command.to_label = " IRS=";
  if (!problem)
    command.remark =
        "Replace PROBLEM by the name of the problem: the files of a run do not hold it. With -p PROBLEM, tchat plot "
        "writes it here.";
  return command;
}

}  // namespace tchat
