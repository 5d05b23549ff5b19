#include "model/relevant_events.hpp"

#include <algorithm>
#include <set>

#include "model/identity_jump.hpp"

namespace tchat {

bool keeps_field(const HybridSystem& system, const IndexVector& v, int field, const double* x, const double* par) {
  const auto next = system.successors(v, x, par).value_or(std::vector<IndexVector>{});
  return std::any_of(next.begin(), next.end(), [&](const IndexVector& w) { return w.field == field; });
}

std::vector<int> relevant_events(const HybridSystem& system, std::span<const IndexVector> following, int field,
                                 const double* x, const double* par) {
  std::set<int> events;
  for (const IndexVector& v : following)
    if (!is_identity_jump(system, v) || !keeps_field(system, v, field, x, par)) events.insert(v.event);
  return {events.begin(), events.end()};
}

}  // namespace tchat
