/// Going on with a motion until it has settled, has ended or has been long enough: the loop and the judge of all
/// commands that simulate or iterate.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "motion/attractor_search.hpp"
#include "motion/hybrid_simulation.hpp"
#include "motion/recurrence.hpp"

namespace tchat {

/// How long, and what is looked for. Without `time` and `events`: until the motion has settled, `most_events` at most.
struct SimulationPlan {
  double transient_time = 0.0;          ///< segments that begin before this time are dropped
  long transient_events = 0;            ///< and so many first segments
  std::optional<double> time;           ///< after the transient
  std::optional<long> events;           ///< after the transient
  long most_events = 10000;             ///< where neither is given
  int max_period = 16;                  ///< of a periodic orbit, in segments
  double recognition = level::located;  ///< states that are equal, relative to the range of the orbit

  bool has_length() const { return time || events; }
};

/// So many events, without a transient.
inline SimulationPlan plan_of_events(long events) {
  SimulationPlan plan;
  plan.events = events;
  return plan;
}

inline bool goes_on(const SimulatedSegment& segment) { return segment.ended_by == SegmentEnd::event; }

/// Why settle() has come back.
struct Course {
  long events = 0;          ///< parts that go on, transient included
  long dropped = 0;         ///< of those in the transient
  bool is_stopped = false;  ///< by the watch
  bool has_ended = false;   ///< there is nothing to go on with: the last part does not go on
};

/// The one loop that goes on with a motion, a simulation or an iterated map. `motion.next(end_time)` makes its next
/// part, of which goes_on(part) says whether another one may follow, and `motion.time()` is where it stands.
/// `watch(part, is_transient)` is asked after every part, the last one too; true stops.
template <class Motion, class Watch>
Course settle(Motion& motion, const SimulationPlan& plan, Watch&& watch) {
  const long most = plan.events.value_or(plan.time ? std::numeric_limits<long>::max() : plan.most_events);
  double end_time = std::numeric_limits<double>::max();
  bool has_begun = false;  // what is wanted, after the transient
  Course course;
  while (true) {
    const bool is_transient = course.events < plan.transient_events || motion.time() < plan.transient_time;
    if (!is_transient && course.events - course.dropped >= most) return course;
    if (!is_transient && !has_begun && plan.time) end_time = motion.time() + *plan.time;
    has_begun = !is_transient;
    const auto part = motion.next(end_time);
    course.has_ended = !goes_on(part);
    if (!course.has_ended) ++course.events;
    if (!course.has_ended && is_transient) ++course.dropped;
    course.is_stopped = watch(part, is_transient);
    if (course.is_stopped || course.has_ended) return course;
  }
}

// What a simulated motion comes to, asked after each of its segments.

enum class MotionEnd {
  open,         ///< it goes on, or has been long enough
  settled,      ///< the search has its orbit or its equilibrium
  accumulates,  ///< events accumulate, or the contact lasts
  dies_out,     ///< the last events' h_x f is next to nothing of what it was
  escapes,      ///< a state is far beyond all sizes that the motion had
  no_event,     ///< none for so long as is waited, and no equilibrium is there
  failed,
  interrupted,
};

class MotionJudge {
 public:
  struct Settings {
    bool may_stop = true;           ///< false: it is watched for a given length; only what ends it ends it
    bool judges_transient = false;  ///< whether it has settled is asked in the transient, too
  };
  /// `simulation` stands at its start. `search` outlives this object.
  MotionJudge(const HybridSimulation& simulation, AttractorSearch& search, Settings settings);

  /// The next segment.
  MotionEnd look(const HybridSimulation& simulation, const SimulatedSegment& segment, bool is_transient);

  const std::optional<ChatteringDetector::Accumulation>& accumulation() const { return accumulation_; }
  /// After look() has said `settled`: the equilibrium, or nothing where it is an orbit.
  const std::optional<Eigen::VectorXd>& equilibrium() const { return equilibrium_; }

 private:
  MotionEnd end_of(const HybridSimulation& simulation, const SimulatedSegment& segment);
  bool is_beyond(const Eigen::VectorXd& x, double sizes) const;
  bool is_leaving(const HybridSimulation& simulation, const SimulatedSegment& segment) const;

  AttractorSearch& search_;
  Settings settings_;
  ChatteringDetector chattering_;
  DecayDetector decay_;
  Eigen::VectorXd sizes_;  // of the states, in the first events
  long events_ = 0;
  std::optional<ChatteringDetector::Accumulation> accumulation_;
  std::optional<Eigen::VectorXd> equilibrium_;
};

/// Watched events that a segment cannot meet, as they can be met only after they have been positive: they are not at
/// its begin, and negative at its end.
std::vector<int> missed_events(const HybridSystem& system, const SimulatedSegment& segment, const Eigen::VectorXd& par);

/// Segments that have missed an event.
struct MissedEvent {
  long first = 0;  ///< number of the first of these segments
  long count = 0;
};

struct SimulationResult {
  long events = 0;   ///< segments that ended in an event, transient included
  long dropped = 0;  ///< of those in the transient
  long contacts = 0, violations = 0, beyond = 0, simultaneous = 0;  ///< after the transient
  SimulatedSegment last;                                            ///< the last segment, whatever ended it
  std::optional<SimulatedSegment> first_violation;                  ///< with its marks
  std::map<int, MissedEvent> missed;                                ///< by event, after the transient
  std::map<IndexVector, BrokenSeries> broken_series;                ///< by what ends each of their segments
  MotionEnd end = MotionEnd::open;
  std::optional<ChatteringDetector::Accumulation> accumulation;
  std::optional<Eigen::VectorXd> equilibrium;  ///< that the motion comes to
  Turn turn;                                   ///< of whoever has looked for it

  bool is_periodic() const { return !turn.segments.empty(); }
  /// The motion is not over: it may be gone on with, or has settled.
  bool goes_on() const { return end == MotionEnd::open || end == MotionEnd::settled; }
};

/// `kept` is handed every segment after the transient. Without a wanted length the simulation stops where `search` says
/// that the motion has settled.
SimulationResult run_simulation(HybridSimulation& simulation, const SimulationPlan& plan,
                                const std::function<void(const SimulatedSegment&)>& kept, AttractorSearch& search);

}  // namespace tchat
