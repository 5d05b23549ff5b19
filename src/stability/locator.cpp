#include "stability/locator.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <stdexcept>

namespace tchat {

namespace {

/// Leaves Boost's iteration when a trial step fails; never seen outside this file.
struct StepFailed : std::exception {};

using Function = std::function<std::optional<double>(double)>;

/// At the middle, or beside it where no step converges or the function is undefined.
bool halve(SignChange& bracket, const Function& function) {
  for (const double share : {0.5, 0.4, 0.6, 0.25, 0.75, 0.1, 0.9}) {
    const double place = bracket.low + share * (bracket.high - bracket.low);
    const std::optional<double> value = function(place);
    if (!value || !std::isfinite(*value) || *value == 0.0) continue;
    bracket.narrow(place, *value);
    return true;
  }
  return false;
}

/// Across a zero the function changes by a share of its change over the step that shrinks with the bracket, no slower
/// than this many times the square root of the bracket's share of the step; across a jump or a pole it does not.
constexpr double slowest = 10.0;
constexpr double most_of_the_change = 0.5;

}  // namespace

bool is_jump(const SignChange& step, const SignChange& bracket, double tolerance) {
  const double share = std::max(bracket.length(), tolerance) / step.length();
  const double limit = std::min(slowest * std::sqrt(share), most_of_the_change);
  // A step as short as the tolerance shows no difference.
  return step.length() > tolerance && bracket.change() > limit * step.change();
}

LocatedZero locate_zero(const Function& function, double ds, double f0, double f1, double tolerance,
                        double rounding_level, int max_evaluations) {
  LocatedZero best{0.0, f0, 0, ZeroSearch::out_of_trials, {0.0, ds, f0, f1}};
  if (!(f0 * f1 < 0.0)) return best;
  const SignChange step = best.bracket;
  if (std::abs(f1) < std::abs(f0)) best.ds = ds, best.value = f1;
  const auto trial = [&](double at) {
    const std::optional<double> value = function(at);
    ++best.evaluations;
    if (!value || !std::isfinite(*value)) throw StepFailed{};
    if (std::abs(*value) < std::abs(best.value)) best.ds = at, best.value = *value;
    if (std::abs(*value) <= rounding_level) return 0.0;  // an exact zero ends the iteration
    best.bracket.narrow(at, *value);
    return *value;
  };
  const auto done = [&](double a, double b) { return std::abs(b - a) <= tolerance; };
  try {
    auto evaluations = static_cast<std::uintmax_t>(std::max(max_evaluations, 2));
    const double low = std::min(0.0, ds);
    const double high = std::max(0.0, ds);
    const double f_low = ds > 0.0 ? f0 : f1;
    const double f_high = ds > 0.0 ? f1 : f0;
    const auto found = boost::math::tools::toms748_solve(trial, low, high, f_low, f_high, done, evaluations);
    if (std::abs(best.value) <= rounding_level)
      best.status = ZeroSearch::located;
    else if (done(found.first, found.second))
      best.status = is_jump(step, best.bracket, tolerance) ? ZeroSearch::jump : ZeroSearch::located;
  } catch (const StepFailed&) {
    // Close to a branch point no step converges; the best value may already be near enough, judged by the mean slope.
    const bool near_enough = best.evaluations > 0 && std::abs(best.value * ds) <= tolerance * std::abs(f1 - f0);
    best.status = near_enough ? ZeroSearch::located : ZeroSearch::step_failed;
  }
  return best;
}

LocatedZero locate_zero_surely(const Function& function, const SignChange& step, double tolerance,
                               double rounding_level, int max_evaluations) {
  constexpr int most_rounds = 60;
  SignChange bracket = step;
  LocatedZero zero;
  for (int round = 0; round < most_rounds; ++round) {
    const double low = bracket.low;
    zero = locate_zero([&](double at) { return function(low + at); }, bracket.high - low, bracket.low_value,
                       bracket.high_value, tolerance, rounding_level, max_evaluations);
    zero.ds += low;
    zero.bracket.low += low;
    zero.bracket.high += low;
    bracket = zero.bracket;
    // A jump may look smooth on a part of the step, where it is all there is.
    const bool nothing = std::abs(zero.value) <= rounding_level;
    if (zero.converged() && !nothing && is_jump(step, bracket, tolerance)) zero.status = ZeroSearch::jump;
    if (zero.converged() || zero.status == ZeroSearch::jump || !halve(bracket, function)) break;
  }
  return zero;
}

}  // namespace tchat
