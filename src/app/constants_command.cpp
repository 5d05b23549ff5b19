#include "app/constants_command.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "constants/constants_file.hpp"
#include "constants/constants_guide.hpp"
#include "constants/constants_writer.hpp"
#include "setup/run_request.hpp"
#include "setup/warnings.hpp"

namespace tchat {

namespace {

struct ConstantsArguments {
  std::string name;
  std::vector<std::string> overrides;
  bool explain = false;
  bool keyword = false;
  bool positional = false;
};

int print_constants(const ConstantsArguments& arguments) {
  if (arguments.name.empty()) {
    fmt::print("{}", constants_guide());
    return 0;
  }
  Warnings warnings;
  const std::string path = constants_path(arguments.name);
  RunSettings settings = read_constants_file(path, &warnings);
  apply_overrides(settings, arguments.overrides, &warnings);
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
  command->add_option("NAME", arguments->name, "constants gc.NAME, or a path [explain all constants]");
  command->add_option("KEY=VALUE", arguments->overrides, "changes, as for tchat run");
  CLI::Option* explain = command->add_flag("-e,--explain", arguments->explain, "explain the file in words");
  CLI::Option* keyword = command->add_flag("-k,--keyword", arguments->keyword, "print the form KEY = value");
  CLI::Option* positional = command->add_flag("-p,--positional", arguments->positional, "print the positional form");
  keyword->excludes(explain)->excludes(positional);
  positional->excludes(explain);
  command->footer(
      "Comments of the file are not kept.\n"
      "Example: tchat constants mems NTST=80 DS=-0.01 -p > gc.mems2");
  command->callback([&chosen, arguments] { chosen = [arguments] { return print_constants(*arguments); }; });
}

}  // namespace tchat
