/// The search for the attractor of a simulation while it runs, and the evidence for chaos.
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
#include "motion/simulation_run.hpp"

namespace tchat {

// What a simulation settles on, looked for while it runs, by all commands that simulate.
//
// A *candidate* for period q is a motion whose last q events are those of the q before them, in states not far from
// those. It is corrected by Newton's method (motion/orbit_correction.hpp) and is the attractor when the corrected
// orbit is stable and the motion approaches it. Shorter periods come first: near a multiplier of -1 a motion repeats
// itself best after two turns. Candidates are tried where the motion repeats itself (motion/simulation_run.hpp) and,
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
  /// The range of a state that something depends on still grows: why the motion is on no attractor yet. "" where none
  /// does.
  std::string unbounded(const HybridSystem& system) const;
  /// A state is larger than so much, and than so many times its value at the start; those that nothing depends on do
  /// not count.
  bool is_beyond(const Eigen::VectorXd& x, double bound, const Eigen::VectorXd& start) const;

 private:
  bool try_recurrence(const HybridSimulation& motion, int period);
  bool try_rest(const HybridSimulation& motion);
  bool try_nearby(const HybridSimulation& motion);
  bool try_period(const HybridSimulation& motion, std::size_t period);
  bool keeps_repeating(const HybridSimulation& motion, int period);
  std::vector<Eigen::VectorXd> passed(std::size_t period) const;
  void find_ignorable(const HybridSimulation& motion, const SimulatedSegment& segment);

  int max_period_;
  double recognition_;
  SimulationSettings settings_;
  Recurrence recurrence_;
  RangeGrowth range_;
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

// Whether a motion with a positive Lyapunov exponent is chaotic, or keeps to something unstable: an orbit, an
// equilibrium or a torus, whose exponents it has as long as it is near.
//
// The motion is pushed by 1e-3 of its range, mostly along the direction that grows fastest, and simulated until such a
// distance has grown by e^10: then it has left what was unstable, unless the range was that of the distance itself.
// Windows of 64, 128, ... events follow. The motion is chaotic when in two windows in a row
//
//   - the largest exponent exceeds three of the error bars of that window, and its product with the time is 3 or more,
//   - no state has more than 3 times the range that it had in the window before; a motion that leaves an equilibrium
//     has e^3 = 20 times that range.

/// Collects windows until the question is decided. Of simulations and of maps alike.
class ChaosJudge {
 public:
  /// The logarithm of the growth that a push must have before the first window; it begins with `push` of the range.
  static constexpr double growth_before = 10.0;
  static constexpr double push = 1e-3;

  /// The next window. `range` has that of each state, n.
  void add(const LyapunovSpectrum& spectrum, const Eigen::VectorXd& range);
  bool is_chaotic() const { return in_a_row_ >= 2; }
  /// Two windows in a row have no positive exponent, and bars that tell so.
  bool is_regular() const { return regular_in_a_row_ >= 2; }
  /// Why it is not chaotic, as far as is known.
  std::string doubt() const;

 private:
  int in_a_row_ = 0, regular_in_a_row_ = 0;
  double spread_ = 0.0;  // largest ratio of ranges of the last two windows
  LyapunovSpectrum last_;
  Eigen::VectorXd range_;
};

/// By how much to push, n: along `direction` (n), and 0.3 of that along each state, so that nothing unstable is
/// kept to exactly. The measure is ChaosJudge::push of `range` (n, of each state at least 1e-3 of the largest).
Eigen::VectorXd push_along(const Eigen::VectorXd& direction, const Eigen::VectorXd& range);

struct ChaosEvidence {
  bool is_chaotic = false;
  bool was_interrupted = false;
  std::string doubt;  ///< why it is not known to be chaotic
  long events = 0;    ///< that have been looked at
};

/// A motion that begins beside another one, of which one part after the other is looked at. Events may be returns of a
/// map.
class MotionBeside {
 public:
  virtual ~MotionBeside() = default;
  /// So many events on; `spectrum`, if not null, is set to their exponents. False when the motion ends.
  virtual bool pass(long events, LyapunovSpectrum* spectrum) = 0;
  /// Of each state in the last part, n.
  virtual Eigen::VectorXd range() const = 0;
  /// Of all parts.
  virtual double time() const = 0;
  /// Once pass() was false: why it has ended, and whether by an interruption.
  virtual std::string why_ended() const = 0;
  virtual bool was_interrupted() const { return false; }
};

/// `begin_beside(change)` begins a motion at the state of the original one plus `change` (n). There `direction` (n,
/// zero if unknown) grows by `rate` > 0 per unit of time.
ChaosEvidence chaos_evidence(const std::function<std::unique_ptr<MotionBeside>(const Eigen::VectorXd&)>& begin_beside,
                             const Eigen::VectorXd& direction, double rate);

/// `motion` stands behind its last event, met in the state `end`. `direction` grows by `rate` > 0 per unit of time
/// (LyapunovAccumulator::growing_direction). The observer of `settings` is not called.
ChaosEvidence chaos_evidence(const HybridSimulation& motion, const Eigen::VectorXd& end,
                             const Eigen::VectorXd& direction, double rate, const SimulationSettings& settings);

}  // namespace tchat
