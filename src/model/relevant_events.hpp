/// Which of the events that may come next matter: all but Poincare sections.
#pragma once

#include <span>
#include <vector>

#include "model/hybrid_system.hpp"

namespace tchat {

/// Whether `field` goes on after index vector v ends in state x, by the index jump function.
bool keeps_field(const HybridSystem& system, const IndexVector& v, int field, const double* x, const double* par);

/// Event functions of `following`, rising, each once, without those of sections: an identity jump after which, by the
/// index jump function in state x, `field` goes on.
std::vector<int> relevant_events(const HybridSystem& system, std::span<const IndexVector> following, int field,
                                 const double* x, const double* par);

}  // namespace tchat
