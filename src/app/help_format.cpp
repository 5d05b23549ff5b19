#include "app/help_format.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

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

}  // namespace tchat
