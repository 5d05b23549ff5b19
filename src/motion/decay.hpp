/// A motion that comes to rest keeps its events, but goes through them ever more slowly.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>

#include "model/index_vector.hpp"

namespace tchat {

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
  static constexpr double next_to_nothing = 1e-12;
  std::map<IndexVector, double> largest_;
  int slow_ = 0;  // last events
};

}  // namespace tchat
