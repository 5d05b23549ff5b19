#include "stability/sliding_bifurcation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "model/sliding_modes.hpp"
#include "orbit/admissibility.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/event_minima.hpp"
#include "orbit/orbit.hpp"
#include "stability/bifurcation_tests.hpp"

namespace tchat {

namespace {

constexpr const char* crossing_sliding = "crossing-sliding";
constexpr const char* grazing_sliding = "grazing-sliding";
constexpr const char* switching_sliding = "switching-sliding";
constexpr const char* adding_sliding = "adding-sliding";

/// Does a field point at the surface of its mode in state x?
bool points_at_surface(const HybridSystem& system, const tchat_sliding& mode, int side, const double* x,
                       const double* par) {
  return side_rate(system, mode, side, x, par).away < 0.0;
}

/// Is the surface of an event function that of the mode, at a state that lies on the event's?
bool is_surface(const HybridSystem& system, const tchat_sliding& mode, int event, const double* x, const double* par) {
  constexpr double parallel = 1.0 - 1e-9;
  constexpr double on_surface = 1e-6;  // a located contact is known to EPSS
  if (event == mode.surface) return true;
  if (event == no_function) return false;
  const EventAt own = event_at(system, mode.surface, x, par);
  const EventAt other = event_at(system, event, x, par);
  return std::abs(own.h) <= on_surface * own.scale(x) &&
         std::abs(own.gradient.dot(other.gradient)) >= parallel * own.gradient.norm() * other.gradient.norm();
}

/// The pieces around a place of the orbit: the fields that last before and after it, and those between that do not.
struct Surroundings {
  int before;
  int after;
  std::set<int> vanishing;
  bool has_sliding(const tchat_sliding& mode) const { return vanishing.contains(mode.field); }
};

/// Around segment s (from 0) where that lasts no time, else around its start or end.
Surroundings around(const DefiningSystem& system, const Orbit& x, int s, bool at_end) {
  const int m = system.segments();
  const auto field = [&](int k) { return system.signature()[static_cast<std::size_t>(k)].field; };
  const auto step = [m](int k, int by) { return (k + by + m) % m; };
  Surroundings found{};
  int before = at_end || lasts_no_time(x, s) ? s : step(s, -1);
  int after = step(before, 1);
  for (int count = 0; count < m && lasts_no_time(x, before); ++count, before = step(before, -1))
    found.vanishing.insert(field(before));
  for (int count = 0; count < m && lasts_no_time(x, after); ++count, after = step(after, 1))
    found.vanishing.insert(field(after));
  found.before = field(before);
  found.after = field(after);
  return found;
}

/// A contact in the middle of a segment that lasts.
std::string inside(const TestedPoint& point, const tchat_sliding& mode, const UserPointKind& kind, int field) {
  const DefiningSystem& defining = point.condensed.system();
  if (field == mode.field) return ends_sliding(mode, kind.index) ? adding_sliding : "";
  if (!is_side(mode, field)) return "";
  const auto contact = least_value(defining, point.condensed.rule(), point.orbit, kind.segment - 1, kind.index);
  const double* par = point.orbit.par.data();
  if (!contact || !is_surface(defining.system(), mode, kind.index, contact->state.data(), par)) return "";
  return points_at_surface(defining.system(), mode, other_side(mode, field), contact->state.data(), par)
             ? grazing_sliding
             : "";
}

/// Does h_x f of a side, zero at x, rise along its flow in the direction that sliding allows? Sliding that begins there
/// goes on then; else it ends at once.
bool sliding_goes_on(const HybridSystem& system, const tchat_sliding& mode, int side, const double* x,
                     const double* par) {
  const EventAt at = event_at(system, mode.surface, side, x, par);
  const double change = rate_gradient(system, at, mode.surface, side, x, par).dot(at.f);
  return side == mode.minus ? change > 0.0 : change < 0.0;
}

/// What meets at a start, an end or a segment that lasts no time. `x` is the state there.
std::string at_meeting(const HybridSystem& system, const tchat_sliding& mode, const Surroundings& pieces,
                       const UserPointKind& kind, const double* x, const double* par) {
  const bool from_side = is_side(mode, pieces.before), to_side = is_side(mode, pieces.after);
  const bool from_sliding = pieces.before == mode.field, to_sliding = pieces.after == mode.field;
  if (from_side && to_side && pieces.before != pieces.after) {
    if (pieces.has_sliding(mode)) return crossing_sliding;
    if (!ends_sliding(mode, kind.index)) return "";
    return sliding_goes_on(system, mode, pieces.after, x, par) ? switching_sliding : crossing_sliding;
  }
  if (from_side && to_side) {
    if (pieces.has_sliding(mode)) return grazing_sliding;
    const int other = other_side(mode, pieces.before);
    const bool touches = is_surface(system, mode, kind.index, x, par) && !pieces.vanishing.contains(other);
    return touches && points_at_surface(system, mode, other, x, par) ? grazing_sliding : "";
  }
  if (from_side && to_sliding) {
    const int other = other_side(mode, pieces.before);
    const bool other_vanishes = kind.index == ends_with(mode, other);
    return pieces.vanishing.contains(other) || other_vanishes ? switching_sliding : "";
  }
  if (from_sliding && to_sliding) {
    const bool leaves = pieces.vanishing.contains(mode.minus) || pieces.vanishing.contains(mode.plus);
    return leaves || ends_sliding(mode, kind.index) ? adding_sliding : "";
  }
  const bool ends_tangent = kind.kind == UserPointKind::impact_velocity && ends_sliding(mode, kind.index);
  return from_sliding && to_side && ends_tangent ? adding_sliding : "";
}

}  // namespace

std::string sliding_bifurcation(const TestedPoint& point, const UserPointKind& kind) {
  if (kind.kind != UserPointKind::contact && kind.kind != UserPointKind::impact_velocity) return "";
  const DefiningSystem& defining = point.condensed.system();
  const Orbit& x = point.orbit;
  const int s = kind.segment - 1;
  const int field = defining.signature()[static_cast<std::size_t>(s)].field;
  const bool at_end = kind.kind == UserPointKind::impact_velocity || kind.tau == 1.0;
  const bool interior = !at_end && kind.tau > 0.0 && !lasts_no_time(x, s);
  for (const tchat_sliding& mode : defining.system().sliding_modes()) {
    const std::string name = interior ? inside(point, mode, kind, field)
                                      : at_meeting(defining.system(), mode, around(defining, x, s, at_end), kind,
                                                   at_end ? x.end(s) : x.start(s), x.par.data());
    if (!name.empty()) return name;
  }
  return "";
}

SlidingOnsetTest::SlidingOnsetTest(const DefiningSystem& system, int segment, const tchat_sliding& mode, bool stop)
    : system_(system), segment_(segment), mode_(mode), stop_(stop) {}

int SlidingOnsetTest::field_after() const { return system_.signature()[static_cast<std::size_t>(next())].field; }

int SlidingOnsetTest::event() const { return ends_with(mode_, field_after()); }

std::string SlidingOnsetTest::name() const {
  return fmt::format("h_x f of field {} at the start of segment {}", field_after(), next() + 1);
}

TestValue SlidingOnsetTest::evaluate(const TestedPoint& point) const {
  const double* x = point.orbit.start(next());
  const double* par = point.orbit.par.data();
  if (!is_on_surface(system_.system(), mode_, x, par, orbit_accuracy)) return TestValue::undefined();  // of another one
  const SideRate rate = side_rate(system_.system(), mode_, field_after(), x, par);
  return TestValue::of(rate.away, no_transversality * rate.sizes);
}

SpecialPoint SlidingOnsetTest::classify(const TestedPoint& point, bool rising) const {
  const HybridSystem& system = system_.system();
  return {PointType::user,
          {UserPointKind::contact, next() + 1, event(), 0.0},
          stop_ && !rising,
          fmt::format("h_x f = 0 of field {} ({}) where segment {} crosses event {} ({}), {}", field_after(),
                      system.function_name(FunctionKind::field, field_after()), segment_ + 1, mode_.surface,
                      system.function_name(FunctionKind::event, mode_.surface),
                      state_text(system, point.orbit, point.orbit.start(next())))};
}

}  // namespace tchat
