/// Accumulation of events (chattering, Zeno): durations that shrink geometrically towards zero, so that infinitely many
/// events happen in finite time.
///
/// With a pattern of q events, T_k / T_{k-q} -> rho < 1; what remains is (T_{k-q+1} + ... + T_k) rho / (1 - rho).
#pragma once

#include <deque>
#include <optional>

#include "model/index_vector.hpp"

namespace tchat {

class ChatteringDetector {
 public:
  struct Accumulation {
    double remaining = 0.0;  ///< time from the last event to the limit
    double ratio = 0.0;      ///< rho
    int pattern = 1;         ///< q
  };

  /// The next segment: what ended it and how long it lasted.
  void add(const IndexVector& index, double duration);
  /// When durations have shrunk by a factor of 1000 and the last ratios agree; at once after many zero durations.
  std::optional<Accumulation> accumulation() const;

 private:
  static constexpr std::size_t longest_pattern = 8;
  static constexpr std::size_t most_kept = 100000;  // a simulation may be endless
  struct Segment {
    IndexVector index;
    double duration;
  };
  std::optional<Accumulation> accumulation(std::size_t pattern) const;

  std::deque<Segment> segments_;                     // the last `most_kept`
  std::size_t shrinking_[longest_pattern + 1] = {};  // how many last segments were shorter than those q before
  int zeros_ = 0;                                    // last segments of no duration
};

}  // namespace tchat
