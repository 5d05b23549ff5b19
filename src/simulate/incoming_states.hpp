/// States on a section of motions that impact nearby, as the flow that comes in has them: the dissertation collects
/// points on P and P' from trajectories of the smooth flow and accounts for the impact only afterwards (note at the end
/// of its chapter 4), which is what composite maps are made of, (2.81).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

namespace tchat {

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

}  // namespace tchat
