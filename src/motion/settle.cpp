#include "motion/settle.hpp"

#include <algorithm>
#include <cmath>

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

// A motion may begin beside an unstable equilibrium, at 1e-30 or 1e-300, and settle yet: what it began with says
// nothing. Beyond this, powers of a state have no room in double precision, whatever its unit.
constexpr double no_room = 1e100;
// In sizes.
constexpr double far_away = 1e18;       // where no event comes any more, after events that have shown sizes
constexpr double far_at_failure = 1e6;  // where the integration fails there
constexpr double far_at_end = 1e3;      // where it has no event any more, and goes on outwards
constexpr long of_start = 16;           // events in which a motion shows its sizes
constexpr double at_largest = 0.99;

VectorXd extremes(const SimulatedSegment& segment) { return segment.low.cwiseAbs().cwiseMax(segment.high.cwiseAbs()); }

}  // namespace

MotionJudge::MotionJudge(const HybridSimulation& simulation, AttractorSearch& search, Settings settings)
    : search_(search), settings_(settings), sizes_(simulation.sizes()) {}

/// Sizes of different states are not told apart: a motion may begin where one of them is nothing yet.
bool MotionJudge::is_beyond(const VectorXd& x, double sizes) const {
  VectorXd counted = sizes_, here = x;
  for (const Index k : search_.ignorable()) counted(k) = here(k) = 0.0;
  const double largest = counted.maxCoeff();
  return largest > 0.0 && !(here.cwiseAbs().maxCoeff() <= sizes * largest);
}

/// Is the largest state larger than before, and still growing?
bool MotionJudge::is_leaving(const HybridSimulation& simulation, const SimulatedSegment& segment) const {
  if (!is_beyond(segment.end, far_at_end)) return false;
  VectorXd x = segment.end, f(segment.end.size());
  simulation.system().value(FunctionKind::field, segment.mode.field(), x.data(), simulation.parameters().data(),
                            f.data());
  for (const Index k : search_.ignorable()) x(k) = 0.0;
  Index i = 0;
  const double largest = x.cwiseAbs().maxCoeff(&i);
  return largest >= at_largest * extremes(segment)(i) && !(x(i) * f(i) <= 0.0);
}

MotionEnd MotionJudge::end_of(const HybridSimulation& simulation, const SimulatedSegment& segment) {
  switch (segment.ended_by) {
    case SegmentEnd::event:
    case SegmentEnd::end_time:
      return MotionEnd::open;
    case SegmentEnd::interrupted:
      return MotionEnd::interrupted;
    case SegmentEnd::sticks:
      return MotionEnd::accumulates;
    case SegmentEnd::failed:
      return is_beyond(extremes(segment), far_at_failure) ? MotionEnd::escapes : MotionEnd::failed;
    case SegmentEnd::no_event:
      break;
  }
  equilibrium_ = reached_equilibrium(simulation.system(), segment, simulation.parameters(), search_.ignorable(),
                                     simulation.sizes());
  if (equilibrium_) return MotionEnd::settled;
  const bool is_far = events_ >= of_start && is_beyond(extremes(segment), far_away);
  return is_far || is_leaving(simulation, segment) ? MotionEnd::escapes : MotionEnd::no_event;
}

MotionEnd MotionJudge::look(const HybridSimulation& simulation, const SimulatedSegment& segment, bool is_transient) {
  if (!goes_on(segment)) return end_of(simulation, segment);
  if (events_++ < of_start) sizes_ = simulation.sizes();
  chattering_.add(segment.index, segment.duration, simulation.time_uncertainty(segment),
                  simulation.system().chatter_of_impact(segment.index) != nullptr);
  decay_.add(segment.index, segment.event_velocity);
  accumulation_ = chattering_.accumulation();
  if (accumulation_) return MotionEnd::accumulates;
  if (settings_.may_stop && decay_.dies_out()) return MotionEnd::dies_out;
  if (is_transient && !settings_.judges_transient) return MotionEnd::open;
  if (!settings_.may_stop) {
    search_.add(simulation, segment);
    return MotionEnd::open;
  }
  if (search_.has_settled(simulation, segment)) {
    equilibrium_ = search_.equilibrium();
    return MotionEnd::settled;
  }
  VectorXd here = extremes(segment);
  for (const Index k : search_.ignorable()) here(k) = 0.0;
  return here.maxCoeff() <= no_room ? MotionEnd::open : MotionEnd::escapes;
}

namespace {

void count_marks(const SimulatedSegment& segment, SimulationResult& result) {
  for (const SegmentMark& mark : segment.marks) {
    if (mark.kind == SegmentMark::Kind::contact) ++result.contacts;
    if (mark.kind == SegmentMark::Kind::beyond) ++result.beyond;
    if (mark.kind == SegmentMark::Kind::violation && result.violations++ == 0) result.first_violation = segment;
  }
  result.simultaneous += segment.simultaneous.empty() ? 0 : 1;
}

void count_missed(const HybridSimulation& simulation, const SimulatedSegment& segment, SimulationResult& result) {
  for (const int event : missed_events(simulation.system(), segment, simulation.parameters())) {
    MissedEvent& missed = result.missed[event];
    if (missed.count++ == 0) missed.first = segment.number;
  }
}

}  // namespace

std::vector<int> missed_events(const HybridSystem& system, const SimulatedSegment& segment, const VectorXd& par) {
  std::vector<int> missed;
  for (const int event : segment.mode.terminal_events())
    if (event != segment.index.event && system.event(event, segment.start.data(), par.data()) <= 0.0 &&
        system.event(event, segment.end.data(), par.data()) < 0.0)
      missed.push_back(event);
  return missed;
}

SimulationResult run_simulation(HybridSimulation& simulation, const SimulationPlan& plan,
                                const std::function<void(const SimulatedSegment&)>& kept, AttractorSearch& search) {
  SimulationResult result;
  MotionJudge judge(simulation, search, {!plan.has_length(), false});
  SeriesCounter series;
  double since_impact = 0.0;  // sections may lie between impacts
  const Course course = settle(simulation, plan, [&](const SimulatedSegment& segment, bool is_transient) {
    if (!is_transient) {
      kept(segment);
      count_marks(segment, result);
      count_missed(simulation, segment, result);
    }
    const HybridSystem& system = simulation.system();
    since_impact += segment.duration;
    if (segment.ended_by == SegmentEnd::event && (system.chatter_of_impact(segment.index) != nullptr ||
                                                  system.chatter_with_limit(segment.index.jump) != nullptr))
      series.add(segment.index, std::exchange(since_impact, 0.0));
    result.last = segment;
    result.end = judge.look(simulation, segment, is_transient);
    return result.end != MotionEnd::open;
  });
  result.events = course.events;
  result.dropped = course.dropped;
  result.broken_series = series.broken();
  result.accumulation = judge.accumulation();
  result.equilibrium = judge.equilibrium();
  result.turn.ignorable = search.ignorable();
  return result;
}

}  // namespace tchat
