#include "simulate/simulation_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>

#include "base/number.hpp"
#include "base/user_error.hpp"
#include "base/words.hpp"
#include "files/dat_file.hpp"
#include "files/run_files.hpp"
#include "files/solution_file_reader.hpp"
#include "model/event_at.hpp"
#include "model/mode_dimensions.hpp"
#include "simulate/simulation_rule.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;

constexpr double orbit_tolerance = 1e-4;  // of a label or a .dat, relative

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = text.find(separator, begin);
    parts.emplace_back(trimmed(std::string_view(text).substr(begin, end - begin)));
    if (end == std::string::npos) return parts;
    begin = end + 1;
  }
}

double read_state_value(const std::string& text, const std::string& all) {
  if (const std::optional<double> value = parse_real(text)) return *value;
  throw UserError(fmt::format("--state {}: '{}' is no finite number; examples: --state 0,0.1,-2.5e-3 or --state x1=0.1",
                              all, text));
}

/// "0,0.1" replaces the state, "x1=0.1,x2=3" changes it.
void apply_state_option(const HybridSystem& system, const std::string& text, VectorXd& state) {
  const std::vector<std::string> parts = split(text, ',');
  if (text.find('=') != std::string::npos) {
    std::set<int> given;
    for (const std::string& part : parts) {
      const std::size_t equals = part.find('=');
      if (equals == std::string::npos)
        throw UserError(fmt::format(
            "--state {}: '{}' lacks its name; give NAME=VALUE for some states or all {} values; decimals are written "
            "with a point",
            text, part, system.dimension()));
      const std::string name = split(part.substr(0, equals), ',').front();
      const int k = state_index(system, name, "--state " + text);
      if (!given.insert(k).second) throw UserError(fmt::format("--state {}: '{}' is given twice", text, name));
      state(k - 1) = read_state_value(split(part.substr(equals + 1), ',').front(), text);
    }
    return;
  }
  if (static_cast<int>(parts.size()) != system.dimension())
    throw UserError(
        fmt::format("--state {}: {} values, but {} has {} states; give them all, or some by name as in "
                    "--state {}=0.1",
                    text, parts.size(), system.name(), system.dimension(), system.state_name(1)));
  for (std::size_t i = 0; i < parts.size(); ++i) state(static_cast<Eigen::Index>(i)) = read_state_value(parts[i], text);
}

/// The last index vector of the orbit of m segments whose states, n m x (number of points), are given, if the
/// constants' signature is that of the orbit: its last event and jump lead from the end to the start.
std::optional<IndexVector> last_index(const HybridSystem& system, const SimulationConstants& constants,
                                      const Eigen::MatrixXd& states, const VectorXd& par) {
  if (!constants.has_signature) return std::nullopt;
  const IndexVector last = constants.settings.segments.back().index;
  const Eigen::Index n = system.dimension();
  const auto m = static_cast<Eigen::Index>(constants.settings.segments.size());
  if (states.rows() != n * m || !fault_of(system, {last}).empty()) return std::nullopt;
  const VectorXd start = states.col(0).head(n);
  const VectorXd end = states.col(states.cols() - 1).tail(n);
  VectorXd image(n);
  system.value(FunctionKind::jump, last.jump, end.data(), par.data(), image.data());
  const EventAt at = event_at(system, last.event, end.data(), par.data());
  const bool is_closed = (image - start).norm() <= orbit_tolerance * (1.0 + start.norm());
  if (!is_closed || !(std::abs(at.h) <= orbit_tolerance * at.scale(end.data()))) return std::nullopt;
  return last;
}

/// The index vectors watched after the orbit's last event, where the problem's index jump function decides and agrees
/// with the signature; else empty.
std::vector<IndexVector> watched_after(const HybridSystem& system, const SimulationConstants& constants,
                                       const IndexVector& last, const VectorXd& end, const VectorXd& par) {
  const auto next = system.successors(last, end.data(), par.data());
  if (!next || !fault_of(system, *next).empty()) return {};
  const IndexVector first = constants.settings.segments.front().index;
  return std::find(next->begin(), next->end(), first) == next->end() ? std::vector<IndexVector>{} : *next;
}

/// The start is that of an orbit with these states: it lies behind the orbit's last event.
void start_after_orbit(const HybridSystem& system, const SimulationConstants& constants, const Eigen::MatrixXd& states,
                       SimulationStart& start) {
  start.side.given = StartSide::Given::after;
  const std::optional<IndexVector> last = last_index(system, constants, states, start.par);
  if (!last) return;
  start.side.event = last->event;
  const VectorXd end = states.col(states.cols() - 1).tail(system.dimension());
  start.watched = watched_after(system, constants, *last, end, start.par);
}

/// Of an orbit of the signature, that of the constants file or --signature's, or of one segment: the first row is all
/// that matters.
DatFile read_start(const std::string& path, const SimulationConstants& constants, int n) {
  const int m = constants.has_signature ? static_cast<int>(constants.settings.segments.size()) : 1;
  for (const int other : {constants.file_segments, 1}) {
    if (other == m) continue;
    try {
      return read_dat_file(path, n, other);
    } catch (const UserError&) {
      continue;  // what is wrong with it is told about the signature's number
    }
  }
  return read_dat_file(path, n, m);
}

void apply_data(const SimulationRequest& request, const SimulationConstants& constants, const HybridSystem& system,
                SimulationStart& start) {
  const std::string path = data_path(*request.data);
  const DatFile data = read_start(path, constants, system.dimension());
  for (const auto& [k, value] : given_parameters(data, system, path, start.par)) start.par(k - 1) = value;
  start.state = data.states.col(0).head(system.dimension());
  start.source = fmt::format("first row of {}", path);
  start_after_orbit(system, constants, data.states, start);
}

void apply_label(const SimulationRequest& request, const SimulationConstants& constants, const HybridSystem& system,
                 SimulationStart& start) {
  const std::string path = solution_path(*request.start);
  const SolutionFile file = read_solution_file(path, constants.settings.start);
  if (constants.settings.start.from_data())
    throw UserError(
        fmt::format("-s {}: say which label with IRS=, as in IRS=3 or IRS=PD1; `tchat labels {}` lists them",
                    *request.start, path));
  const LabelledSolution& solution = find_solution(file.solutions, constants.settings.start, path);
  if (solution.states.rows() < system.dimension() ||
      (solution.dimension > 0 && solution.dimension != system.dimension()))
    throw UserError(fmt::format("{}: label {} has {} states, {} has {}; give the q-file of this problem", path,
                                solution.label,
                                solution.dimension > 0 ? solution.dimension : static_cast<int>(solution.states.rows()),
                                system.name(), system.dimension()));
  const LabelledSolution placed = in_layout(solution, system.layout());
  for (std::size_t k = 0; k < std::min(placed.parameters.size(), static_cast<std::size_t>(start.par.size())); ++k)
    start.par(static_cast<Eigen::Index>(k)) = placed.parameters[k];
  start.state = solution.states.col(0).head(system.dimension());
  start.source = fmt::format("label {} of {}", solution.label, path);
  start_after_orbit(system, constants, solution.states, start);
}

}  // namespace

int state_index(const HybridSystem& system, const std::string& name, const std::string& where) {
  std::string list;
  for (int k = 1; k <= system.dimension(); ++k) {
    if (name == system.state_name(k) || name == fmt::format("U({})", k)) return k;
    list += fmt::format("{}{}", k > 1 ? ", " : "", system.state_name(k));
  }
  throw UserError(fmt::format("{}: {} has no state '{}'; it has {}", where, system.name(), name, list));
}

SimulationStart simulation_start(const SimulationRequest& request, const SimulationConstants& constants,
                                 const HybridSystem& system) {
  if (request.data && request.start)
    throw UserError("-d and -s are both given; a simulation starts from data (-d) or from a label of a q-file (-s)");
  SimulationStart start{initial_parameters(system), VectorXd::Zero(system.dimension()), "zero", ModeRule(system), {}};
  if (const double* const initial = system.table().initial_state) {
    start.state = Eigen::Map<const VectorXd>(initial, system.dimension());
    start.source = "the problem's starting state";
  }
  if (request.data) apply_data(request, constants, system, start);
  if (request.start) apply_label(request, constants, system, start);
  apply_command_line(system, constants.settings, start.par);
  if (request.state) {
    apply_state_option(system, *request.state, start.state);
    start.source = "--state";
    start.side = {};
    start.watched.clear();
  }
  if (request.side.given != StartSide::Given::nothing) start.side = request.side;
  if (!start.state.allFinite())
    throw UserError(fmt::format("the start {} ({}) is not finite", state_text(start.state), start.source));
  if (!system.has_successors() || request.follow_signature || request.signature || request.modes) start.watched.clear();
  const ModeRule rule = start.watched.empty() ? simulation_rule(request, constants, system, start.state, start.par)
                                              : ModeRule(system, Mode{start.watched, {}});
  if (system.has_modes()) clear_absent(system, ModeRule(rule).first(start.state, start.par).field(), start.state);
  return {start.par, start.state, start.source, rule, start.side, start.watched};
}

}  // namespace tchat
