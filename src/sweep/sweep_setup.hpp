/// What every `tchat sweep` sets up, however its values are computed: the task, the heading, the workers' copies of the
/// problem, the summary.
#pragma once

#include <Eigen/Core>
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

/// The summary on the screen.
std::string outcome_text(const SweepJob& job, const SweepOutcome& outcome);

}  // namespace tchat
