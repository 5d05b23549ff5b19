/// What the fields of a sliding mode (tchat_sliding) do at a state. Allocates: not for Newton's loop.
#pragma once

#include "model/event_at.hpp"
#include "model/hybrid_system.hpp"

namespace tchat {

inline bool is_side(const tchat_sliding& mode, int field) { return field == mode.minus || field == mode.plus; }
inline int other_side(const tchat_sliding& mode, int side) { return side == mode.minus ? mode.plus : mode.minus; }
inline bool ends_sliding(const tchat_sliding& mode, int event) {
  return event == mode.to_minus || event == mode.to_plus;
}
/// The event function at which sliding ends with the field of a side.
inline int ends_with(const tchat_sliding& mode, int side) { return side == mode.minus ? mode.to_minus : mode.to_plus; }

/// How a side's field meets the surface.
struct SideRate {
  double away;   ///< h_x f in the direction from the surface into that side; negative: the field points at the surface
  double sizes;  ///< |h_x| |f|
};
SideRate side_rate(const HybridSystem& system, const tchat_sliding& mode, int side, const double* x, const double* par);

/// The surface's event function with its gradient, and whether h is zero there to this share of its scale.
bool is_on_surface(const HybridSystem& system, const tchat_sliding& mode, const double* x, const double* par,
                   double tolerance);

}  // namespace tchat
