#include "app/help.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <memory>
#include <set>
#include <string_view>
#include <utility>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "files/auto_format.hpp"
#include "files/replaced_file.hpp"
#include "files/solution_file_reader.hpp"
#include "plugin/problem_setup.hpp"
#include "settings/constant_value.hpp"
#include "settings/constants_table.hpp"

namespace tchat {

namespace {

constexpr std::size_t help_width = 100;

/// Broken at blanks to lines of `width`; the formatter indents what follows a line's end.
std::string broken(std::string text, std::size_t width) {
  std::string lines;
  while (text.size() > width) {
    const std::size_t blank = text.rfind(' ', width);
    if (blank == std::string::npos || blank == 0) break;
    lines += text.substr(0, blank) + '\n';
    text = text.substr(blank + 1);
  }
  return lines + text;
}

class HelpFormat final : public CLI::Formatter {
 public:
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    std::string text = '\n' + broken(std::move(group), help_width) + ":\n";
    for (const CLI::Option* option : options) text += make_option(option, is_positional);
    return text;
  }
  /// Without the options that exclude this one: an error names them when both are given.
  std::string make_option_opts(const CLI::Option* option) const override {
    const std::string text = CLI::Formatter::make_option_opts(option);
    return text.substr(0, text.find(" Excludes:"));
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    return broken(option->get_description(), help_width - get_column_width());
  }
  std::string make_description(const CLI::App* app) const override {
    return broken(app->get_description(), help_width) + '\n';
  }
};

}  // namespace

void set_help_format(CLI::App& app) {
  app.formatter(std::make_shared<HelpFormat>());
  app.set_help_flag("-h,--help", "show this help");
}

namespace {

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : visible_commands(app)) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::string suggestion(const std::vector<std::string>& near) {
  return near.empty() ? "" : fmt::format("did you mean {}? ", fmt::join(near, ", "));
}

std::string unknown_command(const std::string& word, const CLI::App& app) {
  const std::vector<std::string> names = command_names(app);
  return fmt::format("{} is no command; {}there are: {}; `tchat --help` explains", in_quotes(word),
                     suggestion(near_words(word, names)), fmt::join(names, ", "));
}

/// The first word that an option or argument of the command could not take.
std::string unexpected(const std::string& word, const CLI::App& command, const std::string& help) {
  if (!word.starts_with('-')) return fmt::format("{} is one argument too many; {}", in_quotes(word), help);
  const std::string name = word.substr(0, word.find('='));
  return fmt::format("{} is no option; {}{}", in_quotes(name), suggestion(near_words(name, option_names(command))),
                     help);
}

}  // namespace

std::string usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  const bool has_command = !chosen.empty();
  const CLI::App& command = has_command ? *chosen.front() : app;
  const std::string name = has_command ? command.get_name() + ": " : "";
  const std::string help = fmt::format("`tchat {}--help` explains", has_command ? command.get_name() + " " : "");
  const std::vector<std::string> left = command.remaining();
  if (!has_command && !left.empty() && !left.front().starts_with('-')) return unknown_command(left.front(), app);
  if (!left.empty() && (!has_command || dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr))
    return name + unexpected(left.front(), command, help);
  if (!has_command) return fmt::format("which command? There are: {}; {}", fmt::join(command_names(app), ", "), help);
  return fmt::format("{}{}; {}", name, error.what(), help);
}

namespace {

/// Text of a page: no character of it is a command of roff.
std::string roff(const std::string& text) {
  std::string result;
  bool begins_line = true;
  for (const char c : text) {
    if (begins_line && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else
      result += c;
    begins_line = c == '\n';
  }
  return result;
}

std::string capitals(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

/// "\-c, \-\-constants C", or the name of an argument.
std::string option_heading(const CLI::Option& option) {
  if (!option.nonpositional()) return fmt::format("\\fI{}\\fR", roff(option.get_name(true)));
  std::string names;
  for (const std::string& name : option.get_snames())
    names += (names.empty() ? "" : ", ") + ("\\fB" + roff("-" + name) + "\\fR");
  for (const std::string& name : option.get_lnames())
    names += (names.empty() ? "" : ", ") + ("\\fB" + roff("--" + name) + "\\fR");
  const bool takes_value = option.get_items_expected_max() > 0;
  return takes_value ? fmt::format("{} \\fI{}\\fR", names, roff(option.get_type_name())) : names;
}

std::string option_text(const CLI::Option& option) {
  const std::string standard = option.get_default_str();
  const std::string value = standard.empty() || !option.nonpositional() ? "" : fmt::format(" (default: {})", standard);
  return fmt::format(".TP\n{}\n{}\n", option_heading(option), roff(option.get_description() + value));
}

/// The options of one group, or the arguments.
std::string options_section(const std::string& title, const std::vector<const CLI::Option*>& options) {
  if (options.empty()) return "";
  std::string text = fmt::format(".SH {}\n", roff(capitals(title)));
  for (const CLI::Option* option : options) text += option_text(*option);
  return text;
}

std::string all_options(const CLI::App& command) {
  std::string text = options_section(
      "arguments", command.get_options([](const CLI::Option* option) { return !option->nonpositional(); }));
  for (const std::string& group : command.get_groups()) {
    if (group.empty()) continue;
    const std::size_t bracket = group.find(" [");  // what is done without these options
    const std::string title = group.substr(0, bracket);
    text += options_section(title, command.get_options([&](const CLI::Option* option) {
      return option->get_group() == group && option->nonpositional();
    }));
    if (bracket != std::string::npos)
      text += fmt::format(".PP\nWithout them: {}.\n", roff(group.substr(bracket + 2, group.size() - bracket - 3)));
  }
  return text;
}

std::string usage(const CLI::App& command, const std::string& name) {
  std::string text = fmt::format(".SH SYNOPSIS\n\\fB{}\\fR [options]", roff(name));
  for (const CLI::Option* option : command.get_options([](const CLI::Option* o) { return !o->nonpositional(); })) {
    const std::string argument = fmt::format("\\fI{}\\fR", roff(option->get_name(true)));
    const std::string dots = option->get_items_expected_max() > 1 ? " ..." : "";
    text += option->get_required() ? fmt::format(" {}{}", argument, dots) : fmt::format(" [{}{}]", argument, dots);
  }
  return text + "\n";
}

std::string command_list(const CLI::App& app) {
  std::string text = ".SH COMMANDS\n";
  for (const CLI::App* command : visible_commands(app))
    text += fmt::format(".TP\n\\fBtchat {0}\\fR\n{1}; see \\fBtchat\\-{0}\\fR(1)\n", roff(command->get_name()),
                        roff(command->get_description()));
  return text;
}

int write_pages(const CLI::App& app, const std::string& folder) {
  std::filesystem::create_directories(folder);
  const auto path = [&folder](const std::string& name) { return fmt::format("{}/{}.1", folder, name); };
  write_whole_file(path("tchat"), manual_page(app, nullptr));
  for (const CLI::App* command : visible_commands(app))
    write_whole_file(path("tchat-" + command->get_name()), manual_page(app, command));
  return 0;
}

}  // namespace

std::string manual_page(const CLI::App& app, const CLI::App* command) {
  const CLI::App& shown = command != nullptr ? *command : app;
  const std::string page = command != nullptr ? "tchat-" + command->get_name() : "tchat";
  const std::string called = command != nullptr ? "tchat " + command->get_name() : "tchat";
  std::string description = shown.get_description();
  if (const std::size_t colon = description.find(": "); command == nullptr && colon != std::string::npos)
    description = description.substr(colon + 2);
  std::string text = fmt::format(".TH {} 1 \"\" \"tchat {}\" \"User Commands\"\n", roff(capitals(page)), TCHAT_VERSION);
  text += fmt::format(".SH NAME\n{} \\- {}\n", roff(page), roff(description));
  text += usage(shown, called) + all_options(shown);
  if (command == nullptr) text += command_list(app);
  if (const std::string& footer = shown.get_footer(); !footer.empty() && command != nullptr)
    text += fmt::format(".SH NOTES\n.nf\n{}\n.fi\n", roff(footer));
  text += command == nullptr ? ".SH FILES\nThe README and the pages of the documentation are in share/doc/tchat, "
                               "problems in share/tchat.\n"
                             : ".SH SEE ALSO\n\\fBtchat\\fR(1)\n";
  return text;
}

void add_manual_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("manual", "pages for man")->group("");
  const auto folder = std::make_shared<std::string>();
  command->add_option("FOLDER", *folder, "where they are written")->required();
  command->callback([&app, &chosen, folder] { chosen = [&app, folder] { return write_pages(app, *folder); }; });
}

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
