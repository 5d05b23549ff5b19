#include "app/manual_page.hpp"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cctype>
#include <filesystem>
#include <memory>
#include <vector>

#include "app/commands.hpp"
#include "files/replaced_file.hpp"

namespace tchat {

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

}  // namespace tchat
