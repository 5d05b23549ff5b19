#include "orbit/unfolded_system.hpp"
#include "orbit/coupling.hpp"

#include <algorithm>

namespace tchat {

UnfoldedSystem::UnfoldedSystem(std::unique_ptr<DefiningSystem> ring)
    : DefiningSystem(ring->system(), ring->signature(), ring->free_parameters()), ring_(std::move(ring)) {
  std::ptrdiff_t rows = 0;
  for (int s = 0; s < segments(); ++s) {
    first_rows_.push_back(rows);
    rows += ring_->coupling_rows(s);
  }
  direction_.assign(static_cast<std::size_t>(rows), 0.0);
}

void UnfoldedSystem::coupling_pattern(int s, CouplingPattern& pattern) const {
  ring_->coupling_pattern(s, pattern);
  pattern.global(0, coupling_rows(s), free_count() - 1);
}

void UnfoldedSystem::add(int s, const Orbit& x, double* values) const {
  const double b = x.par(layout().unfolding(segments()) - 1);
  for (int r = 0; r < coupling_rows(s); ++r) values[r] += b * direction_of(s)[r];
}

void UnfoldedSystem::coupling_values(int s, const Orbit& x, double* values) const {
  ring_->coupling_values(s, x, values);
  add(s, x, values);
}

double* UnfoldedSystem::coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const {
  entries = ring_->coupling_derivatives(s, x, values, entries);
  add(s, x, values);
  return std::copy_n(direction_of(s), coupling_rows(s), entries);
}

}  // namespace tchat
