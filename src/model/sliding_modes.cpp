#include "model/sliding_modes.hpp"

#include <cmath>

namespace tchat {

SideRate side_rate(const HybridSystem& system, const tchat_sliding& mode, int side, const double* x,
                   const double* par) {
  const EventAt at = event_at(system, mode.surface, side, x, par);
  return {side == mode.plus ? at.rate() : -at.rate(), at.sizes()};
}

bool is_on_surface(const HybridSystem& system, const tchat_sliding& mode, const double* x, const double* par,
                   double tolerance) {
  const EventAt at = event_at(system, mode.surface, x, par);
  return std::abs(at.h) <= tolerance * at.scale(x);
}

}  // namespace tchat
