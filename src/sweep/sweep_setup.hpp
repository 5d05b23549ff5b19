/// What every `tchat sweep` sets up, however its values are computed: the task, the heading, the workers' copies of the
/// problem, the summary.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "hybrid/hybrid_system.hpp"
#include "simulate/loaded_problem.hpp"
#include "sweep/sweep_grid.hpp"
#include "sweep/sweep_job.hpp"
#include "sweep/sweep_request.hpp"

namespace tchat {

/// Output, workers, part. Throws UserError.
SweepTask sweep_task(const SweepRequest& request);
/// Of --follow: the directions from each start. Throws UserError.
std::vector<Following> follow_directions(const std::string& follow);
/// Problem, swept quantities, and the parameters that are not swept.
void fill_heading(const HybridSystem& system, const std::vector<SweepTarget>& over, const Eigen::VectorXd& par,
                  SweepJob& job);
/// What the plugin was made of, wherever it stands; of a library that tchat has not compiled its bytes.
std::string plugin_identity(const std::string& path);
/// One worker, and a warning, where copies of the plugin would share their data.
void limit_workers(const LoadedProblem& loaded, SweepTask& task, std::ostream& warnings);

/// Libraries of the workers, each its own copy where there are several.
class WorkerSystems {
 public:
  /// A view of `loaded`.
  WorkerSystems(const LoadedProblem& loaded, const SimulationRequest& request, int count);

  const HybridSystem& system(int worker) const { return *systems_[static_cast<std::size_t>(worker)]; }

 private:
  std::vector<std::unique_ptr<ProblemLibrary>> copies_;
  std::vector<const HybridSystem*> systems_;
};

/// A signal to stop, asked for by the calling thread alone; workers look at what it has seen.
class StopFlag {
 public:
  explicit StopFlag(std::function<bool()> interrupted);

  const std::function<bool()>& ask() const { return ask_; }
  const std::function<bool()>& look() const { return look_; }

 private:
  std::function<bool()> ask_, look_;
};

/// Workers that each have a sampler, called with a point and the flag's look(). A view of both.
template <class Sampler>
SampleMaker maker_of(const std::vector<Sampler>& samplers, const StopFlag& stop) {
  return [&samplers, &stop](int worker) -> SampleFunction {
    return [&sampler = samplers[static_cast<std::size_t>(worker)], &stop](const SweepPoint& point) {
      return sampler(point, stop.look());
    };
  };
}

/// Runs the job and tells its outcome on the screen (when quiet only an interruption), and what the plugin complains
/// of.
void run_and_tell(const SweepJob& job, const SweepTask& task, const LoadedProblem& loaded, const StopFlag& stop,
                  std::ostream* progress, std::ostream& screen, std::ostream& warnings, bool quiet);

}  // namespace tchat
