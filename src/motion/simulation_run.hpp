/// A simulation of wanted length: what is dropped as transient, whether it settles on a periodic orbit or dies out,
/// whether events accumulate.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "motion/chattering.hpp"
#include "motion/hybrid_simulation.hpp"

namespace tchat {

/// How long, and what is looked for. Without `time` and `events`: until the motion repeats itself.
struct SimulationPlan {
  double transient_time = 0.0;  ///< segments that begin before this time are dropped
  long transient_events = 0;    ///< and so many first segments
  std::optional<double> time;   ///< after the transient
  std::optional<long> events;   ///< after the transient
  long most_events = 10000;     ///< where neither is given
  int max_period = 16;          ///< of a periodic orbit, in segments
  double recognition = 1e-6;    ///< states that are equal, relative to the range of the orbit
};

struct SimulationResult {
  long events = 0;   ///< segments that ended in an event, transient included
  long dropped = 0;  ///< of those in the transient
  long contacts = 0, violations = 0, beyond = 0, simultaneous = 0;  ///< after the transient
  SimulatedSegment last;                                            ///< the last segment, whatever ended it
  std::optional<SimulatedSegment> first_violation;                  ///< with its marks
  std::vector<SimulatedSegment> turn;   ///< the segments of one period, in order; empty when nothing was recognised
  std::vector<Eigen::Index> ignorable;  ///< states that nothing depends on, from 0
  std::optional<ChatteringDetector::Accumulation> accumulation;
  bool dies_out =
      false;  ///< the last events' h_x f is next to nothing of what it was; not looked for in a given length

  bool is_periodic() const { return !turn.empty(); }
};

/// `kept` is handed every segment after the transient. Without a wanted length the simulation ends where `has_settled`,
/// asked after each event behind the transient, says so; by itself where the motion repeats itself.
SimulationResult run_simulation(HybridSimulation& simulation, const SimulationPlan& plan,
                                const std::function<void(const SimulatedSegment&)>& kept,
                                const std::function<bool(const SimulatedSegment&)>& has_settled = {});

}  // namespace tchat
