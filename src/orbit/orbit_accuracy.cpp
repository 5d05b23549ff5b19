#include "orbit/orbit_accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/event_at.hpp"

namespace tchat {

double event_scale(const HybridSystem& system, const Orbit& x, int event) {
  // One state says nothing of the sizes that h has.
  if (x.shape.stored_nodes() == 1) return event_at(system, event, x.end(0), x.par.data()).scale(x.end(0));
  double largest = 0.0;
  for (int s = 0; s < x.shape.segments; ++s)
    for (int k = 0; k < x.shape.nodes_of(s); k += x.shape.collocation)
      largest = std::max(largest, std::abs(system.event(event, x.node(s, k), x.par.data())));
  return largest;
}

Eigen::VectorXd state_uncertainty(const Orbit& x) {
  constexpr double rounding = 1e-14;
  const Eigen::VectorXd sizes = x.states.cwiseAbs().rowwise().maxCoeff();
  const double least = std::max(rounding * sizes.maxCoeff(), std::numeric_limits<double>::min());
  return (orbit_accuracy * sizes).cwiseMax(least);
}

}  // namespace tchat
