#include "simulate/simulate_problem.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "base/progress_line.hpp"
#include "base/user_error.hpp"
#include "files/auto_format.hpp"
#include "files/dat_file.hpp"
#include "files/replaced_file.hpp"
#include "files/run_files.hpp"
#include "files/simulation_files.hpp"
#include "motion/attractor_search.hpp"
#include "motion/equilibrium_approach.hpp"
#include "motion/found_orbit.hpp"
#include "plugin/problem_setup.hpp"
#include "settings/constants_writer.hpp"
#include "settings/run_settings.hpp"
#include "simulate/exponent_measurement.hpp"
#include "simulate/loaded_problem.hpp"
#include "simulate/orbit_hand_over.hpp"
#include "simulate/recorded_period.hpp"
#include "simulate/simulation_start.hpp"
#include "simulate/simulation_summary.hpp"
#include "simulate/start_notice.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;
using Eigen::VectorXd;

constexpr std::size_t megabyte = 1000000;
constexpr std::size_t told_size = 10 * megabyte;  // of a file
constexpr std::size_t kept_size = 9900000;        // of a trajectory when no length has been asked for

/// Asked for a part of the motion: all of that is written.
bool has_length(const SimulationPlan& plan) {
  return plan.time || plan.events || plan.transient_time > 0.0 || plan.transient_events > 0;
}

/// "x.trajectory (377 MB)": sizes that may surprise are told.
std::string sized(const std::string& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error || size <= told_size) return path;
  return fmt::format("{} ({} MB)", path, (size + megabyte / 2) / megabyte);
}

std::string written_text(const std::string& output, const SimulationFiles& files) {
  std::string text = fmt::format("Written: {}, {}\n", sized(SimulationFiles::trajectory_path(output)),
                                 sized(SimulationFiles::events_path(output)));
  if (files.dropped_segments() > 0)
    text += fmt::format(
        "  The trajectory holds the last {} of {} segments; with --events, --time or a transient it holds all.\n",
        files.segments() - files.dropped_segments(), files.segments());
  return text;
}

struct OrbitPaths {
  std::string data, constants;
};

OrbitPaths orbit_paths(const std::string& name) { return {name + ".dat", constants_file_of(name)}; }

/// Files NAME.*, gc.NAME can be made from `name`.
void check_name(const std::string& name, const char* option) {
  const std::string file = fs::path(name).filename().string();
  if (file.empty() || file == "." || file == "..")
    throw UserError(fmt::format("{} '{}' is no name for output files; an example is {} found", option, name, option));
}

/// The orbit's files must not replace what the simulation reads, unless they have been named.
void check_orbit_name(const SimulationRequest& request, const std::string& name, const std::string& constants) {
  check_name(name, "--dat");
  const OrbitPaths paths = orbit_paths(name);
  require_writable(paths.data);
  require_writable(paths.constants);
  if (!request.orbit_name.empty()) return;
  std::string replaced;
  if (!constants.empty() && same_file(paths.constants, constants)) replaced = paths.constants;
  if (request.data && (same_file(paths.data, *request.data) || same_file(paths.data, *request.data + ".dat")))
    replaced = paths.data;
  if (!replaced.empty())
    throw UserError(
        fmt::format("--dat would replace {}, which the simulation starts from; give the orbit a name, as in "
                    "--dat {}_orbit",
                    replaced, request.name));
}

int continuation_parameter(const SimulationRequest& request, const SimulationConstants& constants,
                           const HybridSystem& system) {
  if (request.parameter) {
    const int k = parameter_index(system, *request.parameter, "--free");
    if (k <= system.parameters()) return k;
    throw UserError(fmt::format("--free {}: {} has PAR(1) to PAR({}); one of them is to be free", *request.parameter,
                                system.name(), system.parameters()));
  }
  for (const int k : constants.settings.free_parameters)
    if (k <= system.parameters()) return k;
  return 1;
}

/// What to say of data and constants that have been written.
std::string next_run_text(const SimulationRequest& request, const OrbitPaths& paths, const std::string& name) {
  const std::string plugin = request.problem ? fmt::format(" -p {}", *request.problem) : "";
  return fmt::format("Written: {} and {}\n  next: tchat run {}{} -c {} -d {} -o {}\n", paths.data, paths.constants,
                     request.name, plugin, name, name, name);
}

/// The event functions of the problem itself: the last one is the section that tchat has added.
std::vector<int> own_events(const HybridSystem& sectioned) {
  std::vector<int> events;
  for (int j = 1; j < sectioned.count(FunctionKind::event); ++j) events.push_back(j);
  return events;
}

/// Writes the equilibrium for `tchat run`; what to say about it.
std::string hand_over_equilibrium(const SimulationRequest& request, const SimulationConstants& constants,
                                  const HybridSimulation& simulation, bool has_added_section, const VectorXd& x,
                                  const std::string& name) {
  const HybridSystem& system = simulation.system();
  const VectorXd& par = simulation.parameters();
  const RunSettings base = constants.is_given() ? constants.settings : default_orbit_settings(constants.settings);
  const Mode& mode = simulation.mode();
  RunSettings settings =
      equilibrium_settings(system, base, mode.field(), has_added_section ? own_events(system) : mode.all_events(), x,
                           par, continuation_parameter(request, constants, system));
  const OrbitPaths paths = orbit_paths(name);
  settings.problem = problem_to_record(request.problem.value_or(request.name), paths.constants);
  write_whole_file(paths.data, equilibrium_data_text(system, x, par));
  write_whole_file(paths.constants, keyword_text(settings));
  return next_run_text(request, paths, name);
}

/// Writes the orbit for `tchat run`; what to say about it.
std::string hand_over(const SimulationRequest& request, const SimulationConstants& constants,
                      const HybridSystem& system, const FoundOrbit& orbit, const VectorXd& par,
                      const std::string& name) {
  const RunSettings base = constants.is_given() ? constants.settings : default_orbit_settings(constants.settings);
  const OrbitSamples samples = sample_orbit(system, orbit, par, base.mesh_intervals, base.collocation_points);
  RunSettings settings =
      orbit_settings(system, base, orbit, samples, par, continuation_parameter(request, constants, system));
  const OrbitPaths paths = orbit_paths(name);
  settings.problem = problem_to_record(request.problem.value_or(request.name), paths.constants);
  write_whole_file(paths.data, orbit_data_text(system, orbit, samples, par));
  write_whole_file(paths.constants, keyword_text(settings));
  const std::string finer = samples.intervals == base.mesh_intervals
                                ? ""
                                : fmt::format("The orbit is sharp: NTST = {} instead of {}, for an error of {:.1e}.\n",
                                              samples.intervals, base.mesh_intervals, samples.error);
  const bool is_smooth = orbit.modes.front().index_vectors.empty();  // no event says where its field holds
  return finer + (is_smooth ? "" : unmonitored_events(system, orbit, samples, par)) +
         next_run_text(request, paths, name);
}

/// "" when the orbit can be continued; otherwise why not.
std::string obstacle(const HybridSystem& system, const SimulationResult& result, const FoundOrbit& orbit) {
  if (!result.is_periodic()) return "no periodic orbit was found";
  if (!orbit.converged) return "the orbit could not be refined";
  for (Eigen::Index i = 0; i < orbit.advance.size(); ++i)
    if (std::abs(orbit.advance(i)) > 1e-9 * (1.0 + std::abs(orbit.start(i))))
      return fmt::format("{} does not return; `tchat run` needs a problem without that state",
                         system.state_name(static_cast<int>(i) + 1));
  return "";
}

}  // namespace

namespace {

/// The turn of `result` is that of the orbit which the motion has settled on, if it has.
void take_orbit(AttractorSearch& search, const HybridSimulation& simulation, SimulationResult& result) {
  result.turn.clear();
  if (result.accumulation || result.dies_out || result.last.ended_by == SegmentEnd::failed) return;
  if (!search.orbit() && !search.equilibrium()) search.conclude(simulation);
  if (search.orbit()) result.turn = search.orbit()->turn;
}

/// The equilibrium that the motion comes to, at events or after the last one.
std::optional<VectorXd> equilibrium_of(const AttractorSearch& search, const HybridSimulation& simulation,
                                       const SimulatedSegment& last) {
  if (last.ended_by != SegmentEnd::no_event) return search.equilibrium();
  return reached_equilibrium(simulation.system(), last, simulation.parameters(), search.ignorable());
}

}  // namespace

int simulate_problem(const SimulationRequest& request, std::ostream& screen, std::ostream& warnings,
                     const std::function<bool()>& interrupted, std::ostream* progress) {
  const auto say = [&](const std::string& text) {
    if (!request.quiet) screen << text << std::flush;
  };

  const LoadedProblem loaded = load_for_simulation(request, progress);
  const SimulationConstants& constants = loaded.constants;
  const HybridSystem& system = loaded.library->system();
  const SimulationStart start = simulation_start(request, constants, system);
  const std::string output = request.output.value_or(request.name);
  const std::string orbit_name = request.orbit_name.empty() ? output : request.orbit_name;
  check_name(output, "-o");
  require_writable(SimulationFiles::trajectory_path(output));
  require_writable(SimulationFiles::events_path(output));
  if (request.hand_over) {
    check_orbit_name(request, orbit_name, constants.path);
    continuation_parameter(request, constants, system);
  }

  SimulationSettings settings = simulation_settings(request, interrupted);
  settings.side = start.side;
  const std::unique_ptr<LyapunovAccumulator> exponents = exponents_to_measure(request, system, start.par);
  if (exponents) exponents->attach(settings);
  HybridSimulation simulation(start.rule, start.state, start.par, settings);
  say(start_text(system, start, simulation.mode()));
  if (loaded.library->has_added_section())
    say(fmt::format("{} has no event that ends a segment: its motion is cut at each {}.\n", system.name(),
                    system.function_name(FunctionKind::event, system.count(FunctionKind::event))));
  warnings << side_without_effect(simulation, request.side);
  for (const StartNotice& notice : start_notices(simulation)) warnings << notice_text(system, notice);
  SimulationFiles files(system, output, problem_text(system, start.par), start.par,
                        has_length(request.plan) ? SimulationFiles::everything : kept_size);
  SimulationResult result;
  SimulationPlan plan = request.plan;
  if (request.refine) plan.events = plan.events.value_or(plan.max_period) + 1;  // up to the first one is no segment
  std::vector<SimulatedSegment> recorded;                                       // of a guess
  const bool measures_on_the_way = exponents && has_wanted_length(request.plan);
  AttractorSearch search(request.plan.max_period, request.plan.recognition, simulation_settings(request, interrupted));
  {
    ProgressLine line(progress);
    const auto keep = [&](const SimulatedSegment& segment) {
      files.write(segment);
      if (request.refine) recorded.push_back(segment);
      if (measures_on_the_way) exponents->pass(segment);
      if (has_wanted_length(plan) && segment.ended_by == SegmentEnd::event) search.add(simulation, segment);
      if (line.is_due()) line.show(fmt::format("{} events, t = {:.6g} ", segment.number, segment.end_time()));
    };
    result = run_simulation(simulation, plan, keep,
                            [&](const SimulatedSegment& segment) { return search.has_settled(simulation, segment); });
  }
  files.finish();
  RecordedPeriod period;
  if (request.refine) {
    period = recorded_period(recorded, request.plan.events, result.ignorable);
    result.turn = period.segments;
  } else {
    take_orbit(search, simulation, result);
  }
  say(course_text(system, result, result.last.end_time(), request.contact));

  FoundOrbit orbit;
  std::optional<VectorXd> rest;
  if (result.is_periodic()) {
    const IndexVector first =
        constants.has_signature ? constants.settings.segments.front().index : IndexVector{0, 0, 0};
    if (request.without_sections) result.turn = without_sections(system, std::move(result.turn));
    if (request.refine) {
      orbit = refine(system, result, start.par, first, true);
      say(refined_text(orbit, static_cast<long>(result.turn.size()), period.size));
    } else {
      orbit = refine(system, result, start.par, first);
      if (!orbit.converged) say(not_refined_text(orbit, static_cast<long>(result.turn.size())));
    }
    if (orbit.converged) say(orbit_text(system, orbit));
  } else if (request.refine) {
    say(nothing_recorded_text(request.plan));
  } else if (rest = equilibrium_of(search, simulation, result.last); rest) {
    say(rest_text(*rest));
  } else {
    say(no_orbit_text(result, request.plan, search));
  }
  const bool is_attracting = orbit.converged && orbit.stability() == OrbitStability::stable;
  if (exponents && search.equilibrium() && !has_wanted_length(request.plan)) {
    say("No Lyapunov exponents: the trajectory converges to an equilibrium; --events or --time computes those of a "
        "part of it.\n");
  } else if (exponents) {
    // Those of the orbit itself, not of the way to it.
    HybridSimulation measured =
        is_attracting && search.orbit() ? HybridSimulation(simulation, search.orbit()->end, settings) : simulation;
    say(exponents_of(request, result, measured, *exponents, is_attracting, settings, progress));
  }
  say(written_text(output, files));
  if (result.last.ended_by == SegmentEnd::failed) {
    warnings << "tchat: " << result.last.message << '\n';
    return 1;
  }
  if (!request.hand_over) return 0;
  if (rest) {
    say(hand_over_equilibrium(request, constants, simulation, loaded.library->has_added_section(), *rest, orbit_name));
    return 0;
  }
  if (const std::string why = obstacle(system, result, orbit); !why.empty()) {
    warnings << fmt::format("tchat: --dat: nothing written, {}\n", why);
    return 1;
  }
  if (loaded.library->has_added_section()) orbit = without_cuts(std::move(orbit), own_events(system));
  say(hand_over(request, constants, system, orbit, start.par, orbit_name));
  return 0;
}

}  // namespace tchat
