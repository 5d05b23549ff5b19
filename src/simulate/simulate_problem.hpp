/// The command `tchat simulate` without its command line, and its measurement of Lyapunov exponents.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <string>

#include "motion/attractor_search.hpp"
#include "motion/lyapunov_exponents.hpp"
#include "simulate/simulation_start.hpp"

namespace tchat {

// Lyapunov exponents of a `tchat simulate`: how long they are averaged, and how they are told.

/// Null when none are wanted. Throws UserError when there are not so many, or the section does not exist.
std::unique_ptr<LyapunovAccumulator> exponents_to_measure(const SimulationRequest& request, const HybridSystem& system,
                                                          const Eigen::VectorXd& par);

/// Without a wanted length the simulation goes on from where `result` left it, until the bars are small enough, at most
/// 100000 events. The exponents for people, with a line that says what they mean, given what `search` has found; it is
/// shown what follows. On a stable `orbit` that shooting has found bars are no less than the distance from ln |mu| / T:
/// a weakly stable motion is off by the error of its integration by its exponent. `settings` are those of the
/// simulation. `progress` may be null.
std::string exponents_of(const SimulationRequest& request, const SimulationResult& result, HybridSimulation& simulation,
                         LyapunovAccumulator& exponents, AttractorSearch& search, const FoundOrbit& orbit,
                         const SimulationSettings& settings, std::ostream* progress);

/// What is known of a motion beside its exponents.
struct MotionEvidence {
  std::optional<SettledOrbit> orbit;  ///< that it has settled on, or keeps to
  std::string doubt;                  ///< why the exponents do not tell what the motion is; ""
};
/// The table of exponents and what they mean.
std::string spectrum_text(const HybridSystem& system, const LyapunovSpectrum& spectrum, int section,
                          const MotionEvidence& evidence);

// `tchat simulate` without the command line: constants -> plugin -> start -> simulation -> orbit -> files.

/// Simulates, writes O.trajectory and O.events, with hand_over also NAME2.dat and gc.NAME2; prints a summary to
/// `screen` (nothing when quiet). `progress`, if given, is told about long work. Returns 0; 1 when hand_over was asked
/// and there is no periodic orbit, or the integration failed. Throws UserError for what is wrong with the input,
/// ComputationError when files cannot be written.
int simulate_problem(const SimulationRequest& request, std::ostream& screen, std::ostream& warnings,
                     const std::function<bool()>& interrupted, std::ostream* progress);

}  // namespace tchat
