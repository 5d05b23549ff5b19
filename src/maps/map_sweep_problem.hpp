/// The command `tchat sweep --map`: attractors of a composite map for each value of a parameter.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "maps/composite_map.hpp"
#include "maps/map_model.hpp"
#include "simulate/sample_record.hpp"
#include "simulate/sweep_file.hpp"
#include "simulate/sweep_setup.hpp"

namespace tchat {

// A value of a sweep by iterating a map.

/// The same for all values and workers.
struct MapSamplerSetup {
  std::vector<SweepTarget> over;
  std::vector<Eigen::VectorXd> starts;  ///< of start 1, 2, ...
  MapIteration iteration;               ///< without `interrupted`
};

/// One for each worker, with its own map. `setup` and `model` outlive it.
class MapSampler {
 public:
  MapSampler(const MapSamplerSetup& setup, const MapModel& model, std::shared_ptr<const IteratedMap> map)
      : setup_(setup), model_(model), map_(std::move(map)) {}

  /// Throws SampleInterrupted when `interrupted` says so.
  AttractorSample operator()(const SweepPoint& point, const std::function<bool()>& interrupted) const;

 private:
  const MapSamplerSetup& setup_;
  const MapModel& model_;
  std::shared_ptr<const IteratedMap> map_;
};

// `tchat sweep --map` without the command line: grazing orbit or torus -> composite map -> job -> O.sweep.

/// As sweep_problem(): the same files, parts, workers and summary. Throws UserError, also for options of simulations
/// that a map has no use for, and ComputationError.
int map_sweep_problem(const SweepRequest& request, const MapRequest& map, const SweepConsole& console);

}  // namespace tchat
