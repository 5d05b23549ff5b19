#include "maps/analyse_grazing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "files/auto_format.hpp"
#include "files/recorded_labels.hpp"
#include "files/run_files.hpp"
#include "files/solution_file_reader.hpp"
#include "maps/grazing_point.hpp"
#include "model/events.hpp"
#include "model/index_vector.hpp"
#include "model/scales.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_library.hpp"
#include "plugin/problem_setup.hpp"
#include "resegment/contact_point.hpp"
#include "resegment/signature_match.hpp"
#include "settings/constant_value.hpp"
#include "settings/constants_file.hpp"
#include "settings/problem_type.hpp"
#include "settings/run_settings.hpp"
#include "settings/settings_type.hpp"
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
  require_recorded_parameters(path, system);
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

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int width = 20;

/// What is zero but for rounding beside `scale` is printed as zero: rounding differs from machine to machine.
std::string entry(double value, double scale) {
  return fmt::format("{:>{}.11g}", std::abs(value) <= level::rounding * scale ? 0.0 : value, width);
}

/// Of the first `states` states, which the mode in contact has.
std::string names_row(const HybridSystem& system, int states) {
  std::string text = fmt::format("{:10}", "");
  for (int k = 1; k <= states; ++k) text += fmt::format("{:>{}}", system.state_name(k), width);
  return text + '\n';
}

std::string row(const std::string& name, const VectorXd& values) {
  std::string text = fmt::format("{:<10}", name);
  const double scale = values.lpNorm<Eigen::Infinity>();
  for (const double value : values) text += entry(value, scale);
  return text + '\n';
}

/// Below `zero` it is one.
std::string complex_text(std::complex<double> value, double zero) {
  if (std::abs(value) <= zero) return "0";
  if (value.imag() == 0.0) return fmt::format("{:.11g}", value.real());
  return fmt::format("{:.11g} {} {:.11g} i", value.real(), value.imag() < 0.0 ? '-' : '+', std::abs(value.imag()));
}

std::string function_text(const HybridSystem& system, FunctionKind kind, int index) {
  const char* const word = kind == FunctionKind::event ? "event" : kind == FunctionKind::jump ? "jump" : "field";
  return fmt::format("{} {} ({})", word, index, system.function_name(kind, index));
}

/// Columns `names` of matrices with one row for each state.
std::string columns(const HybridSystem& system, const std::vector<std::string>& names, const MatrixXd& values,
                    double error) {
  std::string text = fmt::format("{:10}", "");
  for (const std::string& name : names) text += fmt::format("{:>{}}", name, width);
  text += '\n';
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    text += fmt::format("{:<10}", system.state_name(static_cast<int>(i) + 1));
    for (Eigen::Index k = 0; k < values.cols(); ++k)
      text += fmt::format("{:>{}.11g}", std::abs(values(i, k)) <= 2.0 * error ? 0.0 : values(i, k), width);
    text += '\n';
  }
  return text;
}

std::string section_text(const HybridSystem& system, const DiscontinuityMap& map) {
  if (!map.section()) return "P (h_P = 0)";
  const CrossSection& section = *map.section();
  if (section.event == 0) return fmt::format("P' (constant {})", system.state_name(section.state));
  const GrazingPoint& at = map.point();
  const EventAt met = event_at(system, section.event, at.x.data(), at.par.data());
  const double scale = met.scale(at.x.data(), sizes_at(system, at.field, at.x, at.par));
  return fmt::format("P' ({} = {:.6g})", function_text(system, FunctionKind::event, section.event),
                     std::abs(met.h) <= level::orbit * scale ? 0.0 : met.h);
}

std::string expansion_text(const HybridSystem& system, const DiscontinuityMap& map) {
  const DiscontinuityExpansion& x = map.expansion();
  const int n = system.dimension_of(map.point().field);
  MatrixXd powers(n, 3);
  powers << x.y.head(n), x.yy.head(n), x.yyy.head(n);
  std::vector<std::string> states, mixed, parameters, mixed_parameters;
  for (int k = 1; k <= n; ++k) {
    states.push_back("d" + system.state_name(k));
    mixed.push_back("y d" + system.state_name(k));
  }
  for (const int k : x.parameters) {
    parameters.push_back("d" + system.parameter_name(k));
    mixed_parameters.push_back("y d" + system.parameter_name(k));
  }
  std::string text = columns(system, {"y", "y^2", "y^3"}, powers, x.error) +
                     columns(system, states, x.dx.topLeftCorner(n, n), x.error) +
                     columns(system, mixed, x.ydx.topLeftCorner(n, n), x.error);
  if (!parameters.empty())
    text += columns(system, parameters, x.dp.topRows(n), x.error) +
            columns(system, mixed_parameters, x.ydp.topRows(n), x.error);
  return text + fmt::format("Errors of these coefficients are about {:.0e}.\n", x.error);
}

std::string order_text(const MapComparison& comparison) {
  constexpr const char* const orders[] = {"1/2", "1", "3/2"};
  std::string text = "The error falls as";
  for (std::size_t k = 0; k < comparison.orders.size(); ++k) {
    const auto& order = comparison.orders[k];
    text += k == 0 ? " " : k == 1 ? ", " : " and ";
    text += order ? fmt::format("y^{:.2f} (order {}, from {:.0e} to {:.0e})", order->power, orders[k], order->from,
                                order->to)
                  : fmt::format("rounding (order {})", orders[k]);
  }
  return text + ".\n";
}

std::string comparison_text(const MapComparison& comparison) {
  std::string text = fmt::format("{:>12}{:>16}{:>14}{:>14}{:>14}\n", "penetration", "|g(x) - x*|", "order 1/2",
                                 "order 1", "order 3/2");
  for (const ComparedPenetration& row : comparison.rows) {
    text += fmt::format("{:>12.3e}", row.penetration);
    if (!std::isfinite(row.change)) {
      text += "   no value: too far from the contact\n";
      continue;
    }
    text += fmt::format("{:>16.8e}", row.change);
    for (const double error : row.errors) text += fmt::format("{:>14.2e}", error);
    text += '\n';
  }
  return text + order_text(comparison);
}

std::string parameters_text(const HybridSystem& system, const GrazingPoint& point) {
  std::string text;
  for (int k = 1; k <= system.parameters(); ++k)
    text += fmt::format("{}{} = {:.12g}", k > 1 ? ", " : "", system.parameter_name(k), point.par(k - 1));
  return text;
}

std::string born_row(const GrazingOrbit& orbit, const BornOrbits& born, const BornOrbit& one,
                     const std::string& parameter) {
  std::string text = fmt::format("{:>5}  ", one.returns);
  if (one.side == 0) return text + "none to first order\n";
  if (one.hits_at > 0) return text + fmt::format("none: it would touch again after {}\n", one.hits_at);
  const double penetration = born.has_square_root ? one.rate * one.rate : one.rate;
  const double velocity = std::sqrt(2.0 * orbit.point.a) * (born.has_square_root ? one.rate : std::sqrt(one.rate));
  text += fmt::format(
      "{:<24}{:>16.8g}{:>16.8g}",
      fmt::format("{} {} {:.8g}", parameter, one.side > 0 ? '>' : '<', orbit.point.par(orbit.parameter - 1)),
      penetration, -velocity);
  return text + fmt::format("{:>18}\n", complex_text(one.multiplier, 0.0));
}

}  // namespace

std::string point_report(const HybridSystem& system, const GrazingPoint& point) {
  std::string text = fmt::format(
      "Contact with {} in {}; contact brings {}", function_text(system, FunctionKind::event, point.event),
      function_text(system, FunctionKind::field, point.field), function_text(system, FunctionKind::jump, point.jump));
  if (!point.aftermath.empty()) text += fmt::format(", then {} for a short time", to_string(point.aftermath));
  text += fmt::format(".\n{}\n\n", parameters_text(system, point));
  const int n = system.dimension_of(point.field);
  text += names_row(system, n) + row("x*", point.x.head(n)) + row("h_D,x", point.event_gradient.head(n)) +
          row("h_P,x", point.section_gradient.head(n)) + row("f", point.f.head(n));
  const double scale = point.f.norm();
  const auto direction = [&](const VectorXd& v) {
    return v.norm() <= level::negligible * scale ? VectorXd::Zero(n) : VectorXd(v.head(n));
  };
  text += row("beta", direction(point.impact.beta)) + row("B", direction(point.B));
  return text + fmt::format("a* = {:.12g}{}\n", point.a,
                            point.has_square_root() ? "" : "; beta = 0: the map has no square root on P");
}

std::string orbit_report(const HybridSystem& system, const GrazingOrbit& orbit, const std::vector<ImpactReturn>& xi) {
  const std::string parameter = system.parameter_name(orbit.parameter);
  std::string text =
      fmt::format("Segments from the contact: {}, period {:.12g}.\n{} = {:.12g} where the orbit touches",
                  to_string(orbit.segments), orbit.period(), parameter, orbit.point.par(orbit.parameter - 1));
  text += fmt::format(" ({:.1e} from the label).\n\n", orbit.moved);
  const int states = system.dimension_of(orbit.point.field);
  text += "A, the derivative of the smooth return map on P:\n" + names_row(system, states);
  const double rounding = level::negligible * orbit.A.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < states; ++i) {
    VectorXd shown = orbit.A.row(i).head(states).transpose();
    for (double& value : shown)
      if (std::abs(value) <= rounding) value = 0.0;
    text += row(system.state_name(static_cast<int>(i) + 1), shown);
  }
  text += "Eigenvalues: ";
  // The structural zero, as computed.
  const double zero = level::converged * std::max(1.0, std::abs(orbit.multipliers(0)));
  for (Eigen::Index i = 0; i < states; ++i) text += (i > 0 ? ", " : "") + complex_text(orbit.multipliers(i), zero);
  text += '\n';
  if (!orbit.point.has_square_root()) return text;
  for (std::size_t n = 0; n < xi.size(); ++n)
    text += fmt::format("{}xi_{:<3}{:>17.9g}", n % 4 == 0 ? "\n" : "   ", n + 1, xi[n].xi);
  return text + '\n';
}

std::string map_report(const HybridSystem& system, const DiscontinuityMap& map, const MapComparison& comparison) {
  std::string text = fmt::format("Discontinuity map on {}: deviations d from x* after contact, y = sqrt(-h_D){}\n",
                                 section_text(system, map), map.section() ? " where the smooth flow meets P" : "");
  if (map.section())
    text +=
        fmt::format("-h_D there = -h_D,x d + (h_P,x d)^2 / (2 a*) + ..., 1 / (2 a*) = {:.11g}\n", 0.5 / map.point().a);
  return text + expansion_text(system, map) + '\n' + "Error of the expansion:\n" + comparison_text(comparison);
}

std::string verdict_report(const GrazingVerdict& verdict) {
  return fmt::format("Verdict: {}\nReason: {}.\n", verdict.words(), verdict.reason);
}

std::string born_report(const HybridSystem& system, const GrazingOrbit& orbit, const BornOrbits& born) {
  const std::string parameter = system.parameter_name(orbit.parameter);
  std::string text =
      fmt::format("Impacting orbits near grazing, one impact in k returns, delta = change of {}:\n", parameter);
  if (std::abs(born.clearance) <= level::orbit * born.clearance_terms)
    return text + fmt::format("none to first order: {} does not move the orbit off the surface\n", parameter);
  text += fmt::format("the orbit without contact lives at {} {} {:.8g}.\n", parameter, born.clearance > 0.0 ? '>' : '<',
                      orbit.point.par(orbit.parameter - 1));
  const char* const penetration = born.has_square_root ? "/ delta^2" : "/ |delta|";
  const char* const velocity = born.has_square_root ? "/ |delta|" : "/ sqrt|delta|";
  const char* const multiplier = born.has_square_root ? "* |delta|" : "";
  text +=
      fmt::format("{:>5}  {:<24}{:>16}{:>16}{:>18}\n", "k", "lives at", "penetration", "velocity h_D'", "multiplier");
  text += fmt::format("{:>5}  {:<24}{:>16}{:>16}{:>18}\n", "", "", penetration, velocity, multiplier);
  for (const BornOrbit& one : born.orbits) text += born_row(orbit, born, one, parameter);
  return text;
}

}  // namespace tchat
