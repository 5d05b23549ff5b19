#include "continuation/step_size.hpp"

#include <algorithm>
#include <cmath>

namespace tchat {

StepSize::StepSize(const StepSettings& settings) : settings_(settings), ds_(settings.initial) {}

double StepSize::smallest() const {
  return std::max(settings_.minimum, 1e-10 * std::max(std::abs(settings_.initial), settings_.maximum));
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
