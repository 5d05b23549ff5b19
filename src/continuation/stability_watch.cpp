#include "continuation/stability_watch.hpp"

#include <cstdlib>

#include "stability/test_function.hpp"

namespace tchat {

namespace {

/// Multipliers are critical at such a point, or about infinite.
bool explains_change(const SpecialPoint& special) {
  return is_bifurcation(special.type) || special.kind.kind == UserPointKind::impact_velocity ||
         !special.further.empty();
}

}  // namespace

void StabilityWatch::begin(const Point& point) {
  known_.reset();
  if (point.multipliers.determined()) remember(point);
}

/// Overwrites what is known.
void StabilityWatch::remember(const Point& point) {
  if (!known_) known_.emplace();
  known_->parameter = point.parameter;
  known_->multipliers = point.multipliers;
}

std::optional<UnlabelledChange> StabilityWatch::add(const Point& point, bool is_reported) {
  if (explains_change(point.special) || !point.multipliers.determined() || is_reported || !known_) {
    if (explains_change(point.special))
      known_.reset();
    else
      begin(point);
    return std::nullopt;
  }
  const StabilityChange change = stability_change(known_->multipliers, point.multipliers);
  std::optional<UnlabelledChange> result;
  if (change.count != 0)
    result = {{point.number, describe(change, point.multipliers.are_eigenvalues), known_->parameter, point.parameter},
              std::abs(change.count) == 1 && is_through_one(change, point.multipliers.are_eigenvalues)};
  // A multiplier that takes several points to cross is compared with the last point at which its side was known.
  if (result || count_unstable(point.multipliers).undecided <= count_unstable(known_->multipliers).undecided)
    remember(point);
  return result;
}

}  // namespace tchat
