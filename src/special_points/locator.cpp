#include "special_points/locator.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <stdexcept>

namespace tchat {

namespace {

/// Values at a zero, bracketed this finely, are a smaller share of those at the ends.
constexpr double jump_share = 0.05;

/// Leaves Boost's iteration when a trial step fails; never seen outside this file.
struct StepFailed : std::exception {};

}  // namespace

LocatedZero locate_zero(const std::function<std::optional<double>(double)>& function, double ds, double f0, double f1,
                        double tolerance, double rounding_level, int max_evaluations) {
  LocatedZero best{0.0, f0, 0, false};
  if (!(f0 * f1 < 0.0)) return best;
  if (std::abs(f1) < std::abs(f0)) best = {ds, f1, 0, false};
  const auto trial = [&](double at) {
    const std::optional<double> value = function(at);
    ++best.evaluations;
    if (!value || !std::isfinite(*value)) throw StepFailed{};
    if (std::abs(*value) < std::abs(best.value)) best.ds = at, best.value = *value;
    return std::abs(*value) <= rounding_level ? 0.0 : *value;  // an exact zero ends the iteration
  };
  const auto done = [&](double a, double b) { return std::abs(b - a) <= tolerance; };
  try {
    auto evaluations = static_cast<std::uintmax_t>(std::max(max_evaluations, 2));
    const double low = std::min(0.0, ds);
    const double high = std::max(0.0, ds);
    const double f_low = ds > 0.0 ? f0 : f1;
    const double f_high = ds > 0.0 ? f1 : f0;
    const auto bracket = boost::math::tools::toms748_solve(trial, low, high, f_low, f_high, done, evaluations);
    // A jump also changes sign, but its values do not shrink with the bracket.
    const bool is_zero = std::abs(best.value) <= jump_share * std::min(std::abs(f0), std::abs(f1)) ||
                         std::abs(best.value) <= rounding_level;
    best.converged = is_zero && done(bracket.first, bracket.second);
  } catch (const StepFailed&) {
    // Close to a branch point no step converges; the best value may already be near enough, judged by the mean slope.
    best.converged = best.evaluations > 0 && std::abs(best.value * ds) <= tolerance * std::abs(f1 - f0);
  }
  return best;
}

}  // namespace tchat
