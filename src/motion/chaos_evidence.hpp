/// The evidence that a motion with a positive Lyapunov exponent is chaotic.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>

#include "motion/growth_series.hpp"
#include "motion/hybrid_simulation.hpp"

namespace tchat {

// Whether a motion with a positive Lyapunov exponent is chaotic, or keeps to something unstable: an orbit, an
// equilibrium or a torus, whose exponents it has as long as it is near.
//
// The motion is pushed by 1e-3 of its range, mostly along the direction that grows fastest, and simulated until such a
// distance has grown by e^10: then it has left what was unstable, unless the range was that of the distance itself.
// Windows of 64, 128, ... events follow. The motion is chaotic when in two windows in a row
//
//   - the largest exponent exceeds three of the error bars of that window, and its product with the time is 3 or more,
//   - the exponent is three quarters of that of the window before, or more: a distance that grows like a power of time,
//     as it does between neighbouring regular motions of a conservative system, has half of it in twice the time,
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
  double rate_ = 0.0;    // largest exponent of the last window
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
  /// Of the states, n.
  virtual Eigen::VectorXd units() const = 0;
  /// Of each state in the last part, n, in these units.
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
