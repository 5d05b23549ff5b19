/// Lyapunov exponents along a simulation of a hybrid system: an orthonormal frame is carried along by
///
///     V' = f_x V   on a segment,      V -> S V,  S = g_x + (f+ - g_x f-) h_x / (h_x f-)   at an event       (2.109)
///
/// with f- before and f+ after the jump, and made orthonormal again (Householder QR) at every event and often enough
/// between. Exponents are mean rates of growth, natural logarithms per unit of time. The frame begins with the
/// directions whose exponents are zero whatever the motion does, that of the flow and those of states that nothing
/// depends on, so that the others are measured beside them; the spectrum says which these are (`structural`). Where
/// sliding begins S is singular: a direction is lost and its exponent is minus infinity.
///
/// With a section J, exponents of the return map from one fall of h_J to the next, per return: at each of them
/// V -> (Id - f- h_x / (h_x f-)) V, so that the frame, of n - 1 columns at most, stays tangent to the section and the
/// direction along the flow is projected out. J may be among the events that end segments, or not.
///
/// The tangent flow over one step of the simulation's integrator is the exponential of a Magnus series of sixth order,
/// with f_x at Gauss points of the dense output, its steps halved where the term beyond fourth order says so. So the
/// frame can ride along while the simulation runs: make `attach` of its settings first.
///
///     LyapunovAccumulator exponents(system, par, settings);
///     exponents.attach(simulation_settings);                    // saves a second integration
///     HybridSimulation simulation(rule, x0, par, simulation_settings);
///     exponents.begin();                                        // after the transient
///     exponents.pass(simulation.next(end)); ...
///     exponents.spectrum();
#pragma once

#include <Eigen/Core>
#include <memory>

#include "model/hybrid_system.hpp"
#include "motion/growth_series.hpp"
#include "motion/hybrid_simulation.hpp"
#include "motion/watched_flow.hpp"

namespace tchat {

struct LyapunovSettings {
  int exponents = 0;  ///< the K largest; 0: all, n, or n - 1 of a section
  int section = 0;    ///< event function J of the return map, from 1; 0: of the flow
  FlowOptions flow;   ///< where segments are integrated again; `variational` does not matter
};

class LyapunovAccumulator {
 public:
  /// `par` has the room of the problem's ParameterLayout. A view of `system`, which outlives this object. Throws
  /// UserError when the section does not exist or exponents < 0 or more than there are.
  LyapunovAccumulator(const HybridSystem& system, const Eigen::VectorXd& par, const LyapunovSettings& settings);
  LyapunovAccumulator(const LyapunovAccumulator&) = delete;
  LyapunovAccumulator& operator=(const LyapunovAccumulator&) = delete;
  ~LyapunovAccumulator();

  /// Lets a simulation carry the frame over each piece of flow as it integrates it. It is not copied along with the
  /// settings: this object outlives the simulation.
  void attach(SimulationSettings& settings);
  /// Until now: transient, whose pieces are passed over. Only needed with attach(); pass() begins by itself.
  void begin();

  /// The next segment of the simulation, in order. Carries the frame over what has not been seen by attach():
  /// integrates from its start over its duration. The saltation of its event is applied when the next one begins, whose
  /// field is then known.
  void pass(const SimulatedSegment& segment);

  /// Of what has been passed up to now. `time` is time also with a section; exponents are then per return and `events`
  /// are returns.
  LyapunovSpectrum spectrum() const;
  /// The direction that grows fastest beside those known to have the exponent zero, where the last segment passed has
  /// ended, before its jump: n, of unit length; zero before there is one.
  Eigen::VectorXd growing_direction() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> p_;
};

}  // namespace tchat
