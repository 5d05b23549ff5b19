/// What a simulation has settled on.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "attractor/lyapunov_exponents.hpp"
#include "hybrid/index_vector.hpp"
#include "simulation/hybrid_simulation.hpp"
#include "simulation/simulation_run.hpp"

namespace tchat {

enum class AttractorKind {
  periodic,        ///< the events repeat: signature and period
  equilibrium,     ///< comes to rest, all exponents negative
  quasi_periodic,  ///< no repetition, two exponents zero at least and none positive
  chaotic,         ///< an exponent is positive
  chattering,      ///< events accumulate: no mode for what follows
  escape,          ///< a state beyond all bounds, or the integration failed on the way there
  no_event,        ///< nothing happens for so long that one gives up
  sticks,          ///< a contact lasts: no mode for what follows
  undecided,       ///< not periodic so far, and the exponents do not tell
  interrupted,
};

/// "periodic", "quasi-periodic", "chaotic", ...
const char* kind_name(AttractorKind kind);

struct Attractor {
  AttractorKind kind = AttractorKind::undecided;
  std::string reason;   ///< a sentence for people: what was seen
  Signature signature;  ///< periodic: the index vectors of one turn, rotated so that the smallest sequence comes first
  double period = 0.0;  ///< periodic: in time; else nan
  Eigen::VectorXd state;               ///< periodic: start of that turn; else the last state
  std::vector<SimulatedSegment> turn;  ///< periodic: its segments in that order
  std::optional<LyapunovSpectrum> spectrum;
  SimulatedSegment last;  ///< of the simulation, whatever ended it: `after`, or `end`, is where to go on from
  long events = 0;        ///< transient included
  double time = 0.0;      ///< likewise
};

struct RecognitionSettings {
  /// Transient and length. With neither time nor events: until the motion repeats itself, at most most_events events.
  SimulationPlan plan;
  LyapunovSettings lyapunov;
  /// Exponents are computed: never, where the motion does not repeat itself (to tell quasi-periodic from chaotic), or
  /// always.
  enum class Exponents { never, to_decide, always } exponents = Exponents::to_decide;
  double escape = 1e6;  ///< |x_i| above this is beyond all bounds, except for states that nothing depends on
};

/// By the exponents of the flow (not of a section): which of chaotic, quasi_periodic, equilibrium; undecided where bars
/// are too large to tell.
AttractorKind kind_by_exponents(const LyapunovSpectrum& spectrum);

/// Simulates from x0 and says what the motion has settled on. `kept`, if given, is handed every segment after the
/// transient. Throws as HybridSimulation does.
Attractor recognise_attractor(const ModeRule& rule, const Eigen::VectorXd& x0, const Eigen::VectorXd& par,
                              const SimulationSettings& simulation, const RecognitionSettings& settings,
                              const std::function<void(const SimulatedSegment&)>& kept = {});

}  // namespace tchat
