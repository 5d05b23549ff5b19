/// What every `tchat sweep` sets up, however its values are computed: the task, the starts, the heading, the workers'
/// copies of the problem, the summary.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "simulate/loaded_problem.hpp"
#include "simulate/sweep_grid.hpp"
#include "simulate/sweep_job.hpp"
#include "simulate/sweep_request.hpp"

namespace tchat {

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

}  // namespace tchat
