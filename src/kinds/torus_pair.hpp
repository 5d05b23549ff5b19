/// The pair of multipliers that a torus curve begins with.
#pragma once

#include <complex>

namespace tchat {

class DefiningSystem;
struct SelectedStart;

/// The complex multiplier of the uncorrected start that is nearest to the unit circle; at a 1:1 or 1:2 resonance, where
/// the pair may have become real by rounding, one beside it. Throws UserError where there is none.
std::complex<double> pair_at(const DefiningSystem& defining, const SelectedStart& selected);

/// The cosine of its angle, which a curve in three parameters keeps; at a strong resonance its exact value.
///
/// Count. N unknowns and N equations of the orbit, as ever, three parameters: N + 3 unknowns. Product one, the cosine
/// of the angle, and pseudo-arclength: N + 3 equations. Throws UserError at a 1:1 or 1:2 resonance, where the pair has
/// no angle to keep.
double fixed_cosine(const DefiningSystem& defining, const SelectedStart& start);

}  // namespace tchat
