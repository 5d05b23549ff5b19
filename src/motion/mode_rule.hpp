/// What a simulation watches next: the set of index vectors of the current segment, all with the same field. Whichever
/// of their event functions falls first ends the segment and decides the jump and the next set.
///
/// With the problem's index jump function iota the next set is iota_I(x). Without it the index vectors of a signature
/// follow each other cyclically, one at a time; the event functions monitored on each segment are looked at as well,
/// but end nothing.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"

namespace tchat {

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

}  // namespace tchat
