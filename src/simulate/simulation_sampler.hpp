/// A value of a sweep by simulation: from a start to the attractor, and what is recorded of that.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "plugin/problem_library.hpp"
#include "simulate/capture.hpp"
#include "simulate/sample_record.hpp"
#include "simulate/simulation_start.hpp"
#include "simulate/sweep_file.hpp"

namespace tchat {

/// What of an attractor is recorded.
struct Recording {
  enum class States {
    none,
    all_events,  ///< where events end segments, before their jumps
    /// Where the event function `section` falls through zero, before the jump if it ends the segment; with
    /// `penetration`, of the flow that comes in (simulate/recorded_states.hpp)
    section,
    /// On P, where `penetration` is least along the smooth flow that comes in (h_x f = 0): an impact there is taken
    /// account of only afterwards (2.64)
    contact,
  } states = States::none;
  int section = 0;       ///< event function
  int penetration = 0;   ///< event function whose least value is wanted; 0 none
  int exponents = 0;     ///< 0: none
  bool largest = false;  ///< AttractorSample::largest

  /// On the wall itself there is nothing to follow.
  bool has_incoming_states() const { return states == States::section && penetration > 0 && penetration != section; }
};

/// The same for all values and workers; changed by nobody while they work.
struct SamplerSetup {
  SimulationRequest request;
  SimulationConstants constants;
  std::vector<SweepTarget> over;
  std::vector<Eigen::VectorXd> starts;  ///< states, of start 1, 2, ...
  std::vector<StartSide> sides;         ///< of events on whose surface they lie
  Eigen::VectorXd par;                  ///< with the room of the layout
  Recording recording;
  bool follows = false;
  std::vector<CaptureRegion> known;  ///< of the known attractors 1, 2, ...; empty: nothing is captured
};

/// Where the simulation of a value begins.
struct SampleStart {
  Eigen::VectorXd state, par;
  StartSide side;
};
SampleStart sample_start(const SamplerSetup& setup, const SweepPoint& point);

/// One for each worker. `setup` and `system` outlive it; the system is the worker's own.
class SimulationSampler {
 public:
  SimulationSampler(const SamplerSetup& setup, const HybridSystem& system) : setup_(setup), system_(system) {}

  /// Throws SampleInterrupted when `interrupted` says so.
  AttractorSample operator()(const SweepPoint& point, const std::function<bool()>& interrupted) const;

 private:
  const SamplerSetup& setup_;
  const HybridSystem& system_;
};

}  // namespace tchat
