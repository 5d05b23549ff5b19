/// What the signs of Lyapunov exponents say of a motion.
#pragma once

#include <string>

#include "motion/attractor_kind.hpp"
#include "motion/growth_series.hpp"

namespace tchat {

/// How many exponents of a flow are positive, zero, negative, as far as their bars tell. Those that are zero whatever
/// the motion does are not counted.
struct ExponentSigns {
  int positive = 0;  ///< by more than three bars
  int zero = 0;      ///< within three bars, which are small against the other exponents or the frequency of events
  int negative = 0;
  int unclear = 0;
};
ExponentSigns signs_of(const LyapunovSpectrum& spectrum);

/// chaotic (one is positive), quasi_periodic (one is zero, none positive), periodic (all negative, beside the one along
/// the flow), rest (all negative and none along the flow); none where bars are too large to tell. This does not tell a
/// slow transient from a motion that stays: motion/attractor_search.hpp comes first.
AttractorKind kind_by_exponents(const LyapunovSpectrum& spectrum);

/// "0.01234 (bar 2e-05), -0.1 (bar 1e-05)": the two largest that are not zero whatever the motion does.
std::string largest_exponents_text(const LyapunovSpectrum& spectrum);

}  // namespace tchat
