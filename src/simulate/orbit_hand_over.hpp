/// A periodic orbit or equilibrium found by simulation as the start of a continuation.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "motion/found_orbit.hpp"
#include "motion/hybrid_simulation.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// The part of a motion from which a periodic orbit near it is looked for, whatever becomes of the motion later: an
// unstable orbit is left, but one period of a motion that begins near it stays near.

struct RecordedPeriod {
  std::vector<SimulatedSegment> segments;  ///< empty: none
  Eigen::VectorXd size;                    ///< largest |x_i| up to its end, n; infinite for those in `ignorable`
};

/// The segments between two equal events, the first one that is met and the one after which the state is nearest to
/// that behind the first, as a share of the motion's range; a shorter part that is half as near goes before. With
/// `events` the segments between the first event and so many later. States in `ignorable`, from 0, are not compared.
/// None when no event comes again, or that many later is not the same.
RecordedPeriod recorded_period(const std::vector<SimulatedSegment>& segments, std::optional<long> events,
                               const std::vector<Eigen::Index>& ignorable);

// A periodic orbit or an equilibrium found by simulation as the start of a continuation: NAME2.dat and the constants
// file gc.NAME2.

/// The .dat file: `# PAR(k) = v` for all parameters and durations, then the rows.
std::string orbit_data_text(const HybridSystem& system, const FoundOrbit& orbit, const OrbitSamples& samples,
                            const Eigen::VectorXd& par);

/// Constants for the orbit: the mesh of the samples, `base` (numerical constants, weights, bounds where they still make
/// sense) with the signature found, `parameter` and all durations free, and on each segment those event functions of
/// its mode monitored that are not negative anywhere on it and no Poincare sections (identity jump, and the same field
/// after it). GRJUMP, unless `base` has another than its default, is the jump of the monitored walls where that is one.
RunSettings orbit_settings(const HybridSystem& system, const RunSettings& base, const FoundOrbit& orbit,
                           const OrbitSamples& samples, const Eigen::VectorXd& par, int parameter);

/// What `orbit_settings` starts from where there is no constants file: the command line's constants in `given`, and
/// sensible ones where it left the defaults.
RunSettings default_orbit_settings(const RunSettings& given);

/// An equilibrium in a field: the .dat file, and constants with `parameter` free that monitor those of `events` whose
/// functions are positive at x.
std::string equilibrium_data_text(const HybridSystem& system, const Eigen::VectorXd& x, const Eigen::VectorXd& par);
RunSettings equilibrium_settings(const HybridSystem& system, const RunSettings& base, int field,
                                 const std::vector<int>& events, const Eigen::VectorXd& x, const Eigen::VectorXd& par,
                                 int parameter);

/// What to say of events of an orbit's modes that the constants do not monitor, for they are negative on their segment:
/// a switch of the wrong sign shows so. "" when there are none.
std::string unmonitored_events(const HybridSystem& system, const FoundOrbit& orbit, const OrbitSamples& samples,
                               const Eigen::VectorXd& par);

}  // namespace tchat
