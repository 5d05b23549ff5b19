#include "app/problem_commands.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>

#include "app/command_options.hpp"
#include "app/commands.hpp"
#include "app/compiled_texts.hpp"
#include "base/messages.hpp"
#include "base/words.hpp"
#include "files/auto_format.hpp"
#include "files/replaced_file.hpp"
#include "files/run_files.hpp"
#include "kinds/model_check.hpp"
#include "model/derivative_check.hpp"
#include "model/parameter_vector.hpp"
#include "plugin/compiler.hpp"
#include "plugin/cpp_writer.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_library.hpp"
#include "run/data_start.hpp"
#include "settings/constants_file.hpp"
#include "settings/constants_writer.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_name_character(char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; }

void require_name(const std::string& name) {
  if (!name.empty() && is_letter(name[0]) && std::all_of(name.begin(), name.end(), is_name_character)) return;
  throw UserError(
      fmt::format("'{}' cannot be the name of a problem; needed is a letter followed by letters, digits and "
                  "underscores, for example: tchat new two_walls",
                  name));
}

/// two_walls -> TwoWalls
std::string class_name(const std::string& name) {
  std::string result;
  bool capital = true;
  for (const char c : name) {
    if (c != '_') result += capital && c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    capital = c == '_';
  }
  return result;
}

std::string filled(std::string text, const std::string& mark, const std::string& value) {
  for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + value.size()))
    text.replace(at, mark.size(), value);
  return text;
}

void write_new(const fs::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text << std::flush;
  if (!out)
    throw UserError(fmt::format("{} cannot be written; is the folder writable and the disk not full?", path.string()));
}

/// What clangd and other language servers read, so that an editor finds the header and knows the standard.
std::string editor_flags() {
  return fmt::format("-xc++\n-std=c++20\n-I{}\n", fs::absolute(find_include_folder({})).string());
}

}  // namespace

std::vector<NewFile> problem_template(const std::string& name) {
  require_name(name);
  std::vector<NewFile> files{{name + ".cpp", template_files::problem},
                             {name + ".dat", template_files::start},
                             {constants_file_of(name), template_files::constants},
                             {"Makefile", template_files::makefile}};
  for (NewFile& file : files) file.text = filled(filled(file.text, "@NAME@", name), "@CLASS@", class_name(name));
  return files;
}

std::vector<NewFile> translated_problem(const std::string& name, const std::string& formulas_path) {
  require_name(name);
  return {{name + ".cpp", translate_formula_file(formulas_path).cpp}};
}

std::vector<NewFile> create_problem(const std::string& path, const std::optional<std::string>& formulas_path) {
  const fs::path folder = fs::path(path).has_filename() ? fs::path(path) : fs::path(path).parent_path();
  const std::string name = folder.filename().string();
  std::vector<NewFile> files = formulas_path ? translated_problem(name, *formulas_path) : problem_template(name);
  std::error_code failed;
  if (fs::exists(folder, failed) && !(fs::is_directory(folder, failed) && fs::is_empty(folder, failed)))
    throw UserError(fmt::format("{} exists already and is left as it is; choose another name", folder.string()));
  fs::create_directories(folder, failed);
  if (failed) throw UserError(fmt::format("the folder {} cannot be made: {}", folder.string(), failed.message()));
  for (const NewFile& file : files) write_new(folder / file.name, file.text);
  write_new(folder / "compile_flags.txt", editor_flags());
  files.push_back({"compile_flags.txt", editor_flags()});
  return files;
}

namespace {

int translate(const std::string& path, const std::string& formulas) {
  const std::vector<NewFile> files = create_problem(path, formulas);
  fmt::print("{} is {} in C++, to be changed from here on:\n", path, formulas);
  for (const NewFile& file : files) fmt::print("  {}\n", file.name);
  const std::string name = files.front().name.substr(0, files.front().name.rfind('.'));
  fmt::print("\nTry it:   cd {0} && tchat simulate {1} --dat found && tchat run {1} -c found -d found -o found\n", path,
             name);
  return 0;
}

int create(const std::string& path) {
  const std::vector<NewFile> files = create_problem(path);
  fmt::print("{} is a driven mass with a wall on one side, to be changed into your own system:\n", path);
  for (const NewFile& file : files) fmt::print("  {}\n", file.name);
  fmt::print(
      "\nTry it:   cd {} && make\nThen edit the .cpp file; `tchat check` compares its derivatives, `tchat simulate` "
      "finds orbits to\n"
      "start from, `tchat constants` explains the constants file; the page tutorial.md of the\n"
      "documentation goes through a study.\n",
      path);
  return 0;
}

}  // namespace

void add_new_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("new", "create a problem: plugin, constants, data, Makefile");
  const auto path = std::make_shared<std::string>();
  command->add_option("NAME", *path, "new folder, with NAME.cpp, NAME.dat, gc.NAME and a Makefile")->required();
  command->footer("Example: tchat new two_walls && make -C two_walls");
  const auto formulas = std::make_shared<std::string>();
  command->add_option("--from", *formulas, "translate this file of formulas to NAME.cpp")->type_name("FILE.tch");
  command->callback([&chosen, path, formulas] {
    chosen = [path, formulas] { return formulas->empty() ? create(*path) : translate(*path, *formulas); };
  });
}

namespace {

struct CheckArguments {
  std::string name;
  std::string plugin;
  std::string constants;
  std::vector<std::string> states;
  std::vector<std::string> parameters;
  int random_states = 5;
};

double read_number(const std::string& text, const std::string& context) {
  if (const std::optional<double> value = parse_real(text)) return *value;
  throw UserError(fmt::format("'{}' in {} is not a number.\n  Example: 0.25 or 2.5e-1", text, context));
}

/// "1,0.5,-2"
Eigen::VectorXd read_state(const std::string& text) {
  std::vector<double> numbers;
  std::size_t begin = 0;
  while (true) {
    const std::size_t comma = text.find(',', begin);
    numbers.push_back(read_number(text.substr(begin, comma - begin), fmt::format("--state {}", text)));
    if (comma == std::string::npos) break;
    begin = comma + 1;
  }
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

int find_parameter(const HybridSystem& system, const std::string& key) {
  if (const int k = system.parameter_index(key); k > 0) return k;
  for (int k = 1; k <= system.parameters(); ++k)
    if (key == std::to_string(k)) return k;
  std::string names;
  for (int k = 1; k <= system.parameters(); ++k)
    names += fmt::format("{}{}", k > 1 ? ", " : "", system.parameter_name(k));
  throw UserError(fmt::format("{} has no parameter '{}'.\n  It has: {} (or 1..{}).", system.name(), key, names,
                              system.parameters()));
}

/// The largest k of "PAR(k)=v" up to 60; 0 when there is none.
int largest_given_parameter(const std::vector<std::string>& settings) {
  int largest = 0;
  for (const std::string& setting : settings)
    for (int k = 1; k < ParameterLayout().first_duration(); ++k)
      if (setting.starts_with(fmt::format("PAR({})=", k))) largest = std::max(largest, k);
  return largest;
}

/// Starting values of the problem with "PAR(omega)=2" or "PAR(2)=2" put in.
Eigen::VectorXd read_parameters(const HybridSystem& system, const std::vector<std::string>& settings) {
  Eigen::VectorXd par(system.parameters());
  const double* const initial = system.table().initial_parameters;
  for (int k = 0; k < system.parameters(); ++k) par(k) = initial != nullptr ? initial[k] : 1.0;
  for (const std::string& setting : settings) {
    const std::size_t close = setting.find(")=");
    if (!setting.starts_with("PAR(") || close == std::string::npos)
      throw UserError(
          fmt::format("'{}' is not understood.\n  After NAME come parameter values, as 'PAR(2)=0.8'.", setting));
    const int k = find_parameter(system, setting.substr(4, close - 4));
    par(k - 1) = read_number(setting.substr(close + 2), setting);
  }
  return par;
}

/// Throws UserError where the signature names functions that the problem has not.
void require_functions(const HybridSystem& system, const RunSettings& settings) {
  const auto lacks = [&](FunctionKind kind, int index) { return index > system.count(kind); };
  for (const SegmentSettings& segment : settings.segments)
    if (lacks(FunctionKind::field, segment.index.field) || lacks(FunctionKind::event, segment.index.event) ||
        lacks(FunctionKind::jump, segment.index.jump) ||
        std::any_of(segment.monitor.begin(), segment.monitor.end(),
                    [&](int event) { return lacks(FunctionKind::event, event); }))
      throw UserError(fmt::format(
          "the signature in the constants names functions that {} has not: it has {} fields, {} events and {} jumps",
          system.name(), system.count(FunctionKind::field), system.count(FunctionKind::event),
          system.count(FunctionKind::jump)));
}

/// Of the function that CONSERVED names; nothing without one.
std::optional<ModelCheck> conservation(const HybridSystem& system, const RunSettings& settings,
                                       const DerivativeCheckOptions& options) {
  if (settings.conserved.empty()) return std::nullopt;
  require_functions(system, settings);
  const Quantity conserved = conserved_quantity(system, settings.conserved);
  Eigen::VectorXd par = Eigen::VectorXd::Zero(system.layout().room());
  par.head(options.parameters.size()) = options.parameters;
  return check_conservation(system, conserved, settings.conserved, settings.segments, checked_states(system, options),
                            par);
}

int check_problem(const CheckArguments& arguments) {
  const std::string& plugin = arguments.plugin.empty() ? arguments.name : arguments.plugin;
  const std::string path = resolve_plugin(plugin);
  const std::string& constants = arguments.constants.empty() ? arguments.name : arguments.constants;
  const ProblemLibrary library(path, [&] {
    ProblemSizes sizes = problem_sizes(read_constants_file(constants_path(constants)));
    sizes.parameters = std::max(sizes.parameters, largest_given_parameter(arguments.parameters));
    return sizes;
  });
  DerivativeCheckOptions options;
  for (const std::string& state : arguments.states) options.states.push_back(read_state(state));
  options.parameters = read_parameters(library.system(), arguments.parameters);
  options.random_states = arguments.random_states;
  std::optional<RunSettings> settings;
  if (!arguments.constants.empty() || !own_constants_path(arguments.name).empty())
    settings = read_constants_file(constants_path(constants));
  if (library.system().boundary_conditions() > 0 && settings) options.segments = segment_count(*settings);
  const DerivativeCheck check = check_derivatives(library.system(), options);
  const auto conserved = settings ? conservation(library.system(), *settings, options) : std::nullopt;
  const ModelCheck chatter = check_chatter(library.system(), options);
  const bool is_fine = chatter.is_fine && (!conserved || conserved->is_fine);
  const std::string further = chatter.text + (conserved ? conserved->text : "");
  fmt::print("{}", to_text(library.system(), check, further, is_fine));
  if (const std::optional<std::string> formulas = formulas_of(plugin))
    for (const std::string& remark : translate_formula_file(*formulas).remarks) fmt::print("Note: {}\n", remark);
  return check.fine() && is_fine ? 0 : 1;
}

}  // namespace

void add_check_command(CLI::App& app, std::function<int()>& chosen) {
  const auto arguments = std::make_shared<CheckArguments>();
  CLI::App* const command = app.add_subcommand("check", "compare a problem's derivatives with finite differences");
  command->add_option("NAME", arguments->name, "problem NAME.cpp, NAME.tch, NAME.f or NAME.so")->required();
  command->add_option("values", arguments->parameters, "parameter values, as 'PAR(2)=0.8'");
  command->add_option("-p,--problem", arguments->plugin, "problem P.cpp, P.tch, P.f or P.so [NAME]")->type_name("P");
  command
      ->add_option(
          "-c,--constants", arguments->constants,
          "sizes of a Fortran problem, segments of a boundary value problem, and CONSERVED from gc.C [gc.NAME]")
      ->type_name("C");
  command->add_option("--state", arguments->states, "state to check at, as 1,0.5,0,1; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--random", arguments->random_states, "number of random states near each given one")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  command->footer(
      "Example: tchat check linosc 'PAR(alpha)=3' --state 0.5,0.1,0,1\n"
      "Exit status: 0 no fault found, 1 a fault, 2 bad usage or input.");
  command->callback([arguments, &chosen] { chosen = [arguments] { return check_problem(*arguments); }; });
}

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

void add_dat_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("dat", "convert NAME.dat to label 1 of q.NAME");
  const auto request = std::make_shared<RunRequest>();
  command->add_option("NAME", request->name, "problem NAME.cpp or NAME.tch; reads NAME.dat, gc.NAME; writes q.NAME")
      ->required();
  command->add_option("-c,--constants", request->constants, "dimension, signature and mesh from gc.C [gc.NAME]")
      ->type_name("C");
  command->add_option("-p,--problem", request->problem, "problem P.cpp, P.tch, P.f or P.so [NAME]")->type_name("P");
  command->add_option("-d,--data", request->data, "read D.dat [NAME.dat]")->type_name("D");
  command->add_option("-o,--output", request->output, "write q.O [q.NAME]")->type_name("O");
  command->add_option("KEY=VALUE", request->overrides, "constants and parameters, as for tchat run");
  command->footer("Example: tchat dat linosc -c impacting -d impacting -o start");
  command->callback([&chosen, request] {
    chosen = [request] {
      take_source_as_problem(request->name, request->problem);
      fmt::print("{} written, label 1\n", convert_data(*request, std::cerr));
      return 0;
    };
  });
}

}  // namespace tchat
