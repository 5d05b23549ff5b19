#include "bvp/orbit_accuracy.hpp"

#include <algorithm>
#include <cmath>

namespace tchat {

double event_scale(const HybridSystem& system, const Orbit& x, int event) {
  double largest = 0.0;
  for (int s = 0; s < x.shape.segments; ++s)
    for (int k = 0; k < x.shape.nodes(); k += x.shape.collocation)
      largest = std::max(largest, std::abs(system.event(event, x.node(s, k), x.par.data())));
  return largest;
}

}  // namespace tchat
