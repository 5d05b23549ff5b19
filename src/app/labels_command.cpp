#include "app/labels_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>

#include "files/recorded_labels.hpp"
#include "files/recorded_names.hpp"
#include "files/solution_file_reader.hpp"
#include "setup/warnings.hpp"
#include "tables/solution_tables.hpp"

namespace tchat {

namespace {

int print_labels(const std::string& given) {
  const std::string path = resolve_solution_path(given);
  const SolutionFile file = read_solution_file(path);
  const RecordedNames recorded = recorded_names(path);
  if (file.solutions.empty())
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
      "Example: tchat labels q.mems");
  const auto path = std::make_shared<std::string>();
  command->add_option("FILE", *path, "q-file; `mems` is taken for q.mems when there is no file mems")->required();
  command->callback([&chosen, path] { chosen = [path] { return print_labels(*path); }; });
}

}  // namespace tchat
