#include "app/orbit_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include "base/user_error.hpp"
#include "base/warnings.hpp"
#include "files/recorded_labels.hpp"
#include "files/solution_file_reader.hpp"
#include "files/solution_tables.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

struct OrbitArguments {
  std::string path;
  std::string label;
  int dimension = 0;
  bool csv = false;
};

int print_orbit(const OrbitArguments& arguments) {
  const StartLabel label = read_label(arguments.label);
  const std::string path = resolve_solution_path(arguments.path);
  const SolutionFile file = read_solution_file(path, label);
  const RecordedNames recorded = recorded_names(path);
  print_warnings(std::cerr, file.warnings);
  if (!recorded.warning.empty()) print_warnings(std::cerr, {recorded.warning});
  const LabelledSolution& solution = find_solution(file.solutions, label, path);
  const std::string name = std::filesystem::path(path).filename().string();
  const auto format = arguments.csv ? format_orbit_csv : format_orbit_table;
  fmt::print("{}", format(solution, name, recorded.names, arguments.dimension));
  return 0;
}

}  // namespace

void add_orbit_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("orbit", "print an orbit of a q-file as a table over time");
  command->footer(
      "Columns: segment, tau in [0,1], time t since the start of segment 1, states (names from p.NAME).\n"
      "The heading starts with #, an empty line separates segments.\n"
      "Example: tchat orbit q.mems PD1 > orbit.txt");
  const auto arguments = std::make_shared<OrbitArguments>();
  command->add_option("FILE", arguments->path, "q-file; `mems` means q.mems")->required();
  command->add_option("LABEL", arguments->label, "label, as 5, GR1 or PD1")->required();
  command->add_flag("--csv", arguments->csv, "CSV with a line of headings, and all digits of the file");
  command->add_option("--dimension", arguments->dimension, "number of states, for older files that lack it")
      ->check(CLI::PositiveNumber);
  command->callback([&chosen, arguments] { chosen = [arguments] { return print_orbit(*arguments); }; });
}

}  // namespace tchat
