#include "app/labels_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>

#include "app/table_format_options.hpp"
#include "constants/constants_file.hpp"
#include "files/recorded_labels.hpp"
#include "files/recorded_names.hpp"
#include "files/solution_file_reader.hpp"
#include "setup/run_request.hpp"
#include "setup/warnings.hpp"
#include "tables/label_table.hpp"
#include "tables/solution_tables.hpp"
#include "text/user_error.hpp"

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
  CLI::App* command = app.add_subcommand("labels", "table of the labelled solutions of a q-file, with what each is");
  command->footer(
      "SEG is the number of segments. Names of parameters and STABLE are from p.NAME beside q.NAME, the run's own\n"
      "words and what is inadmissible from d.NAME.\n"
      "A UZ label is a user value; contacts and zero impact velocities are\n"
      "called GR, zeros of xi_n XI: IRS, STOP and `tchat orbit` know them by these names (UZ1, GR1, XI1).\n"
      "As CSV or JSON there is also all that a q-file says of a label, its parameters, and the signature of the run.\n"
      "Example: tchat labels q.mems");
  const auto arguments = std::make_shared<LabelsArguments>();
  command->add_option("FILE", arguments->path, "q-file; `mems` is taken for q.mems when there is no file mems")
      ->required();
  arguments->format = add_table_formats(*command);
  command->callback([&chosen, arguments] { chosen = [arguments] { return print_labels(*arguments); }; });
}

}  // namespace tchat
