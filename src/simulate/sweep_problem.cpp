#include "simulate/sweep_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "base/number.hpp"
#include "base/user_error.hpp"
#include "files/point_file.hpp"
#include "orbit/quantity.hpp"
#include "simulate/attractor_numbering.hpp"
#include "simulate/loaded_problem.hpp"
#include "simulate/simulation_rule.hpp"
#include "simulate/simulation_sampler.hpp"
#include "simulate/simulation_start.hpp"
#include "simulate/start_notice.hpp"
#include "simulate/sweep_job.hpp"
#include "simulate/sweep_setup.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;

constexpr std::size_t fewest_for_capture = 400;  // values; below that looking for attractors first costs more
constexpr std::size_t share_of_first = 50;       // one value in so many
constexpr std::size_t most_first = 200;

/// An event function by its number or its name.
int event_index(const HybridSystem& system, const std::string& text, const char* option) {
  const int count = system.count(FunctionKind::event);
  std::string list;
  for (int j = 1; j <= count; ++j) {
    const std::string name = system.function_name(FunctionKind::event, j);
    if (text == name || parse_integer(text) == j) return j;
    list += fmt::format("{}{} ({})", j > 1 ? ", " : "", j, name);
  }
  throw UserError(fmt::format("{} {}: {} has no such event function; it has {}", option, text, system.name(), list));
}

Recording read_recording(const SweepRequest& request, const HybridSystem& system,
                         const std::vector<SweepTarget>& over) {
  Recording recording;
  if (request.penetration) recording.penetration = event_index(system, *request.penetration, "--penetration");
  const bool is_diagram = over.size() == 1 && !over.front().quantity.is_state;
  if (!request.section) {
    if (is_diagram)
      recording.states = recording.penetration > 0 ? Recording::States::contact : Recording::States::all_events;
  } else if (*request.section == "all") {
    recording.states = Recording::States::all_events;
  } else if (*request.section != "none") {
    recording.states = Recording::States::section;
    recording.section = event_index(system, *request.section, "--section");
  }
  if (request.exponents) {
    const int n = system.dimension();
    if (*request.exponents > n)
      throw UserError(fmt::format("--lyapunov {}: {} has {} states, and so many exponents; give 1 to {}",
                                  *request.exponents, system.name(), n, n));
    recording.exponents = *request.exponents > 0 ? *request.exponents : n;
  }
  recording.largest = request.largest;
  return recording;
}

/// States, each with the directions from it.
void add_starts(const SweepRequest& request, const LoadedProblem& loaded, SamplerSetup& setup, SweepJob& job) {
  const HybridSystem& system = loaded.library->system();
  std::vector<std::optional<std::string>> states(request.states.begin(), request.states.end());
  if (states.empty()) states.emplace_back();
  for (const std::optional<std::string>& state : states) {
    SimulationRequest own = setup.request;
    own.state = state;
    const SimulationStart start = simulation_start(own, setup.constants, system);
    setup.par = start.par.matrix();
    if (!start.watched.empty()) setup.request.modes = modes_text(start.watched);
    add_start(request, start.state, job, [&] {
      setup.starts.push_back(start.state);
      setup.sides.push_back(start.side);
    });
  }
}

void choose_columns(const HybridSystem& system, const Recording& recording, SweepColumns& columns) {
  columns.event = recording.states == Recording::States::all_events;
  columns.penetration = recording.penetration > 0;
  columns.exponents = recording.exponents;
  for (int k = 1; k <= system.dimension() && recording.largest; ++k)
    columns.largest.push_back(state_in_monitor(system, k));
  if (recording.states != Recording::States::none) columns.states = ProblemNames::of(system).states;
}

std::string recorded_text(const Recording& recording) {
  switch (recording.states) {
    case Recording::States::all_events:
      return "at all events";
    case Recording::States::section:
      return fmt::format("at event function {}{}", recording.section,
                         recording.has_incoming_states() ? ", of the flow that comes in" : "");
    case Recording::States::contact:
      return fmt::format("where event function {} is least", recording.penetration);
    default:
      return "none";
  }
}

/// What the results of simulations depend on beside what every sweep does.
void add_identity(const HybridSystem& system, const SamplerSetup& setup, bool captures, SweepIdentity& identity) {
  const SimulationRequest& r = setup.request;
  const SimulationPlan& plan = r.plan;
  const auto add = [&](const char* key, std::string value) { identity.emplace_back(key, std::move(value)); };
  std::string rule = r.modes.value_or("");
  const bool by_signature = r.signature || r.follow_signature || !system.has_successors();
  if (by_signature && setup.constants.has_signature) rule += " " + to_string(setup.constants.settings.signature());
  add("modes", rule.empty() ? "of the problem" : rule);
  for (const StartSide& side : setup.sides)
    if (side.given != StartSide::Given::nothing)
      add("side", fmt::format("{} {}", side.given == StartSide::Given::after ? "after" : "before", side.event));
  add("tolerance", fmt::format("{}", r.tolerance));
  add("method", r.stiff ? "stiff" : "explicit");
  add("wait", fmt::format("{}", r.wait));
  add("transient", fmt::format("{} events, time {}", plan.transient_events, plan.transient_time));
  add("length", plan.time ? fmt::format("time {}", *plan.time) : fmt::format("{} events", plan.events.value_or(0)));
  add("period", fmt::format("at most {} events, recognised to {}", plan.max_period, plan.recognition));
  add("states", recorded_text(setup.recording));
  add("penetration", fmt::format("{}", setup.recording.penetration));
  add("exponents", fmt::format("{}", setup.recording.exponents));
  if (setup.recording.largest) add("largest", "values of states");
  add("capture", captures ? "yes" : "no");
}

/// What is to be said of the values that begin at a given start: all of them, or the first of each chain of neighbours.
std::string start_warnings(const SamplerSetup& setup, const HybridSystem& system, const SweepJob& job) {
  const SweepGrid grid(job.heading.over);
  std::vector<StartNotice> notices;
  std::size_t starts = 0;
  for (std::size_t s = 0; s < setup.starts.size(); ++s) {
    const Following direction = job.following[s];
    const std::size_t stride = direction == Following::none ? 1 : grid.chain_length();
    for (std::size_t i = direction == Following::down ? stride - 1 : 0; i < grid.size(); i += stride) {
      const SampleStart start = sample_start(setup, {i, grid.values(i), static_cast<int>(s) + 1, {}});
      SimulationSettings settings;
      settings.side = start.side;
      const HybridSimulation simulation(simulation_rule(setup.request, setup.constants, system, start.state, start.par),
                                        start.state, start.par, settings);
      const std::vector<StartNotice> own = start_notices(simulation);
      notices.insert(notices.end(), own.begin(), own.end());
      ++starts;
    }
  }
  return notice_summary(system, notices, starts);
}

/// Regions of the attractors that the first values have found. Who comes to which is decided by the sampler itself.
std::vector<CaptureRegion> capture_regions(const SamplerSetup& setup, const HybridSystem& system,
                                           const std::vector<AttractorSample>& known,
                                           const std::function<bool()>& interrupted) {
  SamplerSetup plain = setup;
  plain.known.clear();
  plain.over.clear();
  plain.recording = {};
  const SimulationSampler sampler(plain, system);
  std::vector<CaptureRegion> regions;
  for (const AttractorSample& sample : known)
    regions.push_back(capture_region(system, sample, setup.par, [&](const MotionState& at) {
      return is_same_attractor(sample, sampler({0, {}, 1, at}, interrupted));
    }));
  return regions;
}

}  // namespace

int sweep_problem(const SweepRequest& request, const SweepConsole& console) {
  const SweepTask task = sweep_task(request);
  const LoadedProblem loaded = load_for_simulation(request.simulation, console.progress);
  const HybridSystem& system = loaded.library->system();
  SamplerSetup setup;
  setup.request = request.simulation;
  setup.constants = loaded.constants;
  setup.over = swept_targets(system, request);
  setup.follows = !request.follow.empty();
  setup.recording = read_recording(request, system, setup.over);
  SweepJob job;
  add_starts(request, loaded, setup, job);
  fill_heading(loaded, setup.over, setup.par, job);
  choose_columns(system, setup.recording, job.columns);

  const std::size_t values = SweepGrid(job.heading.over).size();
  const bool is_basin = std::all_of(setup.over.begin(), setup.over.end(),
                                    [](const SweepTarget& target) { return target.quantity.is_state; });
  const bool captures = is_basin && values >= fewest_for_capture && !request.to_the_end;
  if (captures) job.first_values = std::min(most_first, values / share_of_first);
  add_identity(system, setup, captures, job.identity);
  job.learn = [&](const std::vector<AttractorSample>& known, const std::function<bool()>& is_stopped) {
    setup.known = capture_regions(setup, system, known, is_stopped);
  };
  run_with_workers(
      job, task, request, loaded, [&](const HybridSystem& own) { return SimulationSampler(setup, own); }, console);
  // Not before: a plugin that dies at some value must leave what is computed up to there.
  if (!task.gather) console.warnings << start_warnings(setup, system, job);
  return 0;
}

}  // namespace tchat
