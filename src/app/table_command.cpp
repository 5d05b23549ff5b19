#include "app/table_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "app/table_format_options.hpp"
#include "base/user_error.hpp"
#include "base/warnings.hpp"
#include "files/auto_format.hpp"
#include "files/branch_file.hpp"
#include "files/recorded_labels.hpp"
#include "files/solution_tables.hpp"
#include "plot/branch_quantity.hpp"

namespace tchat {

namespace {

struct TableArguments {
  std::vector<std::string> files;
  std::vector<std::string> quantities;
  bool types = false;
  ChosenFormat format;
};

/// The files of one run, "" for those that are not named.
struct RunPaths {
  std::string points;
  std::string solutions;
  std::string diagnostics;
};

std::string& path_for(RunPaths& paths, RunFileKind kind) {
  if (kind == RunFileKind::solutions) return paths.solutions;
  return kind == RunFileKind::diagnostics ? paths.diagnostics : paths.points;
}

RunPaths read_paths(const std::vector<std::string>& words) {
  RunPaths paths;
  for (const std::string& word : words) {
    const std::string path = resolve_run_file(word, 'p');
    std::string& place = path_for(paths, run_file_kind(path));
    if (!place.empty())
      throw UserError(fmt::format(
          "{} and {} are files of one kind; a table is of one run: its p-file, and its q- and d-file if they are not "
          "beside it",
          place, path));
    place = path;
  }
  if (paths.points.empty()) paths.points = sibling_path(words.front(), 'p');
  if (paths.points.empty())
    throw UserError(
        fmt::format("{} is no p-file; give the p-file of the run, as in tchat table p.mems", words.front()));
  return paths;
}

int print_table(const TableArguments& arguments) {
  const std::unique_ptr<TableWriter> writer = table_formats()[arguments.format->value_or(0)].make(std::cout);
  if (arguments.types) {
    write_point_types(*writer);
    return 0;
  }
  if (arguments.files.empty()) throw UserError("give the p-file of a run, as in tchat table p.mems");
  const RunPaths paths = read_paths(arguments.files);
  const BranchFile file = read_branch_file(paths.points, paths.solutions, paths.diagnostics);
  print_warnings(std::cerr, file.warnings);
  if (arguments.quantities.empty())
    write_branch_table(*writer, file);
  else
    write_quantity_table(*writer, file, arguments.quantities, "--column");
  return 0;
}

}  // namespace

void add_table_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("table", "print the points of a run as CSV or JSON");
  command->footer(
      "One line a point: section, branch, point, type, name (as in IRS: GR1), label, kind, stable and\n"
      "admissible (1 or 0), all columns of the p-file, fixed parameters, durations, multipliers, Newton\n"
      "iterations. Unknown values are empty (null in JSON). With --column: section, point and these\n"
      "columns, x2@wall (2) for the second value in a period; also coefficient, uncertainty.\n"
      "Example: tchat table p.mems > mems.csv");
  const auto arguments = std::make_shared<TableArguments>();
  command->add_option("FILES", arguments->files, "p-file (`mems` means p.mems); q- and d-file if they are elsewhere");
  command
      ->add_option("--column", arguments->quantities,
                   "print this column, as -x of `tchat plot`: x2@wall, 1/omega; may be repeated")
      ->expected(1)
      ->take_all();
  command->add_flag("--types", arguments->types, "print the types of points: letters, numbers in files, meaning");
  arguments->format = add_table_formats(*command);
  command->callback([&chosen, arguments] { chosen = [arguments] { return print_table(*arguments); }; });
}

}  // namespace tchat
