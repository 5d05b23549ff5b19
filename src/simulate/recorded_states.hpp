/// States that a sweep records along a flow: on a section, and the largest values of each state.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "model/hybrid_system.hpp"
#include "motion/watched_flow.hpp"

namespace tchat {

// States on a section of motions that impact nearby, as the flow that comes in has them: the dissertation collects
// points on P and P' from trajectories of the smooth flow and accounts for the impact only afterwards (note at the end
// of its chapter 4), which is what composite maps are made of, (2.81).

/// A state on the way of a motion.
struct TimedState {
  double time = 0.0;
  int event = 0;  ///< event function that falls, or is least, there
  Eigen::VectorXd state;
};

/// The stretch of time that states lie in: from `start`, and when it is a period it begins anew behind its end.
struct TimeSpan {
  double start = 0.0;
  std::optional<double> period;

  /// From a to the next b, which is infinite when b has been before and does not come again.
  double from_to(double a, double b) const;
};

/// Where the smooth flow that comes in at impact number k (from 0) falls onto the section, within so much time behind
/// the impact; nothing where it does not.
using IncomingFlow = std::function<std::optional<TimedState>(std::size_t k, double within)>;

/// Impact k, at times[k], belongs to the section where the section is at most a third of its mean return time behind
/// it. There the state of the motion, which the impact has changed already, gives way to that of the incoming flow; of
/// several impacts before one section the first counts. `crossings`: of the motion itself, by time within the span.
std::vector<TimedState> incoming_states(const std::vector<TimedState>& crossings, const std::vector<double>& times,
                                        const TimeSpan& span, const IncomingFlow& flow);

/// Number of the contact nearest in time to each state; -1 where none is within a third of the mean return time.
std::vector<int> nearest_contacts(const std::vector<TimedState>& states, const std::vector<TimedState>& contacts,
                                  const TimeSpan& span);

// max over t of each state x_k(t) along a flow, located where x_k' = f_k changes its sign from + to -.
//
// A maximum and a minimum between two of the times that are looked at (a quarter of an integration step apart) are
// missed; they differ by little there.

class LargestValues {
 public:
  /// A view of `system` and `par`, which outlive this object.
  LargestValues(const HybridSystem& system, const Eigen::VectorXd& par);

  /// x(t) of the field from one time to another: the argument of SimulationSettings::on_piece.
  void add_piece(int field, const DenseOutput& state, double from, double to);

  /// One for each state, -infinity before any piece.
  const Eigen::VectorXd& values() const { return values_; }

 private:
  struct Look {
    double time = 0.0;
    Eigen::VectorXd state, rate;
  };
  Look look(int field, const DenseOutput& state, double time) const;
  void locate(int field, const DenseOutput& state, Eigen::Index k, double rising, double falling);

  const HybridSystem& system_;
  const Eigen::VectorXd& par_;
  Eigen::VectorXd values_;
};

}  // namespace tchat
