#include "app/constants_command.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "app/run_command.hpp"
#include "base/warnings.hpp"
#include "files/run_files.hpp"
#include "settings/constants_file.hpp"
#include "settings/constants_writer.hpp"

namespace tchat {

namespace {

struct ConstantsArguments {
  RunRequest request;  ///< the words of `tchat run`, of which only those about constants count
  bool explain = false;
  bool keyword = false;
  bool positional = false;
};

int print_constants(const ConstantsArguments& arguments) {
  const RunRequest& request = arguments.request;
  if (request.name.empty() && !request.constants) {
    fmt::print("{}", constants_guide());
    return 0;
  }
  Warnings warnings;
  const std::string path = constants_path(request.constants.value_or(request.name));
  RunSettings settings = read_constants_file(path, &warnings);
  apply_overrides(settings, request.overrides, &warnings);
  if (!settings.parameter_values.empty())
    warnings.push_back("a constants file has no values of parameters: give them to tchat run");
  print_warnings(std::cerr, warnings);
  const bool to_keyword =
      arguments.keyword || (!arguments.positional && constants_form(path) == ConstantsForm::positional);
  if (arguments.explain)
    fmt::print("{}", explained_text(settings));
  else
    fmt::print("{}", to_keyword ? keyword_text(settings) : positional_text(settings));
  return 0;
}

}  // namespace

void add_constants_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("constants", "print a constants file in the other form, or explained");
  const auto arguments = std::make_shared<ConstantsArguments>();
  command->add_option("NAME", arguments->request.name, "constants gc.NAME, or a path [explain all constants]");
  add_run_options(*command, arguments->request);
  CLI::Option* explain = command->add_flag("-e,--explain", arguments->explain, "explain the file in words");
  CLI::Option* keyword = command->add_flag("-k,--keyword", arguments->keyword, "print the form KEY = value");
  CLI::Option* positional = command->add_flag("--positional", arguments->positional, "print the positional form");
  keyword->excludes(explain)->excludes(positional);
  positional->excludes(explain);
  command->footer(
      "The other words of tchat run are accepted, so that the constants of a run can be seen before it. Comments of\n"
      "the file are not kept.\n"
      "Example: tchat constants mems NTST=80 DS=-0.01 --positional > gc.mems2");
  command->callback([&chosen, arguments] { chosen = [arguments] { return print_constants(*arguments); }; });
}

}  // namespace tchat
