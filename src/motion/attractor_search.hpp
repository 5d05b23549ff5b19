/// The search for the attractor of a simulation while it runs.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "motion/growth_series.hpp"
#include "motion/hybrid_simulation.hpp"
#include "motion/orbit_correction.hpp"
#include "motion/recurrence.hpp"

namespace tchat {

// What a simulation settles on, looked for while it runs, by all commands that simulate.
//
// A *candidate* for period q is a motion whose last q events are those of the q before them, in states not far from
// those. It is corrected by Newton's method (motion/orbit_correction.hpp) and is the attractor when the corrected
// orbit is stable and the motion approaches it. Shorter periods come first: near a multiplier of -1 a motion repeats
// itself best after two turns. Candidates are tried where the motion repeats itself (motion/recurrence.hpp) and,
// before it does, after numbers of events that double. An orbit that is not stable is no attractor: the motion is
// still to leave it, or passes by.
//
// Where nothing can be corrected, as events without a derivative are met, and where an orbit is neutral (of a
// conservative system), a motion that keeps repeating itself without moving is periodic all the same.

/// A periodic orbit that a motion has settled on, or keeps to without being attracted.
struct SettledOrbit {
  std::vector<SimulatedSegment> turn;  ///< of the orbit itself where it has been corrected, else of the motion
  Eigen::VectorXd end;                 ///< state on it in which the last event of the motion is met; n
  bool is_corrected = false;
  bool is_of_family = false;  ///< neutral, and orbits beside it are closed as well
  OrbitStability stability = OrbitStability::stable;
  std::vector<std::complex<double>> multipliers;  ///< where it has been corrected
  double uncertainty = 0.0;                       ///< of their moduli
};

class AttractorSearch {
 public:
  /// Periods up to so many events; states are equal to `recognition`, relative to the range of the motion. `settings`
  /// are those of the simulation; its observer (on_piece) is not called for the turns made here.
  AttractorSearch(int max_period, double recognition, SimulationSettings settings);

  /// The next segment of `motion`, which has ended in an event: has the motion settled?
  bool has_settled(const HybridSimulation& motion, const SimulatedSegment& segment);
  /// The same without a try.
  void add(const HybridSimulation& motion, const SimulatedSegment& segment);
  /// Tries all candidates now, and equilibria. True when one is an attractor.
  bool conclude(const HybridSimulation& motion);

  const std::optional<SettledOrbit>& orbit() const { return orbit_; }
  /// Number of events after which the last ones repeat, whether an orbit was found there or not.
  std::optional<int> repeats_after() const { return recurrence_.period(); }
  /// An equilibrium of the field that the motion comes to.
  const std::optional<Eigen::VectorXd>& equilibrium() const { return equilibrium_; }
  /// An orbit that the motion is or was near and that does not attract it: why it is no attractor. "" when there is
  /// none.
  const std::string& doubt() const { return doubt_; }
  /// At the last try the motion kept to an orbit that is not stable, or was still leaving it: exponents say nothing
  /// yet.
  bool is_near_unstable_orbit() const { return is_near_unstable_; }
  const std::vector<Eigen::Index>& ignorable() const { return ignorable_; }
  /// Which states are nothing but rounding of zero; empty: none.
  const std::vector<bool>& rounding() const { return rounding_; }
  /// The range of a state that something depends on still grows: why the motion is on no attractor yet. "" where none
  /// does.
  std::string unbounded(const HybridSystem& system) const;
  /// Why the motion cannot be on a torus yet: at some event a state covers another range than before (EventRanges).
  /// "" if none does.
  std::string unsettled(const HybridSystem& system) const;

 private:
  std::vector<bool> left_out() const;
  bool try_recurrence(const HybridSimulation& motion, int period);
  bool try_rest(const HybridSimulation& motion);
  bool try_nearby(const HybridSimulation& motion);
  double duration_of_last(std::size_t events) const;
  bool try_period(const HybridSimulation& motion, std::size_t period);
  bool keeps_repeating(const HybridSimulation& motion, int period);
  std::vector<Eigen::VectorXd> passed(std::size_t period) const;
  void find_ignorable(const HybridSimulation& motion, const SimulatedSegment& segment);

  int max_period_;
  double recognition_;
  SimulationSettings settings_;
  Recurrence recurrence_;
  RangeGrowth range_;
  EventRanges event_ranges_;
  std::vector<Eigen::VectorXd> points_;  // where functions were looked at
  std::vector<Eigen::Index> ignorable_;
  std::vector<bool> rounding_;         // which states are nothing else
  std::deque<SimulatedSegment> last_;  // the last max_period
  struct Passed {
    IndexVector index;
    Eigen::VectorXd end;
  };
  std::deque<Passed> passed_;  // the last events
  long events_ = 0;
  long next_nearby_, next_recurrence_ = 0, gap_;
  struct Held {
    long since = 0;
    int period = 0;
    Eigen::VectorXd state;
  };
  std::optional<Held> held_;             // a motion that repeats itself and could not be corrected, or is neutral
  std::optional<SettledOrbit> kept_to_;  // that orbit
  std::optional<SettledOrbit> orbit_;
  std::optional<Eigen::VectorXd> equilibrium_;
  std::string doubt_;
  bool is_near_unstable_ = false;
};

}  // namespace tchat
