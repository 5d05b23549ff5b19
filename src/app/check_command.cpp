#include "app/check_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "base/number.hpp"
#include "base/user_error.hpp"
#include "files/replaced_file.hpp"
#include "files/run_files.hpp"
#include "kinds/conservation_check.hpp"
#include "model/derivative_check.hpp"
#include "model/parameter_vector.hpp"
#include "plugin/cpp_writer.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_library.hpp"
#include "settings/constants_file.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

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
std::optional<ConservationCheck> conservation(const HybridSystem& system, const RunSettings& settings,
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
  const bool is_conserved = !conserved || conserved->is_conserved;
  fmt::print("{}", to_text(library.system(), check, conserved ? conserved->text : "", is_conserved));
  if (const std::optional<std::string> formulas = formulas_of(plugin))
    for (const std::string& remark : translate_formula_file(*formulas).remarks) fmt::print("Note: {}\n", remark);
  return check.fine() && is_conserved ? 0 : 1;
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

}  // namespace tchat
