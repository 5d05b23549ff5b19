/// What a simulation has settled on.
///
/// periodic        its events repeat (simulation/recurrence.hpp)
/// chaotic         they do not, and an exponent is positive by more than three error bars
/// quasi-periodic  they do not, two exponents are zero within their bars and none is positive
/// rest            the events get ever slower, or there are none any more and all exponents are negative
/// chattering      events accumulate, or a contact lasts
/// escape          a state beyond all bounds, or no event any more
/// none            it has not repeated itself and exponents were not wanted or do not tell; interrupted; failed
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "attractor/attractor_kind.hpp"
#include "attractor/lyapunov_exponents.hpp"
#include "hybrid/index_vector.hpp"
#include "simulation/hybrid_simulation.hpp"
#include "simulation/simulation_run.hpp"

namespace tchat {

struct Attractor {
  AttractorKind kind = AttractorKind::none;
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
  /// Where exponents are to decide and a number of events is given, at most as many more are simulated for them.
  SimulationPlan plan;
  LyapunovSettings lyapunov;
  /// Exponents are computed: never, where the motion does not repeat itself (to tell quasi-periodic from chaotic), or
  /// always.
  enum class Exponents { never, to_decide, always } exponents = Exponents::to_decide;
  double escape = 1e6;  ///< |x_i| above this is beyond all bounds, except for states that nothing depends on
};

/// How many exponents of a flow are positive, zero, negative, as far as their bars tell.
struct ExponentSigns {
  int positive = 0;  ///< by more than three bars
  int zero = 0;      ///< within three bars, which are small against the other exponents or the frequency of events
  int negative = 0;
  int unclear = 0;
};
ExponentSigns signs_of(const LyapunovSpectrum& spectrum);

/// By the exponents of the flow (not of a section): chaotic, quasi_periodic (two zero, none positive), periodic (one
/// zero, the next negative), rest (all negative); none where bars are too large to tell.
AttractorKind kind_by_exponents(const LyapunovSpectrum& spectrum);

/// Simulates from x0 and says what the motion has settled on. `kept`, if given, is handed every segment after the
/// transient. Throws as HybridSimulation does.
Attractor recognise_attractor(const ModeRule& rule, const Eigen::VectorXd& x0, const Eigen::VectorXd& par,
                              const SimulationSettings& simulation, const RecognitionSettings& settings,
                              const std::function<void(const SimulatedSegment&)>& kept = {});

}  // namespace tchat
