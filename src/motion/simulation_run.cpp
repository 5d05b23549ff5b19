#include "motion/simulation_run.hpp"

#include <deque>
#include <limits>

#include "motion/decay.hpp"
#include "motion/recurrence.hpp"

namespace tchat {

namespace {

constexpr double never = 1e300;
constexpr std::size_t points_for_ignorable = 6;

/// Gathers what a simulation shows after its transient.
class Observation {
 public:
  Observation(const HybridSimulation& simulation, const SimulationPlan& plan, SimulationResult& result)
      : simulation_(simulation), plan_(plan), result_(result), recurrence_(plan.max_period, plan.recognition) {}

  void add(const SimulatedSegment& segment) {
    count_marks(segment);
    if (segment.ended_by != SegmentEnd::event) return;
    result_.simultaneous += segment.simultaneous.empty() ? 0 : 1;
    if (points_.size() < points_for_ignorable) find_ignorable(segment);
    recurrence_.add(segment);
    turn_.push_back(segment);
    if (turn_.size() > static_cast<std::size_t>(plan_.max_period)) turn_.pop_front();
  }

  bool repeats() const { return recurrence_.period().has_value(); }

  void finish() {
    const auto period = recurrence_.period();
    if (result_.last.ended_by == SegmentEnd::failed || !period) return;
    result_.turn.assign(turn_.end() - *period, turn_.end());
  }

 private:
  void count_marks(const SimulatedSegment& segment) {
    for (const SegmentMark& mark : segment.marks) {
      if (mark.kind == SegmentMark::Kind::contact) ++result_.contacts;
      if (mark.kind == SegmentMark::Kind::beyond) ++result_.beyond;
      if (mark.kind == SegmentMark::Kind::violation && result_.violations++ == 0) result_.first_violation = segment;
    }
  }

  void find_ignorable(const SimulatedSegment& segment) {
    points_.push_back(segment.start);
    points_.push_back(segment.end);
    const std::vector<bool> flags = ignorable_states(simulation_.system(), points_, simulation_.parameters());
    recurrence_.ignore(flags);
    result_.ignorable.clear();
    for (std::size_t i = 0; i < flags.size(); ++i)
      if (flags[i]) result_.ignorable.push_back(static_cast<Eigen::Index>(i));
  }

  const HybridSimulation& simulation_;
  const SimulationPlan& plan_;
  SimulationResult& result_;
  Recurrence recurrence_;
  std::deque<SimulatedSegment> turn_;    // the last max_period
  std::vector<Eigen::VectorXd> points_;  // where functions were looked at
};

}  // namespace

SimulationResult run_simulation(HybridSimulation& simulation, const SimulationPlan& plan,
                                const std::function<void(const SimulatedSegment&)>& kept,
                                const std::function<bool(const SimulatedSegment&)>& has_settled) {
  SimulationResult result;
  Observation observation(simulation, plan, result);
  ChatteringDetector chattering;
  DecayDetector decay;
  const bool until_it_repeats = !plan.time && !plan.events;
  const long most = plan.events.value_or(until_it_repeats ? plan.most_events : std::numeric_limits<long>::max());
  std::optional<double> end_time;
  while (true) {
    const bool is_transient = result.events < plan.transient_events || simulation.time() < plan.transient_time;
    if (!is_transient && result.events - result.dropped >= most) break;
    if (!is_transient && !end_time) end_time = plan.time ? simulation.time() + *plan.time : never;
    result.last = simulation.next(end_time.value_or(never));
    if (!is_transient) {
      kept(result.last);
      observation.add(result.last);
    }
    if (result.last.ended_by != SegmentEnd::event) break;
    ++result.events;
    if (is_transient) ++result.dropped;
    chattering.add(result.last.index, result.last.duration);
    result.accumulation = chattering.accumulation();
    decay.add(result.last.index, result.last.event_velocity);
    result.dies_out = until_it_repeats && decay.dies_out();
    if (result.accumulation || result.dies_out) break;
    if (until_it_repeats && !is_transient && (has_settled ? has_settled(result.last) : observation.repeats())) break;
  }
  if (!result.accumulation && !result.dies_out) observation.finish();
  return result;
}

}  // namespace tchat
