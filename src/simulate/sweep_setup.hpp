/// The command `tchat sweep` without its command line: the setup of all sweeps, and sweeps by simulation.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "simulate/simulation_start.hpp"
#include "simulate/sweep_file.hpp"
#include "simulate/sweep_job.hpp"

namespace tchat {

// One `tchat sweep`: what the command line says, before any file is read.

struct SweepRequest {
  SimulationRequest simulation;  ///< `state` is not used: `states`
  std::vector<std::string> over;
  std::vector<std::string> states;         ///< --state, several; empty: that of the problem, of -d or -s
  std::string follow;                      ///< "", "up", "down" or "both"
  std::optional<std::string> section;      ///< an event function's number or name, "all" or "none"
  std::optional<std::string> penetration;  ///< an event function's number or name
  std::optional<int> exponents;            ///< --lyapunov: how many, 0 all
  bool largest = false;                    ///< --max
  bool to_the_end = false;                 ///< nothing is captured

  int workers = 1;
  std::optional<std::string> part;  ///< "I/N"
  bool gather = false;
  bool fresh = false;
  std::string command;  ///< the command line as given, without --part I/N and --gather
};

// What every `tchat sweep` sets up, however its values are computed: the task, the starts, the heading, the workers'
// copies of the problem, the summary.

/// Output, workers, part; also checks --follow. Throws UserError.
SweepTask sweep_task(const SweepRequest& request);
/// The quantities of --over, the first of which is a parameter where attractors are followed. Throws UserError.
std::vector<SweepTarget> swept_targets(const HybridSystem& system, const SweepRequest& request);
/// Adds this start in each direction of --follow to the job, and calls `added` for each.
void add_start(const SweepRequest& request, const Eigen::VectorXd& state, SweepJob& job,
               const std::function<void()>& added);
/// Problem, swept quantities, the parameters that are not swept, limits; and of the identity what every sweep depends
/// on. Call it when the starts are known.
void fill_heading(const LoadedProblem& loaded, const std::vector<SweepTarget>& over, const Eigen::VectorXd& par,
                  SweepJob& job);

/// Computes values for one worker; asks now and then whether it has been interrupted, and then throws
/// SampleInterrupted.
using Sampler = std::function<AttractorSample(const SweepPoint&, const std::function<bool()>& interrupted)>;
/// Makes a worker's sampler, with a copy of the problem that no other worker calls.
using SamplerMaker = std::function<Sampler(const HybridSystem&)>;

/// The streams of a command, and a signal to stop, which only the calling thread asks for.
struct SweepConsole {
  std::ostream& screen;
  std::ostream& warnings;
  std::function<bool()> interrupted;
  std::ostream* progress;  ///< may be null
};

/// Runs the job by as many workers as the task says, and prints a summary (when quiet only of an interruption) and what
/// the plugin complains of. One worker, and a warning, where copies of the plugin would share their data.
void run_with_workers(SweepJob& job, SweepTask task, const SweepRequest& request, const LoadedProblem& loaded,
                      const SamplerMaker& sampler_of, const SweepConsole& console);

// `tchat sweep` by simulation, without the command line: constants, plugin, starts -> job -> O.sweep.

/// Prints a summary to the screen (nothing when quiet). Returns 0, also when it was interrupted, which the summary
/// says. Throws UserError for what is wrong with the input, ComputationError when files cannot be written.
int sweep_problem(const SweepRequest& request, const SweepConsole& console);

}  // namespace tchat
