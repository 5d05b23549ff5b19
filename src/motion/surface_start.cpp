#include "motion/surface_start.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "model/event_at.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;

VectorXd image_of(const HybridSystem& system, const IndexVector& index, const VectorXd& x, const VectorXd& par) {
  VectorXd image(x.size());
  system.value(FunctionKind::jump, index.jump, x.data(), par.data(), image.data());
  return image;
}

/// |h| up to which x counts as on the surface of a start.
double widest_on_surface(const EventAt& at, const VectorXd& x, double rounding) {
  const double typed = start_tolerance * at.gradient.cwiseProduct(x).cwiseAbs().sum();
  return std::max(typed, rounding * at.scale(x.data()));
}

/// Does the jump send x to a point of the same surface where h falls again, in a mode that watches the event?
bool falls_again(ModeRule rule, const IndexVector& index, const VectorXd& x, const VectorXd& par, double rounding) {
  const HybridSystem& system = rule.system();
  const Mode next = rule.next(index, x, par);
  if (next.index_vectors.empty()) return false;
  const std::vector<int> events = next.terminal_events();
  if (std::find(events.begin(), events.end(), index.event) == events.end()) return false;
  const VectorXd image = image_of(system, index, x, par);
  if (!image.allFinite()) return false;
  const EventAt at = event_at(system, index.event, next.field(), image.data(), par.data());
  return std::abs(at.h) <= widest_on_surface(at, image, rounding) && at.rate() < 0.0;
}

/// Nothing where the event needs no decision: the start is away from its surface, or the jump changes nothing.
std::optional<SurfaceStart> judge(const ModeRule& rule, const IndexVector& index, const VectorXd& x,
                                  const VectorXd& par, const StartSide& side, double rounding) {
  const HybridSystem& system = rule.system();
  const EventAt at = event_at(system, index.event, index.field, x.data(), par.data());
  if (!(at.rate() < 0.0) || std::abs(at.h) > widest_on_surface(at, x, rounding)) return std::nullopt;
  const bool is_on = std::abs(at.h) <= rounding * at.scale(x.data());
  const bool is_wall = reverses_flow(system, index, x, par);
  SurfaceStart start{index, at.h, false, false};
  if (side.given == StartSide::Given::after && (side.event == index.event || (side.event == 0 && !is_wall))) {
    start.is_after = true;
    return start;
  }
  if (side.given != StartSide::Given::before && is_wall) return is_on ? std::optional(start) : std::nullopt;
  if (!is_wall && !moves_state(system, index, x, par, rounding)) return std::nullopt;
  if (side.given == StartSide::Given::before) return start;
  start.is_undecided = true;
  start.is_after = (is_on || at.h < 0.0) && falls_again(rule, index, x, par, rounding);
  return is_on || start.is_after ? std::optional(start) : std::nullopt;
}

}  // namespace

bool reverses_flow(const HybridSystem& system, const IndexVector& index, const VectorXd& x, const VectorXd& par) {
  const VectorXd image = image_of(system, index, x, par);
  const double before = event_at(system, index.event, index.field, x.data(), par.data()).rate();
  const double after = event_at(system, index.event, index.field, image.data(), par.data()).rate();
  return before * after < 0.0;
}

bool moves_state(const HybridSystem& system, const IndexVector& index, const VectorXd& x, const VectorXd& par,
                 double rounding) {
  return (image_of(system, index, x, par) - x).norm() > rounding * (1.0 + x.norm());
}

std::vector<SurfaceStart> surface_starts(const ModeRule& rule, const Mode& mode, const VectorXd& x, const VectorXd& par,
                                         const StartSide& side, double rounding) {
  std::vector<SurfaceStart> starts;
  for (const IndexVector& index : mode.index_vectors) {
    const bool is_known = std::any_of(starts.begin(), starts.end(),
                                      [&](const SurfaceStart& start) { return start.index.event == index.event; });
    if (is_known) continue;
    if (const auto start = judge(rule, index, x, par, side, rounding)) starts.push_back(*start);
  }
  return starts;
}

}  // namespace tchat
