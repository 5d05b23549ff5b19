#include "maps/analyse_grazing.hpp"

#include <fmt/format.h>

#include "base/user_error.hpp"
#include "base/warnings.hpp"
#include "files/auto_format.hpp"
#include "files/run_files.hpp"
#include "files/solution_file_reader.hpp"
#include "maps/grazing_report.hpp"
#include "maps/grazing_source.hpp"
#include "model/index_vector.hpp"
#include "plugin/named_parameters.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_library.hpp"
#include "plugin/problem_setup.hpp"
#include "resegment/empty_segments.hpp"
#include "resegment/smooth_contact.hpp"
#include "settings/constant_value.hpp"
#include "settings/constants_file.hpp"
#include "settings/family.hpp"
#include "settings/problem_type.hpp"
#include "settings/recorded_problem.hpp"
#include "settings/settings_type.hpp"
#include "simulate/simulation_constants.hpp"
#include "simulate/simulation_start.hpp"

namespace tchat {

namespace {

constexpr int decades = 8;  // of penetration

int checked_jump(const HybridSystem& system, int jump) {
  const int count = system.count(FunctionKind::jump);
  if (jump >= 1 && jump <= count) return jump;
  throw UserError(fmt::format("--jump {}: {} has jumps 1 to {}", jump, system.name(), count));
}

int wanted_parameter(const GrazingRequest& request, const HybridSystem& system) {
  if (!request.parameter) return 0;
  const int k = parameter_index(system, *request.parameter, "--parameter");
  if (k >= 1 && k <= system.parameters()) return k;
  throw UserError(
      fmt::format("--parameter {}: {} has PAR(1) to PAR({})", *request.parameter, system.name(), system.parameters()));
}

void print_map(const HybridSystem& system, const GrazingRequest& request, const DiscontinuityMap& map,
               std::ostream& screen) {
  screen << map_report(system, map, compare_with_expansion(map, request.penetration, decades)) << '\n';
}

void print_maps(const HybridSystem& system, const GrazingRequest& request, const DiscontinuityMap& map,
                const std::optional<CrossSection>& section, std::ostream& screen) {
  print_map(system, request, map, screen);
  if (section) print_map(system, request, DiscontinuityMap(system, map.point(), section), screen);
}

/// The label's entry, when it goes with these constants.
const LabelledSolution& chosen(const GrazingRequest& request, const SolutionFile& file, const RunSettings& settings,
                               const std::string& path, const std::string& constants) {
  const LabelledSolution& solution = find_solution(file.solutions, read_label(*request.label), path);
  if (!is_same_problem_type(solution.problem_type, settings.problem_type))
    throw UserError(fmt::format(
        "label {} of {} was computed with IPS = {}, but {} has IPS = {}; give the constants of that run with -c",
        solution.label, path, solution.problem_type, constants, settings.problem_type));
  const std::string why_not =
      family_of(settings).why_not(Analysis::grazing, fmt::format("{}:{}", path, *request.label));
  if (!why_not.empty())
    throw UserError(fmt::format("label {} of {} is {} (IPS = {}){}", solution.label, path,
                                family_of(settings).facts().solution, solution.problem_type, why_not));
  return solution;
}

void analyse_label(const GrazingRequest& request, std::ostream& screen, std::ostream& warnings) {
  const std::string path = resolve_solution_path(request.name);
  const SolutionFile file = read_solution_file(path);
  const std::string constants = constants_of_run(request.constants, path);
  RunSettings settings = read_constants_file(constants);
  LabelledSolution solution = chosen(request, file, settings, path, constants);
  const ProblemLibrary library(
      resolve_plugin_of_run(request.problem, run_path(path), recorded_problem(settings, constants), warnings),
      [&] { return problem_sizes(settings); });
  const HybridSystem& system = library.system();
  resolve_names(settings, system);
  check_settings_against(system, settings, {constants});
  print_warnings(warnings, file.warnings);
  const std::string source = fmt::format("label {} of {}", solution.label, path);
  if (!has_section(settings)) solution = cut_at_contact(solution, settings, system, source);
  const std::optional<int> jump = request.jump ? std::optional(checked_jump(system, *request.jump)) : std::nullopt;
  const std::optional<CrossSection> named =
      request.section ? std::optional(cross_section(system, *request.section)) : std::nullopt;
  const ContactTurn turn = contact_turn(solution, settings, system, jump, wanted_parameter(request, system), source);
  const GrazingOrbit orbit = find_grazing_orbit(system, turn, source);
  const DiscontinuityMap map(system, orbit.point);
  const std::vector<ImpactReturn> xi =
      impact_returns(orbit.point.event_gradient, orbit.A, orbit.point.impact, request.returns);
  screen << fmt::format("Grazing orbit: {}, problem {}.\n", source, system.name()) << point_report(system, orbit.point)
         << '\n'
         << orbit_report(system, orbit, xi) << '\n';
  print_maps(system, request, map, named ? named : own_section(settings, system, orbit.point), screen);
  screen << verdict_report(grazing_verdict(orbit, map, xi)) << '\n'
         << born_report(system, orbit, born_orbits(system, orbit, map, request.born));
}

SimulationRequest start_request(const GrazingRequest& request) {
  SimulationRequest start;
  start.name = request.name;
  start.constants = request.constants;
  start.problem = request.problem;
  start.overrides = request.overrides;
  start.state = request.state;
  start.signature = request.mode;
  return start;
}

/// field, event function, jump
IndexVector mode_of(const GrazingRequest& request) {
  const std::vector<IndexVector> modes = parse_index_vectors(*request.mode, "--mode");
  if (modes.size() == 1) return modes.front();
  throw UserError(fmt::format(
      "--mode {}: one index vector is needed, field, event function in contact and its jump, as 1,1,1", *request.mode));
}

IndexVector checked_mode(const HybridSystem& system, const GrazingRequest& request) {
  const IndexVector mode = mode_of(request);
  const std::string fault = fault_of(system, {mode});
  if (!fault.empty()) throw UserError(fmt::format("--mode {}: {}", *request.mode, fault));
  return mode;
}

void analyse_state(const GrazingRequest& request, std::ostream& screen, std::ostream& warnings) {
  mode_of(request);  // before a plugin is compiled
  const SimulationRequest start_of = start_request(request);
  const std::string plugin = resolve_plugin_of_run(request.problem, request.name, std::nullopt, warnings);
  SimulationConstants constants = read_simulation_constants(start_of);
  const ProblemLibrary library(plugin, [&] { return sizes_of(start_of, with_signature(start_of, constants)); });
  const HybridSystem& system = library.system();
  resolve_names(constants.settings, system);
  constants = with_signature(start_of, constants);
  IndexVector contact = checked_mode(system, request);
  fit_to_problem(constants, system, request.overrides);
  if (request.jump) contact.jump = checked_jump(system, *request.jump);
  const SimulationStart start = simulation_start(start_of, constants, system);
  const std::optional<CrossSection> section =
      request.section ? std::optional(cross_section(system, *request.section)) : std::nullopt;

  const std::string source = "--state " + *request.state;
  Eigen::VectorXd x = start.state;
  if (request.correct) x = corrected_contact(system, contact.field, contact.event, x, start.par, source);
  const Signature aftermath = segments_after_impact(system, contact, x, start.par, contact.field);
  const GrazingPoint point =
      grazing_point(system, contact.field, contact.event, contact.jump, x, start.par, source, aftermath);
  screen << fmt::format("Grazing point: {}, problem {}.\n", source, system.name());
  if (request.correct) screen << fmt::format("Corrected by {:.3e} onto h_D = h_P = 0.\n", (x - start.state).norm());
  screen << point_report(system, point) << '\n';
  print_maps(system, request, DiscontinuityMap(system, point), section, screen);
  screen << "A state alone has no return map: A, xi_n and the verdict need the label of an orbit.\n";
}

void check_request(const GrazingRequest& request) {
  if (request.state && request.label)
    throw UserError(fmt::format("LABEL '{}' and --state are both given; with a label the state is that of its orbit",
                                *request.label));
  if (!request.state && !request.label)
    throw UserError(
        "a LABEL of the q-file is needed (GR1 is its first grazing point), or --state and --mode with the "
        "name of a problem");
  if (request.state && !request.mode)
    throw UserError("--state needs --mode too: field, event function in contact and its jump, as --mode 1,1,1");
  if (request.state && request.parameter)
    throw UserError("--parameter belongs to an orbit (q-file and LABEL): a state alone has no return to move");
  if (request.label && (request.mode || request.correct || !request.overrides.empty()))
    throw UserError(
        fmt::format("{}: only with --state; an orbit's field, contact and parameters are those of its label",
                    request.mode      ? "--mode"
                    : request.correct ? "--correct"
                                      : request.overrides.front()));
}

}  // namespace

void analyse_grazing(const GrazingRequest& request, std::ostream& screen, std::ostream& warnings) {
  check_request(request);
  if (request.state)
    analyse_state(request, screen, warnings);
  else
    analyse_label(request, screen, warnings);
}

}  // namespace tchat
