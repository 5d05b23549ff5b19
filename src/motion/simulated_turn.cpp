#include "motion/simulated_turn.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "model/event_at.hpp"
#include "motion/tangent_flow.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double tangential = 1e-14;  // |h_x f| / (|h_x| |f|): rounding
constexpr double endless = 1e300;

/// V at the end of a segment, onto the surface of its event. False where that is met tangentially.
bool project_on_event(const HybridSystem& system, const SimulatedSegment& segment, const VectorXd& par, MatrixXd& v) {
  const EventAt at = event_at(system, segment.index.event, segment.mode.field(), segment.end.data(), par.data());
  if (!(std::abs(at.rate()) > tangential * at.sizes())) return false;
  v = at.project(v);
  return v.allFinite();
}

}  // namespace

SimulatedTurn simulate_turn(const HybridSimulation& at, const VectorXd& y, const Signature& expected,
                            SimulationSettings settings, bool with_derivative) {
  const HybridSystem& system = at.system();
  const VectorXd& par = at.parameters();
  TangentFlow tangent(system, par);
  SimulatedTurn turn;
  MatrixXd& v = turn.derivative;
  settings.on_piece = {};
  if (with_derivative) {
    v = jump_at(system, at.last_event().jump, y.data(), par.data()).derivative;
    settings.on_piece = [&](int field, const DenseOutput& state, double from, double to) {
      turn.is_smooth = turn.is_smooth && tangent.carry(v, field, state, from, to);
    };
  }
  HybridSimulation simulation(at, y, std::move(settings));
  for (std::size_t s = 0; s < expected.size(); ++s) {
    turn.segments.push_back(simulation.next(endless));
    const SimulatedSegment& segment = turn.segments.back();
    if (segment.ended_by != SegmentEnd::event || segment.index != expected[s]) {
      turn.fault = fmt::format("segment {} does not end as that of the motion", s + 1);
      return turn;
    }
    if (!with_derivative) continue;
    turn.is_smooth = turn.is_smooth && project_on_event(system, segment, par, v);
    if (!turn.is_smooth) {
      turn.fault = fmt::format("segment {} has no finite derivative", s + 1);
      return turn;
    }
    if (s + 1 < expected.size()) v = jump_at(system, segment.index.jump, segment.end.data(), par.data()).derivative * v;
  }
  return turn;
}

}  // namespace tchat
