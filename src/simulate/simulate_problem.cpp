#include "simulate/simulate_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "files/auto_format.hpp"
#include "files/dat_file.hpp"
#include "files/replaced_file.hpp"
#include "files/run_files.hpp"
#include "files/simulation_files.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"
#include "motion/attractor_search.hpp"
#include "motion/chaos_evidence.hpp"
#include "motion/found_orbit.hpp"
#include "motion/growth_series.hpp"
#include "motion/settle.hpp"
#include "plugin/problem_setup.hpp"
#include "settings/constants_writer.hpp"
#include "settings/run_settings.hpp"
#include "simulate/orbit_hand_over.hpp"
#include "simulate/simulation_summary.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr long most_measured = 100000;  // events
constexpr long most_undecided = 16384;  // however small the bars, while they do not tell what the motion is
constexpr long least_measured = 1024;   // so that weighted means of periodic motion have converged
constexpr double bars_of_own = 3.0;     // within which exponents are those of an orbit

/// With the digits that the bar leaves.
std::string value_text(double value, double error) {
  if (!std::isfinite(value)) return std::isnan(value) ? "nan" : "-infinity";
  const double last = error > 0.0 && std::isfinite(error) ? std::floor(std::log10(error)) : -6.0;
  const int digits = static_cast<int>(std::clamp(1.0 - last, 0.0, 12.0));
  std::string text = fmt::format("{:.{}f}", value, digits);
  if (text.find_first_not_of("-0.") == std::string::npos && text.front() == '-') text.erase(0, 1);
  return text;
}

std::string bar_text(double error) {
  if (error == 0.0) return "";
  return std::isfinite(error) ? fmt::format(" +- {:.2g}", error) : " +- unknown";
}

std::string counted(int n, const char* what) { return fmt::format("{} {} exponent{}", n, what, n == 1 ? "" : "s"); }

std::string zeros_text(const LyapunovSpectrum& spectrum, int zeros, int dimension) {
  const std::string found = counted(zeros, "zero") + ", none positive";
  if (keeps_volumes(spectrum, dimension))
    return fmt::format("{}, and volumes are kept: regular motion, on no attractor.", found);
  return fmt::format(
      "{}: as of quasi-periodic motion, on a torus of dimension {} if its attractor is smooth; or of a period too long "
      "to "
      "be looked for.",
      found, zeros);
}

/// The orbit that the motion keeps to is not stable, and the exponents are its own.
bool are_of_orbit(const LyapunovSpectrum& spectrum, const SettledOrbit& orbit) {
  double period = 0.0;
  for (const SimulatedSegment& segment : orbit.turn) period += segment.duration;
  double largest = -std::numeric_limits<double>::infinity();
  for (Index j = 0; j < spectrum.exponents.size(); ++j)
    if (!spectrum.is_structural(j)) largest = std::max(largest, spectrum.exponents(j));
  const double expected = orbit.multipliers.empty() ? 0.0 : std::log(std::abs(orbit.multipliers.front())) / period;
  return std::abs(largest - expected) <= level::visible * std::abs(expected) + bars_of_own * spectrum.accuracy();
}

std::string meaning(const LyapunovSpectrum& spectrum, int section, int dimension, const MotionEvidence& evidence) {
  const bool has_flow = !spectrum.structural.empty() && section == 0;
  const char* const others = has_flow ? "One zero exponent, the others negative" : "All exponents are negative";
  const ExponentSigns signs = signs_of(spectrum);
  if (evidence.orbit && evidence.orbit->stability == OrbitStability::stable)
    return signs.positive + signs.zero + signs.unclear == 0
               ? fmt::format("{}: a stable periodic orbit.", others)
               : "A stable periodic orbit, by its multipliers; the exponents have not converged to ln |multiplier| / "
                 "period yet (--time, --events, --accuracy).";
  if (evidence.orbit && section == 0 && are_of_orbit(spectrum, *evidence.orbit))
    return fmt::format("They are those of the orbit that the motion keeps to, which is {}.",
                       evidence.orbit->stability == OrbitStability::neutral ? "neutral" : "not stable");
  if (!evidence.doubt.empty())
    return fmt::format("{}undecided: {}.", signs.positive > 0 ? counted(signs.positive, "positive") + ", but " : "",
                       evidence.doubt);
  if (signs.positive > 0)
    return fmt::format("{}: the motion is chaotic{}.", counted(signs.positive, "positive"),
                       keeps_volumes(spectrum, dimension) ? ", and volumes are kept: it is on no attractor" : "");
  if (signs.unclear > 0)
    return fmt::format(
        "{}: the bars are too large to tell {}; a longer one has smaller bars (--time, --events, "
        "--accuracy).",
        keeps_volumes(spectrum, dimension) ? "On no attractor, as volumes are kept" : "Undecided",
        keeps_volumes(spectrum, dimension) ? "whether the motion is chaotic" : "what the motion is");
  if (signs.zero > 0) return zeros_text(spectrum, signs.zero + (has_flow ? 1 : 0), dimension);
  if (signs.negative > 0 && (has_flow || section != 0))
    return fmt::format(
        "{}, as of a stable periodic orbit, but undecided: none is approached that is short enough to be "
        "looked for (--max-period, --transient-events).",
        others);
  if (signs.negative > 0) return "All exponents are negative, as where a trajectory converges to an equilibrium.";
  return "The largest exponent is zero: not chaotic; one more (--lyapunov 2) distinguishes periodic from "
         "quasi-periodic "
         "motion.";
}

/// Bars reach ln |mu| / T of the orbit's multipliers, as far as those are above rounding.
void widen_bars(LyapunovSpectrum& spectrum, const FoundOrbit& orbit) {
  std::size_t k = 0;
  for (Index j = 0; j < spectrum.exponents.size(); ++j) {
    if (spectrum.is_structural(j) || !std::isfinite(spectrum.exponents(j))) continue;
    if (k == orbit.multipliers.size() || !(std::abs(orbit.multipliers[k]) > level::differences)) return;
    const double expected = std::log(std::abs(orbit.multipliers[k++])) / orbit.map.period;
    spectrum.errors(j) = std::max(spectrum.errors(j), std::abs(spectrum.exponents(j) - expected));
  }
}

/// The first of them is that along the flow; there is none on a section.
const char* structural_text(const LyapunovSpectrum& spectrum, int section, Index j) {
  return section == 0 && j == spectrum.structural.front() ? "   along the flow, where it is zero"
                                                          : "   of a state that nothing depends on";
}

std::string losses(const LyapunovSpectrum& spectrum) {
  std::string text;
  const auto lost = (spectrum.exponents.array() == -std::numeric_limits<double>::infinity()).count();
  if (lost > 0)
    text += fmt::format(
        "  -infinity: {} direction{} contracted to zero, where sliding begins, or a jump or a mode drops a state.\n",
        lost, lost == 1 ? " is" : "s are");
  if (spectrum.tangential > 0)
    text += fmt::format(
        "  {} event(s) had almost no velocity: their effect on neighbouring trajectories is known to fewer digits.\n",
        spectrum.tangential);
  return text;
}

std::string ended_text(MotionEnd end) {
  if (end == MotionEnd::accumulates) return "No Lyapunov exponents: the motion ends where events accumulate.\n";
  if (end == MotionEnd::interrupted) return "No Lyapunov exponents yet.\n";
  return fmt::format("No Lyapunov exponents: the motion {}; --events or --time computes those of a part of it.\n",
                     end == MotionEnd::dies_out  ? "dies out"
                     : end == MotionEnd::escapes ? "escapes"
                                                 : "has ended");
}

/// Goes on until the bars are small enough, to the segment `last`; false when it was ended otherwise than by an event.
bool go_on(HybridSimulation& simulation, LyapunovAccumulator& exponents, double accuracy, ProgressLine& line,
           AttractorSearch& search, SimulatedSegment& last) {
  exponents.begin();
  long next_look = least_measured, done = 0;
  const auto is_enough = [&](const SimulatedSegment& segment, bool) {
    last = segment;
    exponents.pass(segment);
    if (!goes_on(segment)) return true;
    search.add(simulation, segment);
    ++done;
    if (line.is_due()) {
      const LyapunovSpectrum now = exponents.spectrum();
      line.show(fmt::format("{} events for exponents, the largest {}{}, bars up to {:.2g} ", done,
                            value_text(now.exponents(0), now.errors(0)), bar_text(now.errors(0)), now.accuracy()));
    }
    if (done < next_look) return false;
    const LyapunovSpectrum spectrum = exponents.spectrum();
    next_look += next_look / 4;
    if (done >= most_undecided && !search.unbounded(simulation.system()).empty()) return true;  // as it will
    return spectrum.accuracy() <= accuracy && (signs_of(spectrum).unclear == 0 || done >= most_undecided);
  };
  return !settle(simulation, plan_of_events(most_measured), is_enough).has_ended;
}

/// Why a positive exponent may be no chaos; "" where it is, or where there is none.
std::string doubt_of_chaos(HybridSimulation& simulation, SimulatedSegment last, LyapunovAccumulator& exponents,
                           const LyapunovSpectrum& spectrum, int section, const SimulationSettings& settings) {
  if (signs_of(spectrum).positive == 0) return "";
  if (last.ended_by == SegmentEnd::end_time) {
    last = simulation.next(std::numeric_limits<double>::max());
    exponents.pass(last);
  }
  if (last.ended_by == SegmentEnd::interrupted) return "the simulation was interrupted";
  if (last.ended_by != SegmentEnd::event) return "the motion ends";
  const double unit = section == 0 ? 1.0 : static_cast<double>(spectrum.events) / spectrum.time;
  return chaos_evidence(simulation, last.end, exponents.growing_direction(), unit * spectrum.exponents.maxCoeff(),
                        settings)
      .doubt;
}

}  // namespace

std::unique_ptr<LyapunovAccumulator> exponents_to_measure(const SimulationRequest& request, const HybridSystem& system,
                                                          const VectorXd& par) {
  if (!request.lyapunov) return nullptr;
  LyapunovSettings settings;
  settings.exponents = *request.lyapunov;
  settings.section = request.section;
  return std::make_unique<LyapunovAccumulator>(system, par, settings);
}

std::string spectrum_text(const HybridSystem& system, const LyapunovSpectrum& spectrum, int section,
                          const MotionEvidence& evidence) {
  if (!spectrum.fault.empty()) return fmt::format("No Lyapunov exponents: {}.\n", spectrum.fault);
  std::string text =
      section == 0 ? fmt::format("Lyapunov exponents per unit of time, of {} events in a time of {:.6g}\n",
                                 spectrum.events, spectrum.time)
                   : fmt::format("Lyapunov exponents per return to {}, of {} returns in a time of {:.6g}\n",
                                 system.function_name(FunctionKind::event, section), spectrum.events, spectrum.time);
  for (Index j = 0; j < spectrum.exponents.size(); ++j)
    text += fmt::format("  {:2}  {}{}{}\n", j + 1, value_text(spectrum.exponents(j), spectrum.errors(j)),
                        bar_text(spectrum.errors(j)),
                        spectrum.is_structural(j) ? structural_text(spectrum, section, j) : "");
  text += losses(spectrum);
  return text + "  " + meaning(spectrum, section, system.dimension(), evidence) + "\n";
}

std::string exponents_of(const SimulationRequest& request, const SimulationResult& result, HybridSimulation& simulation,
                         LyapunovAccumulator& exponents, AttractorSearch& search, const FoundOrbit& orbit,
                         const SimulationSettings& settings, std::ostream* progress) {
  const HybridSystem& system = simulation.system();
  const bool is_open = !request.plan.has_length();
  if (is_open && (!result.goes_on() || result.last.ended_by != SegmentEnd::event)) return ended_text(result.end);
  std::string remark;
  SimulatedSegment last = result.last;
  if (is_open) {
    ProgressLine line(progress);
    if (!go_on(simulation, exponents, request.accuracy, line, search, last))
      remark = "  The simulation has ended before the bars were small enough.\n";
  }
  LyapunovSpectrum spectrum = exponents.spectrum();
  if (search.orbit() && search.orbit()->stability == OrbitStability::stable && orbit.converged && request.section == 0)
    widen_bars(spectrum, orbit);
  if (is_open && remark.empty() && spectrum.accuracy() > request.accuracy)
    remark =
        fmt::format("  After {} events a bar is still above {:g} (--accuracy); --events or --time simulate longer.\n",
                    spectrum.events, request.accuracy);
  MotionEvidence evidence{search.orbit(), ""};
  if (!evidence.orbit) evidence.doubt = search.unbounded(system);
  const bool may_be_torus = signs_of(spectrum).positive == 0 && !keeps_volumes(spectrum, system.dimension());
  if (!evidence.orbit && evidence.doubt.empty() && may_be_torus) evidence.doubt = search.unsettled(system);
  if (!evidence.orbit && evidence.doubt.empty())
    evidence.doubt = doubt_of_chaos(simulation, last, exponents, spectrum, request.section, settings);
  return spectrum_text(system, spectrum, request.section, evidence) + remark;
}

namespace {

namespace fs = std::filesystem;

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
std::string hand_over(const SimulationRequest& request, const RunSettings& base, const HybridSystem& system,
                      const FoundOrbit& orbit, const OrbitSamples& samples, const VectorXd& par, int parameter,
                      const std::string& name) {
  RunSettings settings = orbit_settings(system, base, orbit, samples, par, parameter);
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
    if (std::abs(orbit.advance(i)) > level::orbit * std::max(orbit.sizes(i), std::abs(orbit.start(i))))
      return fmt::format("{} does not return; `tchat run` needs a problem without that state",
                         system.state_name(static_cast<int>(i) + 1));
  return "";
}

/// "" when the samples have a mesh on which the orbit can be continued with this ERRMAX; otherwise why not.
std::string unresolved(const HybridSystem& system, const OrbitSamples& samples, double error_bound) {
  const std::optional<FastPart> fast = fastest_part(samples, system.dimension());
  if (fast)
    return fmt::format(
        "segment {} is so fast where {} = {:.4g} that the times of its points have too few digits; divide it by an "
        "event that changes nothing, as at {} = {:.4g}",
        fast->segment, system.state_name(fast->state), fast->value, system.state_name(fast->state), fast->before);
  if (error_bound == 0.0 || samples.error <= error_bound) return "";
  return fmt::format(
      "NTST = {} intervals leave an error of {:.1e}, more than ERRMAX = {:g}; divide its sharp segments by events that "
      "change nothing",
      samples.intervals, samples.error, error_bound);
}

}  // namespace

namespace {

/// The turn of `result` is that of the orbit which the motion has settled on, if it has.
void take_orbit(AttractorSearch& search, const HybridSimulation& simulation, SimulationResult& result) {
  const bool is_over = result.accumulation || result.end == MotionEnd::dies_out || result.end == MotionEnd::escapes ||
                       result.end == MotionEnd::failed;
  if (is_over || result.equilibrium) return;
  if (!search.orbit() && !search.equilibrium()) search.conclude(simulation);
  if (!search.orbit()) result.equilibrium = search.equilibrium();
  if (search.orbit()) result.turn.segments = search.orbit()->turn;
}

/// Where the orbit meets this event, next to a state near it: shooting is more accurate than the search.
VectorXd end_on_orbit(const HybridSimulation& simulation, const FoundOrbit& orbit, const VectorXd& near) {
  const IndexVector& event = simulation.last_event();
  std::optional<VectorXd> best;
  const auto distance = [&](const VectorXd& x) { return length_in_sizes(x - near, orbit.sizes); };
  for (std::size_t s = 0; s < orbit.signature.size(); ++s)
    if (const VectorXd& end = orbit.map.segments[s].end;
        orbit.signature[s] == event && (!best || distance(end) < distance(*best)))
      best = end;
  if (!best) return near;
  return onto_surface(simulation.system(), event.event, no_function, *best, simulation.parameters().data(), orbit.sizes)
      .value_or(near);
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
  const bool measures_on_the_way = exponents && request.plan.has_length();
  AttractorSearch search(request.plan.max_period, request.plan.recognition, simulation_settings(request, interrupted));
  {
    ProgressLine line(progress);
    const auto keep = [&](const SimulatedSegment& segment) {
      files.write(segment);
      if (request.refine) recorded.push_back(segment);
      if (measures_on_the_way) exponents->pass(segment);
      if (line.is_due()) line.show(fmt::format("{} events, t = {:.6g} ", segment.number, segment.end_time()));
    };
    result = run_simulation(simulation, plan, keep, search);
  }
  files.finish();
  RecordedPeriod period;
  if (request.refine) {
    period = recorded_period(recorded, request.plan.events, result.turn.ignorable);
    result.turn.segments = period.segments;
  } else {
    take_orbit(search, simulation, result);
  }
  say(course_text(system, result, start.par, request.contact));

  FoundOrbit orbit;
  std::optional<VectorXd> rest;
  if (result.is_periodic()) {
    const IndexVector first =
        constants.has_signature ? constants.settings.segments.front().index : IndexVector{0, 0, 0};
    if (request.without_sections) result.turn.segments = without_sections(system, std::move(result.turn.segments));
    if (request.refine) {
      orbit = refine(system, result.turn, start.par, first, true);
      say(refined_text(orbit, static_cast<long>(result.turn.segments.size()), period.size));
    } else {
      orbit = refine(system, result.turn, start.par, first);
      if (!orbit.converged) rest = result.equilibrium;
      if (!orbit.converged)
        say(rest ? rest_text(*rest) : not_refined_text(orbit, static_cast<long>(result.turn.segments.size())));
    }
    if (orbit.converged) say(orbit_text(system, orbit));
  } else if (request.refine) {
    say(nothing_recorded_text(request.plan));
  } else if (rest = result.equilibrium; rest) {
    say(rest_text(*rest));
  } else {
    say(no_orbit_text(system, result, request.plan, search));
  }
  const bool is_attracting = orbit.converged && orbit.stability() == OrbitStability::stable;
  if (exponents && result.equilibrium && !request.plan.has_length()) {
    say("No Lyapunov exponents: the trajectory converges to an equilibrium; --events or --time computes those of a "
        "part of it.\n");
  } else if (exponents) {
    // Those of the orbit itself, not of the way to it.
    HybridSimulation measured =
        is_attracting && search.orbit()
            ? HybridSimulation(simulation, end_on_orbit(simulation, orbit, search.orbit()->end), settings)
            : simulation;
    say(exponents_of(request, result, measured, *exponents, search, orbit, settings, progress));
  }
  say(written_text(output, files));
  if (result.end == MotionEnd::failed) {
    print_failure(warnings, result.last.message);
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
  const RunSettings base = constants.is_given() ? constants.settings : default_orbit_settings(constants.settings);
  const OrbitSamples samples = sample_orbit(system, orbit, start.par, base.mesh_intervals, base.collocation_points);
  if (const std::string why = unresolved(system, samples, base.error_bound); !why.empty()) {
    warnings << fmt::format("tchat: --dat: nothing written, {}\n", why);
    return 1;
  }
  say(hand_over(request, base, system, orbit, samples, start.par, continuation_parameter(request, constants, system),
                orbit_name));
  return 0;
}

}  // namespace tchat
