/// The pair of multipliers that a torus curve begins with.
#pragma once

#include <complex>

namespace tchat {

class DefiningSystem;
struct SelectedStart;

/// The complex multiplier of the uncorrected start that is nearest to the unit circle; at a 1:1 or 1:2 resonance, where
/// the pair may have become real by rounding, one beside it. Throws UserError where there is none.
std::complex<double> pair_at(const DefiningSystem& defining, const SelectedStart& selected);

}  // namespace tchat
