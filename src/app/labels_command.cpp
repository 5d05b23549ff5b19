#include "app/labels_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>

#include "app/table_format_options.hpp"
#include "base/user_error.hpp"
#include "base/warnings.hpp"
#include "files/recorded_labels.hpp"
#include "files/run_files.hpp"
#include "files/solution_file_reader.hpp"
#include "files/solution_tables.hpp"
#include "settings/constants_file.hpp"

namespace tchat {

namespace {

struct LabelsArguments {
  std::string path;
  ChosenFormat format;
};

/// Of the constants of the run, "" where there are none that can be read.
std::string recorded_signature(const std::string& path) {
  try {
    return to_string(read_constants_file(constants_of_run(std::nullopt, path)).signature());
  } catch (const UserError&) {
    return "";
  }
}

int print_labels(const LabelsArguments& arguments) {
  const std::string path = resolve_solution_path(arguments.path);
  const SolutionFile file = read_solution_file(path);
  const RecordedNames recorded = recorded_names(path);
  if (*arguments.format) {
    const std::unique_ptr<TableWriter> writer = table_formats()[**arguments.format].make(std::cout);
    write_label_table(*writer, file, recorded.names, recorded_labels(path, file), recorded_signature(path));
  } else if (file.solutions.empty())
    fmt::print("{} holds no labelled solution.\n", path);
  else
    fmt::print("{}", format_label_table(file, recorded.names, recorded_labels(path, file)));
  print_warnings(std::cerr, file.warnings);
  if (!recorded.warning.empty()) print_warnings(std::cerr, {recorded.warning});
  return 0;
}

}  // namespace

void add_labels_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("labels", "list the labelled solutions of a q-file");
  command->footer(
      "SEG is the number of segments. Parameter names and STABLE are read from p.NAME, inadmissible points\n"
      "from d.NAME. IRS, STOP and `tchat orbit` accept the names of the table (PD1, GR1, UZ1). CSV and JSON\n"
      "also have parameters, the signature and normal forms.\n"
      "Example: tchat labels q.mems");
  const auto arguments = std::make_shared<LabelsArguments>();
  command->add_option("FILE", arguments->path, "q-file; `mems` means q.mems")->required();
  arguments->format = add_table_formats(*command);
  command->callback([&chosen, arguments] { chosen = [arguments] { return print_labels(*arguments); }; });
}

}  // namespace tchat
