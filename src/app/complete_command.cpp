#include "app/complete_command.hpp"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "app/commands.hpp"
#include "base/user_error.hpp"
#include "files/auto_format.hpp"
#include "files/solution_file_reader.hpp"
#include "plugin/problem_setup.hpp"
#include "settings/constants_table.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;
using Candidates = std::set<std::string>;

/// The words of a command line up to the cursor.
struct CommandLine {
  std::string command;
  std::vector<std::string> arguments;  // without options and their values
  std::vector<std::pair<std::string, std::string>> options;
  std::string option;   // whose value is being typed; "" for none
  std::string current;  // the word at the cursor, perhaps empty

  /// The value of an option; "" when it is not given.
  std::string value(std::string_view name) const {
    for (const auto& [option_name, text] : options)
      if (option_name == name) return text;
    return "";
  }
};

/// The long name of an option that takes a value; "" for flags and words that are no options.
std::string valued_option(const CLI::App& command, const std::string& word) {
  if (word.size() < 2 || word[0] != '-') return "";
  for (const CLI::Option* option : command.get_options([](const CLI::Option* o) { return o->nonpositional(); })) {
    const auto names = word[1] == '-' ? option->get_lnames() : option->get_snames();
    const std::string name = word.substr(word[1] == '-' ? 2 : 1);
    if (std::find(names.begin(), names.end(), name) == names.end() || option->get_items_expected_max() == 0) continue;
    return option->get_lnames().empty() ? name : option->get_lnames().front();
  }
  return "";
}

CommandLine read_line(const CLI::App& command, const std::vector<std::string>& words) {
  CommandLine line;
  line.command = command.get_name();
  line.current = words.back();
  for (std::size_t k = 1; k + 1 < words.size(); ++k) {
    const std::string option = valued_option(command, words[k]);
    if (option.empty() && !words[k].starts_with('-')) line.arguments.push_back(words[k]);
    if (option.empty()) continue;
    if (k + 2 == words.size())
      line.option = option;
    else
      line.options.emplace_back(option, words[++k]);
  }
  return line;
}

/// The folder that the word at the cursor names, with its slash, and the names of the files in it.
struct Folder {
  std::string prefix;
  std::vector<std::string> files, folders;

  explicit Folder(const std::string& word) {
    const std::size_t slash = word.rfind('/');
    prefix = slash == std::string::npos ? "" : word.substr(0, slash + 1);
    std::error_code error;
    for (fs::directory_iterator at(prefix.empty() ? "." : prefix, error), end; !error && at != end;
         at.increment(error)) {
      const std::string name = at->path().filename().string();
      if (!name.starts_with('.')) (at->is_directory(error) ? folders : files).push_back(name);
    }
  }

  /// Names that begin and end so, without begin and end where `bare`.
  void add(Candidates& to, std::string_view begin, std::string_view end, bool bare) const {
    for (const std::string& name : files) {
      if (name.size() <= begin.size() + end.size() || !name.starts_with(begin) || !name.ends_with(end)) continue;
      to.insert(prefix + (bare ? name.substr(begin.size(), name.size() - begin.size() - end.size()) : name));
    }
  }
  void add_folders(Candidates& to) const {
    for (const std::string& name : folders) to.insert(prefix + name + "/");
  }
};

constexpr std::array<std::string_view, 7> plugin_endings = {".cpp", ".cc", ".cxx", ".f90", ".f", ".tch", ".so"};

void add_plugins(Candidates& to, const Folder& folder) {
  for (const std::string_view ending : plugin_endings) folder.add(to, "", ending, true);
}

std::string solutions_path(const std::string& name) {
  std::error_code error;
  if (fs::is_regular_file(name, error)) return name;
  const fs::path path(name);
  return (path.parent_path() / ("q." + path.filename().string())).string();
}

/// PD1, GR1, ... and numbers.
void add_labels(Candidates& to, const std::string& path, const std::string& begin = "") {
  try {
    const SolutionFile file = read_solution_file(path);
    for (const LabelledSolution& solution : file.solutions) to.insert(begin + std::to_string(solution.label));
    for (const auto& names : counted_names(file.solutions))
      for (const std::string& name : names) to.insert(begin + name);
  } catch (const UserError&) {  // no file, no labels
  }
}

/// Parameters that the problem's source names: for a completion nothing is compiled, and nothing in the folder is run.
void add_parameters(Candidates& to, const std::string& name) {
  for (const std::string& parameter : parameter_names_in_source(name)) to.insert(fmt::format("PAR({})=", parameter));
}

/// KEY=, and IRS=LABEL.
void add_overrides(Candidates& to, const CommandLine& line) {
  const std::string name = line.arguments.empty() ? "" : line.arguments.front();
  if (line.current.starts_with("IRS=")) {
    const std::string start = line.value("start");
    add_labels(to, solutions_path(start.empty() ? name : start), "IRS=");
    return;
  }
  for (const Constant& constant : constants_table())
    if (constant.keyword != "PAR") to.insert(std::string(constant.keyword) + "=");
  const std::string problem = line.value("problem");
  add_parameters(to, problem.empty() ? name : problem);
}

void add_option_value(Candidates& to, const CommandLine& line) {
  const Folder folder(line.current);
  if (line.option == "constants") {
    folder.add(to, constants_prefix, "", true);
    folder.add(to, "r.", "", false);
  } else if (line.option == "problem") {
    add_plugins(to, folder);
  } else if (line.option == "data") {
    folder.add(to, "", ".dat", true);
  } else if (line.option == "start") {
    folder.add(to, "q.", "", true);
  } else if (line.option == "to") {
    to.insert({"grazing-curve", "impacting", "signature", "rotate", "double"});
    return;
  } else {
    folder.add(to, "", "", false);
  }
  folder.add_folders(to);
}

void add_plot_files(Candidates& to, const CommandLine& line) {
  const Folder folder(line.current);
  for (const char* begin : {"p.", "q."}) folder.add(to, begin, "", false);
  for (const char* end : {".trajectory", ".txt", ".dat", ".csv"}) folder.add(to, "", end, false);
  folder.add_folders(to);
  for (const std::string& file : line.arguments)
    if (fs::path(file).filename().string().starts_with("q.")) add_labels(to, file);
}

void add_argument(Candidates& to, const CommandLine& line) {
  const std::size_t place = line.arguments.size();
  const auto is = [&line](std::initializer_list<std::string_view> commands) {
    return std::find(commands.begin(), commands.end(), line.command) != commands.end();
  };
  const Folder folder(line.current);
  if (is({"run", "simulate", "check", "dat", "constants"}) && place == 0) {
    folder.add(to, constants_prefix, "", true);
    if (line.command != "constants") add_plugins(to, folder);
    folder.add_folders(to);
  } else if (is({"run", "simulate", "dat", "constants"})) {
    add_overrides(to, line);
  } else if (is({"check"})) {
    add_parameters(to, line.arguments.front());
  } else if (is({"labels", "orbit", "verify", "resegment", "grazing"}) && place == 0) {
    folder.add(to, "q.", "", false);
    folder.add_folders(to);
  } else if (line.command == "verify" || (is({"orbit", "resegment", "grazing"}) && place == 1)) {
    add_labels(to, solutions_path(line.arguments.front()));
  } else if (line.command == "resegment") {
    add_overrides(to, line);
  } else if (line.command == "plot") {
    add_plot_files(to, line);
  } else if (line.command == "table") {
    for (const char* begin : {"p.", "q.", "d."}) folder.add(to, begin, "", false);
    folder.add_folders(to);
  }
}

Candidates candidates(const CLI::App& app, std::vector<std::string> words) {
  Candidates found;
  if (words.empty()) words.emplace_back();
  if (words.size() == 1) {
    for (const CLI::App* command : visible_commands(app)) found.insert(command->get_name());
    if (words[0].starts_with('-')) found.insert({"--help", "--version"});
    return found;
  }
  const std::vector<const CLI::App*> commands = visible_commands(app);
  const auto command =
      std::find_if(commands.begin(), commands.end(), [&](const CLI::App* one) { return one->get_name() == words[0]; });
  if (command == commands.end()) return found;
  const CommandLine line = read_line(**command, words);
  if (!line.option.empty()) {
    add_option_value(found, line);
  } else if (line.current.starts_with('-')) {
    for (const CLI::Option* option : (*command)->get_options())
      for (const std::string& name : option->get_lnames()) found.insert("--" + name);
  } else {
    add_argument(found, line);
  }
  return found;
}

}  // namespace

int print_completions(const CLI::App& app, std::vector<std::string> words) {
  if (!words.empty() && words.front() == "--") words.erase(words.begin());
  for (const std::string& candidate : candidates(app, words))
    if (words.empty() || candidate.starts_with(words.back())) fmt::print("{}\n", candidate);
  return 0;
}

}  // namespace tchat
