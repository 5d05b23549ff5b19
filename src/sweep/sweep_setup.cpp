#include "sweep/sweep_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <optional>
#include <utility>

#include "plugin/build_stamp.hpp"
#include "text/number.hpp"
#include "text/text_file.hpp"
#include "text/user_error.hpp"

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
    return fmt::format("Interrupted: {} of {} values are kept in {}; the same command goes on.\n",
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

}  // namespace

std::vector<Following> follow_directions(const std::string& follow) {
  if (follow.empty()) return {Following::none};
  if (follow == "up") return {Following::up};
  if (follow == "down") return {Following::down};
  if (follow == "both") return {Following::up, Following::down};
  throw UserError(fmt::format("--follow {}: it is none of up, down, both; an example is --follow both", follow));
}

void fill_heading(const HybridSystem& system, const std::vector<SweepTarget>& over, const VectorXd& par,
                  SweepJob& job) {
  job.heading.problem = system.name();
  job.limits = RecordLimits::of(system);
  for (const SweepTarget& target : over) job.heading.over.push_back(target.quantity);
  for (int k = 1; k <= system.parameters(); ++k) {
    const bool is_swept = std::any_of(over.begin(), over.end(), [k](const SweepTarget& target) {
      return !target.quantity.is_state && target.position == k;
    });
    if (!is_swept) job.heading.parameters.emplace_back(system.parameter_name(k), par(k - 1));
  }
}

std::string plugin_identity(const std::string& path) {
  if (const std::optional<BuildStamp> stamp = read_stamp(path); stamp && !stamp->contents.empty())
    return stamp->contents;
  return hash_text(read_text_file(path, "plugin", "give the plugin with -p"));
}

void limit_workers(const LoadedProblem& loaded, SweepTask& task, std::ostream& warnings) {
  if (task.workers > 1 && !task.gather && shares_data_of_copies(loaded.plugin)) {
    warnings << fmt::format(
        "tchat: warning: plugin {} was compiled without -fno-gnu-unique, so that copies of it would share their data: "
        "one worker computes instead of {}; give its source, or compile it with that option\n",
        loaded.plugin, task.workers);
    task.workers = 1;
  }
}

WorkerSystems::WorkerSystems(const LoadedProblem& loaded, const SimulationRequest& request, int count) {
  systems_.push_back(&loaded.library->system());
  for (int worker = 1; worker < count; ++worker) {
    copies_.push_back(ProblemLibrary::copy_of(loaded.plugin, [&] { return sizes_of(request, loaded.constants); }));
    systems_.push_back(&copies_.back()->system());
  }
}

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
  return task;
}

StopFlag::StopFlag(std::function<bool()> interrupted) {
  const auto is_stopped = std::make_shared<std::atomic<bool>>(false);
  ask_ = [interrupted = std::move(interrupted), is_stopped] {
    if (interrupted()) *is_stopped = true;
    return is_stopped->load();
  };
  look_ = [is_stopped] { return is_stopped->load(std::memory_order_relaxed); };
}

void run_and_tell(const SweepJob& job, const SweepTask& task, const LoadedProblem& loaded, const StopFlag& stop,
                  std::ostream* progress, std::ostream& screen, std::ostream& warnings, bool quiet) {
  std::ostream nowhere(nullptr);
  const SweepOutcome outcome = run_sweep(job, task, stop.ask(), progress, quiet ? nowhere : screen);
  if (!quiet || !outcome.is_complete) screen << outcome_text(job, outcome) << std::flush;
  if (const std::string complaint = loaded.library->complaint(); !complaint.empty())
    warnings << "tchat: warning: " << complaint << '\n';
}

}  // namespace tchat
