/// A hybrid system run forward in time: which events it watches, how it starts on an event surface, and its segments.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/levels.hpp"
#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "motion/watched_flow.hpp"

namespace tchat {

// What a simulation watches next: the set of index vectors of the current segment, all with the same field. Whichever
// of their event functions falls first ends the segment and decides the jump and the next set.
//
// With the problem's index jump function iota the next set is iota_I(x). Without it the index vectors of a signature
// follow each other cyclically, one at a time; the event functions monitored on each segment are looked at as well,
// but end nothing.

struct Mode {
  std::vector<IndexVector> index_vectors;  ///< not empty; priority of the first when two events come together
  std::vector<int> monitored;              ///< events that end nothing
  bool operator==(const Mode&) const = default;

  int field() const { return index_vectors.front().field; }
  /// Event functions that can end the segment, each once, in order.
  std::vector<int> terminal_events() const;
  /// Those and the monitored ones.
  std::vector<int> all_events() const;
  /// The first index vector with this event function.
  const IndexVector& ended_by(int event) const;
};

class ModeRule {
 public:
  /// By the problem's index jump function, from `start` or, if that is not given, from what iota says of a start.
  explicit ModeRule(const HybridSystem& system, std::optional<Mode> start = {})
      : system_(system), start_(std::move(start)) {}
  /// What a mode of a cycle monitors.
  enum class Monitor {
    as_given,
    what_follows,  ///< the events of the index jump function's index vectors, but Poincare sections
  };
  /// Cyclically through modes of one index vector each.
  ModeRule(const HybridSystem& system, std::vector<Mode> cycle, Monitor monitor = Monitor::as_given)
      : system_(system), cycle_(std::move(cycle)), monitor_(monitor) {}

  const HybridSystem& system() const { return system_; }
  bool is_cyclic() const { return !cycle_.empty(); }

  /// The mode at a start x. Throws UserError when it says
  /// nothing.
  Mode first(const Eigen::VectorXd& x, const Eigen::VectorXd& par);
  /// The mode after a segment `from` that ends, before its jump, at x; without index vectors, and the reason in
  /// fault(), when iota cannot be evaluated or gives nothing that can be simulated.
  Mode next(const IndexVector& from, const Eigen::VectorXd& x, const Eigen::VectorXd& par);
  const std::string& fault() const { return fault_; }

 private:
  /// Mode `position_` of the cycle after `from`, which ended at x.
  Mode of_cycle(const IndexVector& from, const Eigen::VectorXd& x, const Eigen::VectorXd& par) const;

  const HybridSystem& system_;
  std::optional<Mode> start_;
  std::vector<Mode> cycle_;
  Monitor monitor_ = Monitor::as_given;
  std::string fault_;
  std::size_t position_ = 0;
};

/// "" when the index vectors exist in the problem and have one field; otherwise what is wrong with them.
std::string fault_of(const HybridSystem& system, const std::vector<IndexVector>& index_vectors);

/// "(0.1, 2)", with the digits that people need to see a difference; the first twelve entries of a large state.
std::string state_text(const Eigen::VectorXd& x);

// On which side of an event a simulation begins whose first state lies on that event's surface, h_j = 0, with h_j
// falling: before the event, which then happens at once, or after it.
//
// The state alone cannot decide. If the jump sends it to a point of the surface where h_j falls again, as the heel
// strike of a walker does, it is taken as a state after the event. If the jump takes it off the surface, as the reset
// of a clock does, or sends the flow back, as a wall does, it is taken as a state before the event.

/// The start of a simulation counts as on the surface up to |h_j| = start_tolerance sum_i |h_x,i x_i|, wherever the
/// state is known to be one after the event or may be: states are typed with few digits.
constexpr double start_tolerance = level::five_digits;

struct StartSide {
  enum class Given {
    nothing,  ///< the jump decides, as above
    after,    ///< of `event`, or of any event that is no wall if `event` is 0
    before,
  } given = Given::nothing;
  int event = 0;
};

/// An event on whose surface the simulation begins, with h_j falling.
struct SurfaceStart {
  IndexVector index;
  double h = 0.0;
  bool is_after = false;      ///< false: the event happens at once
  bool is_undecided = false;  ///< nothing was given, and the jump decided
};

/// Does the jump send the flow back from the surface, as an impact does?
bool reverses_flow(const HybridSystem& system, const IndexVector& index, const Eigen::VectorXd& x,
                   const Eigen::VectorXd& par);
/// How well states are known, as a share of their sizes: |h| up to this share of its scale is zero.
struct StateAccuracy {
  const Eigen::VectorXd& sizes;
  double share;
};
/// Does the jump take the state from the surface to another place?
bool moves_state(const HybridSystem& system, const IndexVector& index, const Eigen::VectorXd& x,
                 const Eigen::VectorXd& par, const StateAccuracy& known);

/// Of the index vectors of `mode`, the first one of `rule`, at the start x.
std::vector<SurfaceStart> surface_starts(const ModeRule& rule, const Mode& mode, const Eigen::VectorXd& x,
                                         const Eigen::VectorXd& par, const StartSide& side, const StateAccuracy& known);

// A hybrid system run forward in time, one segment after the other.
//
//     x' = f_i(x, p) until the first h_j of the current mode falls to zero,   x -> g_k(x, p),   next mode
//
// What decides the next mode is in ModeRule. When two event functions come to zero together the first in
// the mode's order ends the segment and the other one, if the flow still goes through it after the jump, a segment of
// zero duration. What a start on a surface means is in SurfaceStart. Trouble is a value: an integration that
// fails, an event after whose jump the flow leaves the region h >= 0 again at once (it sticks).

class WatchedFlow;

inline constexpr long no_limit = std::numeric_limits<long>::max();

struct SimulationSettings {
  FlowOptions flow;           ///< max_duration: give up waiting for an event after this time
  StartSide side;             ///< of events on whose surface the start lies
  double contact = 1e-3;      ///< a least value of h below this share of its largest value is a near-grazing contact
  std::vector<int> sections;  ///< event functions whose falls are marked wherever they do not end the segment
  std::size_t samples = 200;  ///< at most so many states are kept of each segment; 0 none
  /// After so many steps of the integrator it waits no longer for an event.
  long steps_without_event = no_limit;
  std::function<bool()> interrupted;
  /// Told of every piece of the flow that has been passed: its field, x(t) inside it, and from when to when, counted
  /// from the start of the segment.
  std::function<void(int field, const DenseOutput& state, double from, double to)> on_piece;
};

enum class SegmentEnd {
  event,
  end_time,  ///< of the simulation
  no_event,  ///< within max_duration
  sticks,    ///< the flow would leave through the event that has just ended a segment
  failed,    ///< a function cannot be evaluated, the integrator or iota gave up
  interrupted,
};

struct Sample {
  double time = 0.0;
  Eigen::VectorXd state;
};

/// Something seen on the way that ended nothing.
struct SegmentMark {
  enum class Kind {
    contact,    ///< h nearly zero at a minimum
    section,    ///< one of `sections` fell through zero
    violation,  ///< a monitored h fell below zero: no orbit of the model any more
    beyond,     ///< h < 0 at the start of the segment, of an event with an impact
  };
  Kind kind = Kind::contact;
  int event = 0;
  double time = 0.0;
  double h = 0.0;
  double rate = 0.0;  ///< h_x f
  Eigen::VectorXd state;
};

struct SimulatedSegment {
  long number = 1;
  Mode mode;
  double start_time = 0.0;
  double duration = 0.0;
  Eigen::VectorXd start;
  Eigen::VectorXd end;  ///< before the jump
  SegmentEnd ended_by = SegmentEnd::event;
  IndexVector index{0, 0, 0};             ///< the one whose event ended it
  Eigen::VectorXd after;                  ///< g(end)
  double event_velocity = 0.0;            ///< h_x f at the end
  std::vector<IndexVector> simultaneous;  ///< others whose events came at the same time
  std::vector<Sample> samples;            ///< start and end included
  Eigen::VectorXd low, high;              ///< least and largest value of each state, whatever samples are kept
  std::vector<SegmentMark> marks;
  std::string message;  ///< why it did not end in an event

  double end_time() const { return start_time + duration; }
};

class HybridSimulation {
 public:
  /// par has the room of the problem's ParameterLayout. The system behind `rule` outlives this object. Throws UserError
  /// for a state of the wrong length or not finite, and when there is no first mode.
  HybridSimulation(ModeRule rule, const Eigen::VectorXd& x0, const Eigen::VectorXd& par, SimulationSettings settings);
  /// Continues behind the last event of `at`, as if it had been met in the state `end` (before its jump), with other
  /// settings. Requires an event in `at`.
  HybridSimulation(const HybridSimulation& at, const Eigen::VectorXd& end, SimulationSettings settings);

  /// The next segment, or the part of it up to `end_time`. When one has not ended in an event there is nothing to go on
  /// with.
  SimulatedSegment next(double end_time);

  /// Events with an impact that are negative where the next segment begins: the state lies beyond a wall.
  std::vector<int> walls_behind() const;

  const HybridSystem& system() const { return system_; }
  const Eigen::VectorXd& parameters() const { return par_; }
  double time() const { return time_; }
  const Eigen::VectorXd& state() const { return x_; }
  /// Of the states: the largest |x_i| so far, and what sizes_at() says of the start.
  const Eigen::VectorXd& sizes() const { return settings_.flow.sizes; }
  /// What the tolerance of integration makes of the time of the event that ended a segment: it moves the event
  /// function by so much of its scale, and the flow is as fast as h_x f.
  double time_uncertainty(const SimulatedSegment& ended) const;
  /// The index vector that ended the last segment; (0,0,0) before any.
  const IndexVector& last_event() const { return last_; }
  /// Of the last segment; before any, that of the start.
  const Mode& mode() const { return mode_; }
  /// Does it follow a signature?
  bool is_cyclic() const { return rule_.is_cyclic(); }
  /// Whether the state lies on the surface of this index vector's event and goes to h < 0 without being ended by it, as
  /// after a section: nothing happens there until h has risen above zero.
  bool leaves_downwards(const IndexVector& index) const;
  /// Events of the first mode on whose surface the simulation began, and on which side of them.
  const std::vector<SurfaceStart>& surface_starts() const { return surface_starts_; }
  /// The release from contact behind which the simulation began, in contact, so that it left that at once; 0: none.
  int released() const { return released_; }

 private:
  StateAccuracy accuracy() const { return {sizes(), settings_.flow.surface_tolerance}; }
  /// h_j and h_x f under field i at x.
  struct Surface {
    double h = 0.0, rate = 0.0;  // a rate that is rounding is 0
    bool is_near = false;        // |h| within the tolerance for starts
  };
  Surface surface(int field, int event, const Eigen::VectorXd& x) const;
  bool is_wall(const IndexVector& index, const Eigen::VectorXd& x) const;
  bool begins() const { return last_.field == 0; }

  Eigen::VectorXd first_sizes() const;
  void leave_contact();
  SimulatedSegment begin_segment();
  std::vector<int> due_at_start(const SimulatedSegment& segment) const;
  bool sticks_at_start(SimulatedSegment& segment) const;
  std::vector<int> watched_events() const;
  std::vector<int> events_begun_after() const;
  void integrate(SimulatedSegment& segment, double end_time);
  bool pass_piece(SimulatedSegment& segment, const WatchedFlow& flow, double from, double to);
  void note_contacts(SimulatedSegment& segment, WatchedFlow& flow) const;
  void end_by(SimulatedSegment& segment, const std::vector<int>& together);
  void stop(SimulatedSegment& segment, SegmentEnd why, std::string message) const;

  ModeRule rule_;
  const HybridSystem& system_;
  Eigen::VectorXd par_;
  SimulationSettings settings_;

  Mode mode_;
  bool is_cut_ = false;  // the last segment has not ended in an event: mode_ is still that behind the last event
  Eigen::VectorXd x_;
  double time_ = 0.0;
  long segments_ = 0;
  std::vector<SurfaceStart> surface_starts_;
  int released_ = 0;
  IndexVector last_{0, 0, 0};      // that ended the segment before
  double last_rate_ = 0.0;         // h_x f there
  Eigen::VectorXd before_jump_;    // the state there
  std::vector<int> pending_;       // events that came together with it
  std::set<int> walls_;            // events whose jumps have been seen to reverse h_x f
  std::vector<int> watched_;       // events of the current segment
  std::map<int, double> largest_;  // value of each event function so far
};

}  // namespace tchat
