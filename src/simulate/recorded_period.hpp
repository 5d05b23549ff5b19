/// The part of a motion from which a periodic orbit near it is looked for, whatever becomes of the motion later: an
/// unstable orbit is left, but one period of a motion that begins near it stays near.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "motion/hybrid_simulation.hpp"

namespace tchat {

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

}  // namespace tchat
