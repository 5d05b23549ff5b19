#include "app/commands.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "app/command_options.hpp"
#include "base/messages.hpp"
#include "files/auto_format.hpp"
#include "files/branch_file.hpp"
#include "files/recorded_labels.hpp"
#include "files/run_files.hpp"
#include "files/solution_file_reader.hpp"
#include "files/solution_tables.hpp"
#include "kinds/verify_solutions.hpp"
#include "plot/branch_quantity.hpp"
#include "settings/constant_value.hpp"
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

namespace {

int do_verify(const VerifyRequest& request, bool quiet) {
  std::ostringstream unseen;
  std::ostream& screen = quiet ? static_cast<std::ostream&>(unseen) : std::cout;
  return verify_solutions(request, screen, quiet ? unseen : std::cerr) ? 0 : 1;
}

}  // namespace

void add_verify_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("verify", "compare labelled orbits of a q-file with forward integration");
  const auto request = std::make_shared<VerifyRequest>();
  const auto quiet = std::make_shared<bool>(false);
  command->add_option("FILE", request->solutions, "q-file; `mems` means q.mems")->required();
  command->add_option("LABELS", request->labels, "labels, as 5, GR1 or PD1 [all]");
  command->add_option("-p,--problem", request->problem, "problem P.cpp, P.tch, P.f or P.so [the name of the q-file]")
      ->type_name("P");
  command->add_option("-c,--constants", request->constants, "constants of the run that wrote the q-file [its r-file]")
      ->type_name("C");
  command->add_option("--tolerance", request->tolerance, "largest defect that passes")->capture_default_str();
  command->add_flag("-q,--quiet", *quiet, "print nothing: the exit status is the result");
  command->footer(
      "CVODES integrates each segment from its stored start, and watches all events that end or forbid it.\n"
      "  STATE     error at the end and after the jump, relative to the size of each state\n"
      "  TIME      error of the time of the event, relative to the period\n"
      "  GROWTH    growth of errors along the segment, |Phi|\n"
      "  MULTIPL.  largest difference of multipliers from those of the d-file\n"
      "  CRITICAL  distance of a multiplier from the value of the label: +1 for LP and BP, -1 for PD, the\n"
      "            stored angle for TR, +1 or -1 for GC\n"
      "  EVENT     the event that ends the segment; others that occur before it\n"
      "For a torus, rows have the worst of returns from all phases; STATE is the distance from the curve.\n"
      "The tolerance is at least 1e-9 GROWTH. Points that the run marked inadmissible pass.\n"
      "All labels asked for: points between them must have, in the d-file, the multiplier of their curve.\n"
      "Example: tchat verify q.impacting PD1 LP1 -p mems\n"
      "Exit status: 0 all defects are below the tolerance, 1 some are not or undecided, 2 bad usage or input.");
  command->callback([&chosen, request, quiet] { chosen = [request, quiet] { return do_verify(*request, *quiet); }; });
}

}  // namespace tchat
