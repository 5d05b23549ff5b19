#include "simulate/sweep_setup.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <utility>

#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "files/point_file.hpp"
#include "orbit/quantity.hpp"
#include "plugin/build_stamp.hpp"
#include "simulate/attractor_numbering.hpp"
#include "simulate/simulation_sampler.hpp"
#include "simulate/simulation_summary.hpp"

namespace tchat {

using Eigen::VectorXd;

namespace {

/// "I/N".
void read_part(const std::string& text, SweepTask& task) {
  const std::size_t slash = text.find('/');
  const auto part = slash == std::string::npos ? std::nullopt : parse_integer(text.substr(0, slash));
  const auto parts = slash == std::string::npos ? std::nullopt : parse_integer(text.substr(slash + 1));
  if (!part || !parts || *part < 1 || *part > *parts)
    throw UserError(fmt::format("--part {}: it is no part I of N, 1 <= I <= N; an example is --part 3/7", text));
  if (*parts > most_parts)
    throw UserError(
        fmt::format("--part {}: a sweep is cut into at most {} parts, and {} are given; an example is "
                    "--part 1/{}",
                    text, most_parts, *parts, most_parts));
  task.part = *part;
  task.parts = *parts;
}

/// "mu = -0.5, x1(0) = 2"
std::string place_text(const SweepJob& job, std::size_t index) {
  const VectorXd values = SweepGrid(job.heading.over).values(index);
  std::string at;
  for (std::size_t q = 0; q < job.heading.over.size(); ++q)
    at += fmt::format("{}{} = {:.6g}", q > 0 ? ", " : "", job.heading.over[q].column(),
                      values(static_cast<Eigen::Index>(q)));
  return at;
}

/// The summary on the screen.
std::string outcome_text(const SweepJob& job, const SweepOutcome& outcome) {
  std::string text;
  if (!outcome.is_complete)
    return fmt::format("Interrupted: {} of {} values are kept in {}; the same command continues.\n",
                       outcome.kept + outcome.computed, outcome.values, outcome.written);
  text = fmt::format("{} values, {} computed now\n", outcome.values, outcome.computed);
  constexpr std::size_t most_told = 20;
  for (std::size_t a = 0; a < outcome.attractors.size() && a < most_told; ++a) {
    const SweepAttractor& attractor = outcome.attractors[a];
    text += fmt::format("Attractor {}: {}", attractor.number, to_string(attractor.kind));
    if (!attractor.signature.empty()) text += ", " + attractor.signature;
    if (attractor.kind == AttractorKind::chaotic && outcome.least_events[a] > 0)
      text += fmt::format(", seen for {} events at least", outcome.least_events[a]);
    text += fmt::format(", {} times, first at {}\n", outcome.found[a], place_text(job, attractor.index));
  }
  if (outcome.attractors.size() > most_told)
    text += fmt::format("... and {} further attractors\n", outcome.attractors.size() - most_told);
  if (outcome.without > 0)
    text += fmt::format("No attractor: {} times, first at {}{}{}\n", outcome.without,
                        place_text(job, outcome.first_without), outcome.first_message.empty() ? "" : ": ",
                        outcome.first_message);
  return text + fmt::format("Written: {}\n", outcome.written);
}

/// Of --follow: the directions from each start.
std::vector<Following> follow_directions(const std::string& follow) {
  if (follow.empty()) return {Following::none};
  if (follow == "up") return {Following::up};
  if (follow == "down") return {Following::down};
  if (follow == "both") return {Following::up, Following::down};
  throw UserError(fmt::format("--follow {}: it is none of up, down, both; an example is --follow both", follow));
}

/// What the plugin was made of, wherever it stands; of a library that tchat has not compiled its bytes.
std::string plugin_identity(const std::string& path) {
  if (const std::optional<BuildStamp> stamp = read_stamp(path); stamp && !stamp->contents.empty())
    return stamp->contents;
  return hash_text(read_text_file(path, "plugin", "give the plugin with -p"));
}

void limit_workers(const LoadedProblem& loaded, SweepTask& task, std::ostream& warnings) {
  if (task.workers == 1 || task.gather || !shares_data_of_copies(loaded.plugin)) return;
  warnings << fmt::format(
      "tchat: warning: plugin {} was compiled without -fno-gnu-unique, so that copies of it would share their data: "
      "one worker computes instead of {}; give its source, or compile it with that option\n",
      loaded.plugin, task.workers);
  task.workers = 1;
}

/// Libraries of the workers, each its own copy where there are several.
class WorkerSystems {
 public:
  /// A view of `loaded`.
  WorkerSystems(const LoadedProblem& loaded, const SimulationRequest& request, int count) {
    systems_.push_back(&loaded.library->system());
    for (int worker = 1; worker < count; ++worker) {
      copies_.push_back(ProblemLibrary::copy_of(loaded.plugin, [&] { return sizes_of(request, loaded.constants); }));
      copies_.back()->add_section();
      systems_.push_back(&copies_.back()->system());
    }
  }

  const std::vector<const HybridSystem*>& all() const { return systems_; }

 private:
  std::vector<std::unique_ptr<ProblemLibrary>> copies_;
  std::vector<const HybridSystem*> systems_;
};

}  // namespace

SweepTask sweep_task(const SweepRequest& request) {
  SweepTask task;
  task.output = request.simulation.output.value_or(request.simulation.name);
  const std::string file = std::filesystem::path(task.output).filename().string();
  if (file.empty() || file == "." || file == "..")
    throw UserError(fmt::format("-o '{}' is no name for output files; an example is -o found", task.output));
  task.workers = request.workers;
  task.gather = request.gather;
  task.fresh = request.fresh;
  task.command = request.command;
  if (request.part && request.gather)
    throw UserError("--part and --gather are both given; parts are made first, and then gathered");
  if (request.part) read_part(*request.part, task);
  follow_directions(request.follow);
  return task;
}

std::vector<SweepTarget> swept_targets(const HybridSystem& system, const SweepRequest& request) {
  std::vector<SweepTarget> over = parse_overs(system, request.over);
  if (!request.follow.empty() && over.front().quantity.is_state)
    throw UserError(
        fmt::format("--follow {}: attractors are followed along a parameter, and {} is an initial state; give a "
                    "parameter as the first --over, or leave --follow out",
                    request.follow, over.front().quantity.name));
  return over;
}

void add_start(const SweepRequest& request, const VectorXd& state, SweepJob& job, const std::function<void()>& added) {
  for (const Following direction : follow_directions(request.follow)) {
    added();
    job.following.push_back(direction);
    std::string text = fmt::format("x = ({})", fmt::join(state.begin(), state.end(), ", "));
    if (direction != Following::none)
      text = fmt::format("{} from {}", direction == Following::up ? "up" : "down", text);
    job.heading.starts.push_back(std::move(text));
  }
}

void fill_heading(const LoadedProblem& loaded, const std::vector<SweepTarget>& over, const VectorXd& par,
                  SweepJob& job) {
  const HybridSystem& system = loaded.library->system();
  job.limits = RecordLimits::of(system);
  job.heading.problem = system.name();
  job.identity = {{"problem", system.name()}, {"plugin", plugin_identity(loaded.plugin)}};
  for (const SweepTarget& target : over) {
    const SweptQuantity& q = target.quantity;
    job.heading.over.push_back(q);
    job.identity.emplace_back("over", fmt::format("{}={}:{}:{}", q.column(), q.from, q.to, q.count));
  }
  for (int k = 1; k <= system.parameters(); ++k) {
    const bool is_swept = std::any_of(over.begin(), over.end(), [k](const SweepTarget& target) {
      return !target.quantity.is_state && target.position == k;
    });
    if (is_swept) continue;
    job.heading.parameters.emplace_back(system.parameter_name(k), par(k - 1));
    job.identity.emplace_back("parameter", fmt::format("{} = {}", system.parameter_name(k), par(k - 1)));
  }
  for (const std::string& start : job.heading.starts) job.identity.emplace_back("start", start);
}

void run_with_workers(SweepJob& job, SweepTask task, const SweepRequest& request, const LoadedProblem& loaded,
                      const SamplerMaker& sampler_of, const SweepConsole& console) {
  limit_workers(loaded, task, console.warnings);
  const WorkerSystems workers(loaded, request.simulation, task.gather ? 1 : task.workers);
  std::atomic<bool> is_stopped = false;
  const std::function<bool()> has_stopped = [&] { return is_stopped.load(std::memory_order_relaxed); };
  for (const HybridSystem* const system : workers.all())
    job.functions.emplace_back(
        [sampler = sampler_of(*system), &has_stopped](const SweepPoint& point) { return sampler(point, has_stopped); });
  const auto interrupted = [&] {
    if (console.interrupted()) is_stopped = true;
    return is_stopped.load();
  };
  const bool quiet = request.simulation.quiet;
  std::ostream nowhere(nullptr);
  const SweepOutcome outcome = run_sweep(job, task, interrupted, console.progress, quiet ? nowhere : console.screen);
  if (!quiet || !outcome.is_complete) console.screen << outcome_text(job, outcome) << std::flush;
  if (const std::string complaint = loaded.library->complaint(); !complaint.empty())
    console.warnings << "tchat: warning: " << complaint << '\n';
}

namespace {

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
  const std::string steps = r.steps_without_event == no_limit ? "" : fmt::format(", {} steps", r.steps_without_event);
  add("wait", fmt::format("{}{}", r.wait, steps));
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
