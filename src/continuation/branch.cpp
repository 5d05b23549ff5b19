#include "continuation/branch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/levels.hpp"

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
  if (explains_change(point.special)) {
    known_.reset();
    return std::nullopt;
  }
  if (!point.multipliers.determined()) {
    if (is_reported) known_.reset();
    return std::nullopt;
  }
  if (is_reported || !known_) {
    remember(point);
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

StepSize::StepSize(const StepSettings& settings) : settings_(settings), ds_(settings.initial) {}

double StepSize::smallest() const {
  return std::max(settings_.minimum, level::converged * std::max(std::abs(settings_.initial), settings_.maximum));
}

bool StepSize::is_short() const {
  return settings_.adapt_every == 0 || std::abs(ds_) < 1e-2 * std::min(std::abs(settings_.initial), settings_.maximum);
}

bool StepSize::adapts_at(int point) const { return settings_.adapt_every != 0 && point % settings_.adapt_every == 0; }

bool StepSize::is_longest() const { return std::abs(ds_) >= settings_.maximum; }

double StepSize::after(int iterations) const {
  double factor = 1.0;
  if (iterations <= 1)
    factor = 2.0;
  else if (iterations == 2)
    factor = 1.5;
  else if (iterations >= settings_.max_newton)
    factor = 0.5;
  else if (iterations <= settings_.max_newton / 2)
    factor = 1.1;
  return std::copysign(std::min(std::abs(ds_) * factor, settings_.maximum), ds_);
}

void StepSize::converged(int iterations, int point) {
  if (adapts_at(point)) ds_ = after(iterations);
}

bool StepSize::failed() {
  if (settings_.adapt_every == 0) return false;
  ds_ *= 0.5;
  return std::abs(ds_) >= smallest();
}

}  // namespace tchat
