#include "simulate/simulation_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "base/words.hpp"
#include "files/dat_file.hpp"
#include "files/recorded_labels.hpp"
#include "files/run_files.hpp"
#include "files/solution_file_reader.hpp"
#include "model/events.hpp"
#include "model/index_vector.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_setup.hpp"
#include "settings/constants_file.hpp"

namespace tchat {

namespace {

/// The segments of --signature; those that the file has keep its monitored event functions.
std::vector<SegmentSettings> segments_of_signature(const std::string& text, const std::vector<SegmentSettings>& known) {
  std::vector<SegmentSettings> segments;
  for (const IndexVector& index : parse_signature(text)) {
    const auto same = std::find_if(known.begin(), known.end(), [&](const auto& s) { return s.index == index; });
    SegmentSettings segment;
    if (same != known.end()) segment = *same;
    segment.index = index;
    segments.push_back(std::move(segment));
  }
  return segments;
}

void require_events(const HybridSystem& system) {
  if (system.count(FunctionKind::event) > 0 && system.count(FunctionKind::jump) > 0) return;
  throw UserError(fmt::format(
      "problem {} has no event functions or no jumps, so no segment of a simulation could end; write one, a "
      "section of the orbit, or use `tchat run`: IPS = 4, or event function 0 for smooth orbits",
      system.name()));
}

}  // namespace

SimulationConstants read_simulation_constants(const SimulationRequest& request) {
  SimulationConstants constants;
  if (request.constants)
    constants.path = constants_path(*request.constants);
  else
    constants.path = own_constants_path(request.name);
  RunSettings& settings = constants.settings;
  if (constants.is_given()) {
    settings = read_constants_file(constants.path);
  } else {
    settings.free_parameters = {1};
    settings.segments.resize(1);
  }
  apply_overrides(settings, request.overrides);
  constants.file_segments = static_cast<int>(settings.segments.size());
  constants.has_signature = constants.is_given();
  return constants;
}

SimulationConstants with_signature(const SimulationRequest& request, SimulationConstants constants) {
  if (!request.signature) return constants;
  std::vector<SegmentSettings>& segments = constants.settings.segments;
  segments =
      segments_of_signature(*request.signature, constants.is_given() ? segments : std::vector<SegmentSettings>{});
  constants.has_signature = true;
  return constants;
}

ProblemSizes sizes_of(const SimulationRequest& request, const SimulationConstants& constants) {
  if (!constants.is_given())
    throw UserError(
        fmt::format("{} is a Fortran plugin, which does not say how many states and functions it has; give a constants "
                    "file with -c C (or name one gc.{}), whose NDIM and signature say it",
                    request.name, request.name));
  ProblemSizes sizes = problem_sizes(constants.settings);
  if (request.modes)
    for (const IndexVector& index : parse_modes(*request.modes)) sizes.add(index);
  return sizes;
}

void fit_to_problem(SimulationConstants& constants, const HybridSystem& system,
                    const std::vector<std::string>& overrides) {
  require_events(system);
  if (!constants.is_given()) constants.settings.dimension = system.dimension();
  for (const SegmentSettings& segment : constants.settings.segments)
    if (const std::string fault = fault_of(system, {segment.index}); constants.has_signature && !fault.empty())
      throw UserError(fmt::format(
          "{}: {}", constants.is_given() ? SettingsSource{constants.path, overrides}.of("GCFIND") : "--signature",
          fault));
  if (constants.is_given()) check_settings_against(system, constants.settings, {constants.path, overrides});
}

namespace {

using Eigen::VectorXd;

/// Those of --mode, which the problem must have.
std::vector<IndexVector> existing_modes(const HybridSystem& system, const std::string& text) {
  std::vector<IndexVector> index_vectors = parse_modes(text);
  if (const std::string fault = fault_of(system, index_vectors); !fault.empty())
    throw UserError(fmt::format("--mode {}: {}", text, fault));
  return index_vectors;
}

std::vector<Mode> modes_of_signature(const RunSettings& settings) {
  std::vector<Mode> modes;
  for (const SegmentSettings& segment : settings.segments) {
    Mode mode{{segment.index}, segment.monitor};
    std::erase(mode.monitored, segment.index.event);
    modes.push_back(std::move(mode));
  }
  return modes;
}

bool has_one_of_each(const HybridSystem& system) {
  return system.count(FunctionKind::field) == 1 && system.count(FunctionKind::event) == 1 &&
         system.count(FunctionKind::jump) == 1;
}

[[noreturn]] void refuse_without_signature(const SimulationRequest& request, const HybridSystem& system) {
  if (system.has_successors())
    throw UserError(
        fmt::format("--follow-signature: there is no signature to follow; give it with --signature '1,2,2;...' or a "
                    "constants file with -c C (there is no gc.{})",
                    request.name));
  throw UserError(
      fmt::format("{} has no index jump function (successors), so a simulation follows a signature; give it with "
                  "--signature '1,2,2;...' or a constants file with -c C (there is no gc.{}), or give the problem a "
                  "member `successors` (in a file of formulas: lines `after EVENT: FIELD until EVENT -> JUMP`; page "
                  "simulation.md)",
                  system.name(), request.name));
}

/// The signature, beginning at --mode.
ModeRule cyclic_rule(const SimulationRequest& request, const SimulationConstants& constants,
                     const HybridSystem& system) {
  if (!constants.has_signature && !has_one_of_each(system)) refuse_without_signature(request, system);
  std::vector<Mode> modes = constants.has_signature ? modes_of_signature(constants.settings)
                                                    : std::vector<Mode>{Mode{{IndexVector{1, 1, 1}}, {}}};
  // --signature alone says nothing of what else matters.
  const bool says_nothing = request.signature && std::all_of(modes.begin(), modes.end(),
                                                             [](const Mode& mode) { return mode.monitored.empty(); });
  const auto monitor = says_nothing ? ModeRule::Monitor::what_follows : ModeRule::Monitor::as_given;
  if (!request.modes) return ModeRule(system, std::move(modes), monitor);
  const std::vector<IndexVector> wanted = existing_modes(system, *request.modes);
  const auto at = std::find_if(modes.begin(), modes.end(), [&](const Mode& m) { return m.index_vectors == wanted; });
  if (at == modes.end())
    throw UserError(
        fmt::format("--mode {}: the signature, which the simulation follows, is {}; give one of its index "
                    "vectors",
                    *request.modes, to_string(constants.settings.signature())));
  std::rotate(modes.begin(), at, modes.end());
  return ModeRule(system, std::move(modes), monitor);
}

}  // namespace

std::vector<IndexVector> parse_modes(const std::string& text) {
  std::vector<IndexVector> different;
  for (const IndexVector& index : parse_index_vectors(text, "--mode"))
    if (std::find(different.begin(), different.end(), index) == different.end()) different.push_back(index);
  return different;
}

std::string modes_text(const std::vector<IndexVector>& modes) {
  std::string text;
  for (const IndexVector& v : modes)
    text += fmt::format("{}{},{},{}", text.empty() ? "" : ";", v.field, v.event, v.jump);
  return text;
}

ModeRule simulation_rule(const SimulationRequest& request, const SimulationConstants& constants,
                         const HybridSystem& system, const VectorXd& x, const VectorXd& par) {
  if (!system.has_successors() || request.follow_signature || request.signature)
    return cyclic_rule(request, constants, system);
  if (request.modes) return ModeRule(system, Mode{existing_modes(system, *request.modes), {}});
  const auto start = system.successors({0, 0, 0}, x.data(), par.data());
  const bool is_silent = !start || start->empty();
  if (is_silent && constants.has_signature)
    return ModeRule(system, Mode{{constants.settings.segments.front().index}, {}});
  return ModeRule(system);
}

LoadedProblem load_for_simulation(const SimulationRequest& request, std::ostream* progress) {
  LoadedProblem loaded;
  loaded.plugin = resolve_plugin(request.problem.value_or(request.name), {.progress = progress});
  SimulationConstants constants = read_simulation_constants(request);
  loaded.library = std::make_unique<ProblemLibrary>(
      loaded.plugin, [&] { return sizes_of(request, with_signature(request, constants)); });
  loaded.library->add_section();
  const HybridSystem& system = loaded.library->system();
  resolve_names(constants.settings, system);
  loaded.constants = with_signature(request, constants);
  // A signature of constants has no section that a simulation could end at.
  if (loaded.library->has_added_section() && !request.signature) loaded.constants.has_signature = false;
  fit_to_problem(loaded.constants, system, request.overrides);
  return loaded;
}

SimulationSettings simulation_settings(const SimulationRequest& request, const std::function<bool()>& interrupted) {
  SimulationSettings settings;
  settings.flow.method = request.stiff ? IntegrationMethod::bdf : IntegrationMethod::adams;
  settings.flow.relative_tolerance = request.tolerance;
  settings.flow.absolute_tolerance = 0.01 * request.tolerance;
  settings.flow.max_duration = request.wait;
  settings.flow.max_steps = 10000000;
  settings.steps_without_event = request.steps_without_event;
  settings.contact = request.contact;
  settings.samples = static_cast<std::size_t>(request.rows);
  settings.interrupted = interrupted;
  return settings;
}

namespace {

constexpr double orbit_tolerance = level::five_digits;  // of a label or a .dat, relative

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
  VectorXd sizes = VectorXd::Zero(n);
  for (Eigen::Index s = 0; s < m; ++s)
    sizes = sizes.cwiseMax(states.middleRows(s * n, n).cwiseAbs().rowwise().maxCoeff());
  const bool is_closed = ((image - start).cwiseAbs().array() <= orbit_tolerance * sizes.array()).all();
  if (!is_closed || !(std::abs(at.h) <= orbit_tolerance * at.scale(end.data(), sizes))) return std::nullopt;
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
  require_recorded_parameters(path, system);
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
