#include "app/usage_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "app/commands.hpp"
#include "base/near_words.hpp"
#include "base/words.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

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

}  // namespace tchat
