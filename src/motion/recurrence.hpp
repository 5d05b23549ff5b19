/// What simulated motions show: recurrence, accumulation of events, growth, states that nothing depends on, equilibria.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "base/levels.hpp"
#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "model/scales.hpp"
#include "motion/hybrid_simulation.hpp"

namespace tchat {

// Accumulation of events (chattering, Zeno): durations that shrink geometrically towards zero, so that infinitely many
// events happen in finite time.
//
// With a pattern of q events, T_k / T_{k-q} -> rho < 1. The last patterns last w_0 > ... > w_J, of which the j-th ends
// r_j after the limit's remaining time (r_J = 0 for the last one): both are smooth functions of the velocity, and so is
// one of the other. What remains is r at w = 0, by Neville's scheme.

class ChatteringDetector {
 public:
  struct Accumulation {
    double remaining = 0.0;    ///< time from the last event to the limit
    double ratio = 0.0;        ///< rho
    int pattern = 1;           ///< q
    double uncertainty = 0.0;  ///< error bound of the limit's time: of the extrapolation and of the durations
  };

  /// The next segment: what ended it, how long it lasted, and how well that is known. `has_limit`: the problem itself
  /// says where such events accumulate, and only many of no duration do so elsewhere.
  void add(const IndexVector& index, double duration, double uncertainty = 0.0, bool has_limit = false);
  /// When durations have shrunk by a factor of 1000 and the last ratios agree; at once after many zero durations.
  std::optional<Accumulation> accumulation() const;

 private:
  static constexpr std::size_t longest_pattern = 8;
  static constexpr std::size_t most_kept = 100000;  // a simulation may be endless
  struct Segment {
    IndexVector index;
    double duration, uncertainty;
    bool has_limit;
  };
  std::optional<Accumulation> accumulation(std::size_t pattern) const;
  Accumulation limit(std::size_t pattern, std::size_t turns, double ratio) const;
  Accumulation limit_before(std::size_t end, std::size_t pattern, std::size_t turns, double ratio) const;

  std::deque<Segment> segments_;                     // the last `most_kept`
  std::size_t shrinking_[longest_pattern + 1] = {};  // how many last segments were shorter than those q before
  int zeros_ = 0;                                    // last segments of no duration
};

// Chatter that is not complete: impacts come at falling intervals, and then at a longer one, before their limit.

struct BrokenSeries {
  long count = 0;
  int longest = 0;  ///< so many falling intervals in a row
};

class SeriesCounter {
 public:
  /// The next segment: what ended it, and how long it lasted.
  void add(const IndexVector& index, double duration);
  /// Series of at least five falling intervals, to a quarter of their first or less, that a longer one ended.
  const std::map<IndexVector, BrokenSeries>& broken() const { return broken_; }

 private:
  IndexVector index_;
  double first_ = 0.0, last_ = 0.0;
  int falling_ = 0;
  std::map<IndexVector, BrokenSeries> broken_;
};

// A motion that comes to rest keeps its events, but goes through them ever more slowly.

class DecayDetector {
 public:
  /// The next segment: what ended it, and h_x f there.
  void add(const IndexVector& index, double event_velocity) {
    double& largest = largest_[index];
    largest = std::max(largest, std::abs(event_velocity));
    slow_ = std::abs(event_velocity) < next_to_nothing * largest ? slow_ + 1 : 0;
  }
  /// The last events' h_x f were next to nothing of what it was.
  bool dies_out() const { return slow_ >= 4; }

 private:
  static constexpr double next_to_nothing = level::negligible;
  std::map<IndexVector, double> largest_;
  int slow_ = 0;  // last events
};

// Does a simulation repeat itself? Ends of segments are compared with earlier ones.
//
// Period p is recognised when each of the last p segments ended by the same index vector and, after its jump, in the
// same state as the one p segments before. States are equal when they differ by less than a tolerance times the range
// of the orbit over those 2 p segments, so that a motion that dies out is not taken for an orbit.
//
// A state that no function depends on and no jump changes but by adding to it (a position on an endless floor) may
// advance: it is ignorable, and the other states alone are compared.

class Recurrence {
 public:
  /// `ignorable` has one entry for each state.
  Recurrence(int max_period, double tolerance) : max_period_(max_period), tolerance_(tolerance) {}

  void ignore(const std::vector<bool>& ignorable) { ignorable_ = ignorable; }
  /// States that are nothing but rounding of zero (StateSizes), one entry for each; empty: none.
  void take_for_rounding(const std::vector<bool>& states) { without_size_ = states; }
  /// Which states are so small, in all segments looked at, that they may be rounding?
  std::vector<bool> tiny_states() const;
  /// How far states are apart where some are angles, and a range of each state below which no share is taken.
  using Difference = std::function<Eigen::VectorXd(const Eigen::VectorXd&, const Eigen::VectorXd&)>;
  void measure(Difference difference, const Eigen::VectorXd& least_range);
  /// A segment that ended in an event.
  void add(const SimulatedSegment& segment) { add(segment.index, segment.after, segment.low, segment.high); }
  /// The same of a map's return: the state that it has come to, and the extremes of what has been passed.
  void add(const IndexVector& index, const Eigen::VectorXd& after, const Eigen::VectorXd& low,
           const Eigen::VectorXd& high);
  /// The smallest period in segments.
  std::optional<int> period() const;

  std::size_t size() const { return ends_.size(); }
  /// Index vectors of the last segments, in the order of time.
  Signature last(std::size_t segments) const;
  /// Have the last `period` segments ended by the index vectors of those before them?
  bool repeats_events(std::size_t period) const;
  /// Largest difference of the last `period` states from those before them, in units of scale(2 period).
  double difference(std::size_t period) const;
  /// sizes_of_differences() over the last segments, infinite where a state is ignored.
  Eigen::VectorXd scale(std::size_t segments) const;

 private:
  struct End {
    IndexVector index;
    Eigen::VectorXd after;
    Eigen::VectorXd low, high;  // of the states on the segment
  };
  bool repeats(std::size_t period) const;
  const End& back(std::size_t i) const { return ends_[ends_.size() - 1 - i]; }

  int max_period_;
  double tolerance_;
  std::vector<bool> ignorable_, without_size_;
  Difference difference_;
  Eigen::VectorXd least_range_;
  std::deque<End> ends_;  // the last 2 max_period
};

/// Does a motion stay within bounds? Of a motion on an attractor the range has been seen after a while; of one that
/// grows like a power of time it is larger by a share each time that the number of events has doubled.
class RangeGrowth {
 public:
  void add(const SimulatedSegment& segment);
  /// A state, from 0, whose range has grown by a quarter since half of the events at least; none of `left_out`.
  std::optional<Eigen::Index> growing(const std::vector<bool>& left_out) const;
  /// Range of a state now, in ranges that it had then.
  double growth(Eigen::Index state) const;

 private:
  struct Extremes {
    Eigen::VectorXd low, high;
  };
  /// After so many events as are half of those now, or a quarter.
  const Extremes& before() const { return doubled_[doubled_.size() - 2]; }
  Extremes now_;
  std::vector<Extremes> doubled_;  // after 1, 2, 4, ... events
  long events_ = 0;
};

/// Does a motion still change? On a torus the states at the events of one kind cover the same range in the last half of
/// the motion as in the quarter before it; where a motion creeps past a fold, or comes to an end as slowly as 1/t, they
/// cover another one.
class EventRanges {
 public:
  void add(const SimulatedSegment& segment);
  struct Change {
    IndexVector index;
    Eigen::Index state;   ///< from 0
    double range, shift;  ///< range in the last half, and of its middle, in ranges of the quarter before
  };
  /// Where the range has become smaller or larger by a fifth, or has moved by a fifth; in no state of `left_out`.
  std::optional<Change> changing(const std::vector<bool>& left_out) const;

 private:
  struct Window {
    Eigen::VectorXd low, high;
    long events = 0;
  };
  struct Windows {
    Window now, last, before;  // since 2^k events, and the two whole ones before
  };
  std::map<IndexVector, Windows> windows_;
  Eigen::VectorXd sizes_;  // of the states
  long events_ = 0;
};

/// Which states nothing depends on: zero columns in f_x and h_x, and a unit column in g_x, of all functions at
/// `points`.
std::vector<bool> ignorable_states(const HybridSystem& system, const std::vector<Eigen::VectorXd>& points,
                                   const Eigen::VectorXd& par);

/// The segments of one period, in order, and the states that nothing depends on, from 0.
struct Turn {
  std::vector<SimulatedSegment> segments;
  std::vector<Eigen::Index> ignorable;
};

/// The sizes of the states in segments of a motion with or without an event at the end.
StateSizes sizes_in(const HybridSystem& system, std::span<const SimulatedSegment> segments, const Eigen::VectorXd& par);

// Whether a trajectory converges to an equilibrium of its field.

/// An equilibrium whose f_x has no eigenvalue with a positive real part, found by Newton's method from the end of a
/// motion that has had no event for so long (SegmentEnd::no_event) that its speed times that duration is nothing.
/// States that nothing depends on (`ignorable`, from 0) keep their values, and may move. `sizes`: of the states.
std::optional<Eigen::VectorXd> reached_equilibrium(const HybridSystem& system, const SimulatedSegment& last,
                                                   const Eigen::VectorXd& par,
                                                   const std::vector<Eigen::Index>& ignorable,
                                                   const Eigen::VectorXd& sizes);

/// Such an equilibrium that states at events of one kind, in the order of time, converge to: each of the last `least`
/// of them, or of more, is nearer than the one before it, or there to 1e-8 or 100 times the `tolerance` of integration.
/// The surface of the event goes through it, as no state on the surface could come near it otherwise. Where they are
/// not there yet, the distances fall by more than errors of the integration may make of a motion that keeps its energy,
/// and their limit by Aitken's formula, from three of them at equal spaces, is below half of the last one: else they
/// may come to a cycle round the equilibrium. Slow convergence, as 1/t, is not told from that.
std::optional<Eigen::VectorXd> approached_equilibrium(const HybridSystem& system, const IndexVector& index,
                                                      const std::vector<Eigen::VectorXd>& states, std::size_t least,
                                                      const Eigen::VectorXd& par,
                                                      const std::vector<Eigen::Index>& ignorable,
                                                      const Eigen::VectorXd& sizes, double tolerance);

}  // namespace tchat
