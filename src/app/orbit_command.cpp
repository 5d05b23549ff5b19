#include "app/orbit_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include "constants/constant_value.hpp"
#include "files/recorded_names.hpp"
#include "files/solution_file_reader.hpp"
#include "setup/warnings.hpp"
#include "tables/solution_tables.hpp"
#include "text/user_error.hpp"

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
  CLI::App* command = app.add_subcommand("orbit", "one orbit of a q-file in physical time, all segments, as a table");
  command->footer(
      "Lines: number of the segment, tau in [0,1], time t since the start of segment 1, states (named\n"
      "when p.NAME is beside q.NAME).\n"
      "A # begins the heading, an empty line separates segments. With --csv: CSV for other programs, one\n"
      "line of headings, numbers with all the digits of the file.\n"
      "Example: tchat orbit q.mems PD1 > orbit.txt");
  const auto arguments = std::make_shared<OrbitArguments>();
  command->add_option("FILE", arguments->path, "q-file; `mems` is taken for q.mems when there is no file mems")
      ->required();
  command->add_option("LABEL", arguments->label, "label number, or a type with its count: PD1, LP2, GR1, UZ1")
      ->required();
  command->add_flag("--csv", arguments->csv, "as CSV: segment,tau,t and the states");
  command
      ->add_option("--dimension", arguments->dimension,
                   "number of states of one segment, for older files that do not say it")
      ->check(CLI::PositiveNumber);
  command->callback([&chosen, arguments] { chosen = [arguments] { return print_orbit(*arguments); }; });
}

}  // namespace tchat
