#include "simulate/sweep_setup.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "base/number.hpp"
#include "base/text_file.hpp"
#include "base/user_error.hpp"
#include "plugin/build_stamp.hpp"

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

}  // namespace tchat
