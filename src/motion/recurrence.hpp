/// Does a simulation repeat itself? Ends of segments are compared with earlier ones.
///
/// Period p is recognised when each of the last p segments ended by the same index vector and, after its jump, in the
/// same state as the one p segments before. States are equal when they differ by less than a tolerance times the range
/// of the orbit over those 2 p segments, so that a motion that dies out is not taken for an orbit.
///
/// A state that no function depends on and no jump changes but by adding to it (a position on an endless floor) may
/// advance: it is ignorable, and the other states alone are compared.
#pragma once

#include <deque>
#include <optional>

#include "motion/hybrid_simulation.hpp"

namespace tchat {

class Recurrence {
 public:
  /// `ignorable` has one entry for each state.
  Recurrence(int max_period, double tolerance) : max_period_(max_period), tolerance_(tolerance) {}

  void ignore(const std::vector<bool>& ignorable) { ignorable_ = ignorable; }
  /// A segment that ended in an event.
  void add(const SimulatedSegment& segment);
  /// The smallest period in segments.
  std::optional<int> period() const;

  std::size_t size() const { return ends_.size(); }
  /// Index vectors of the last segments, in the order of time.
  Signature last(std::size_t segments) const;
  /// Have the last `period` segments ended by the index vectors of those before them?
  bool repeats_events(std::size_t period) const;
  /// Largest difference of the last `period` states from those before them, in units of scale(2 period).
  double difference(std::size_t period) const;
  /// Range of each state over the last segments, at least 1e-3 of the largest; infinite where a state is ignored.
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
  std::vector<bool> ignorable_;
  std::deque<End> ends_;  // the last 2 max_period
};

/// Which states nothing depends on: zero columns in f_x and h_x, and a unit column in g_x, of all functions at
/// `points`.
std::vector<bool> ignorable_states(const HybridSystem& system, const std::vector<Eigen::VectorXd>& points,
                                   const Eigen::VectorXd& par);

}  // namespace tchat
