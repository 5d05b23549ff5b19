#include "stability/test_function.hpp"

#include <fmt/format.h>

#include <boost/math/tools/toms748_solve.hpp>
#include <limits>
#include <stdexcept>

#include "base/levels.hpp"
#include "orbit/admissibility.hpp"

namespace tchat {

std::string UserValueTest::name() const { return fmt::format("{} - {:.10g}", parameter_name_, wanted_); }

/// The zero level is of the parameter's own size, which may be far from 1.
TestValue UserValueTest::evaluate(const TestedPoint& point) const {
  const double parameter = point.orbit.par(parameter_ - 1);
  return TestValue::of(parameter - wanted_, orbit_accuracy * std::max(std::abs(wanted_), std::abs(parameter)));
}

SpecialPoint UserValueTest::classify(const TestedPoint&, bool) const {
  return {PointType::user,
          {UserPointKind::user_value, 0, parameter_, 0.0},
          stop_,
          fmt::format("user value {} = {:.10g}", parameter_name_, wanted_)};
}

namespace {

using Complex = std::complex<double>;

bool is_known(const FloquetMultipliers& multipliers) {
  return multipliers.determined() && multipliers.structural <= structural_bound;
}

double doubt_of_stability(const FloquetMultipliers& multipliers) {
  if (multipliers.are_eigenvalues) return orbit_accuracy * largest_modulus(multipliers.nontrivial());
  return std::max(level::on_circle, multiplier_accuracy(multipliers));
}

/// Those that tell of the orbit, the most unstable one first.
std::vector<Complex> by_excess(const FloquetMultipliers& multipliers) {
  const auto nontrivial = multipliers.nontrivial();
  std::vector<Complex> list(nontrivial.begin(), nontrivial.end());
  std::stable_sort(list.begin(), list.end(), [&](const Complex& a, const Complex& b) {
    return stability_excess(multipliers, a) > stability_excess(multipliers, b);
  });
  return list;
}

}  // namespace

Stability FloquetMultipliers::stability() const {
  if (!valid) return Stability::unknown;
  const double doubt = doubt_of_stability(*this);
  const bool is_doubtful = !are_eigenvalues && doubt > level::on_circle;
  const UnstableCount count = count_unstable(*this);
  if (surely_outside > 0 || (is_doubtful ? count.outside > 0 : !stable())) return Stability::unstable;
  return undetermined > 0 || (is_doubtful && count.undecided > 0) ? Stability::unknown : Stability::stable;
}

bool FloquetMultipliers::neutral() const {
  if (of_conserved > 0 || stability() != Stability::stable) return false;
  const auto own = nontrivial();
  const double accuracy = are_eigenvalues ? orbit_accuracy * largest_modulus(own) : multiplier_accuracy(*this);
  return std::any_of(own.begin(), own.end(),
                     [&](const Complex& mu) { return std::abs(stability_excess(*this, mu)) <= accuracy; });
}

double largest_modulus(std::span<const Complex> values) {
  double largest = 0.0;
  for (const Complex& value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

double stability_excess(const FloquetMultipliers& multipliers, const Complex& mu) {
  return multipliers.are_eigenvalues ? mu.real() : std::abs(mu) - 1.0;
}

double multiplier_accuracy(const FloquetMultipliers& multipliers) {
  if (multipliers.are_eigenvalues) return orbit_accuracy;
  return std::max({orbit_accuracy, multipliers.structural, multipliers.uncertainty});
}

double multiplier_distance(const FloquetMultipliers& multipliers, double target) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Complex& mu : multipliers.nontrivial()) nearest = std::min(nearest, std::abs(mu - target));
  return nearest;
}

int touching_segment(std::span<const double> transversalities) {
  for (std::size_t s = 0; s < transversalities.size(); ++s)
    if (std::abs(transversalities[s]) < level::visible) return static_cast<int>(s);
  return -1;
}

std::string objection_without_multiplier(const TestedPoint& point, int target, const std::string& what) {
  const FloquetMultipliers& multipliers = point.multipliers;
  if (!point.one_parameter_family || multipliers.are_eigenvalues) return "";
  if (multipliers.is_flow_lost)
    return what + ", but the multipliers are not known (errors grow too much along the orbit): no label";
  if (!multipliers.determined()) return "";
  if (touching_segment(point) >= 0) return "";
  const double distance = multiplier_distance(multipliers, target);
  if (multipliers.structural > structural_bound)
    return fmt::format("{}, but the multipliers are not known (structural multiplier {:.1e}): no label", what,
                       multipliers.structural);
  if (distance <= std::max(agreeing_multiplier, multipliers.structural)) return "";
  return fmt::format("{}, but no multiplier is near {:+d} (the nearest is {:.4g} away from it): no label", what, target,
                     distance);
}

UnstableCount count_unstable(const FloquetMultipliers& multipliers) {
  UnstableCount count;
  const double level = doubt_of_stability(multipliers);
  for (const Complex& mu : multipliers.nontrivial()) {
    const double by = stability_excess(multipliers, mu);
    ++(by > level ? count.outside : by < -level ? count.inside : count.undecided);
  }
  return count;
}

StabilityChange stability_change(const FloquetMultipliers& before, const FloquetMultipliers& after) {
  if (!is_known(before) || !is_known(after) || before.nontrivial().size() != after.nontrivial().size()) return {};
  const UnstableCount a = count_unstable(before);
  const UnstableCount b = count_unstable(after);
  StabilityChange change;
  if (b.outside > a.outside + a.undecided) change.count = b.outside - a.outside - a.undecided;
  if (a.outside > b.outside + b.undecided) change.count = b.outside + b.undecided - a.outside;
  if (change.count == 0) return change;
  const auto first = static_cast<std::size_t>(change.count > 0 ? b.outside - 1 : a.outside - 1);
  change.before = by_excess(before)[first];
  change.after = by_excess(after)[first];
  return change;
}

bool is_through_one(const StabilityChange& change, bool are_eigenvalues) {
  const bool is_real = change.before.imag() == 0.0 && change.after.imag() == 0.0;
  return is_real && !are_eigenvalues && change.after.real() > 0.0;
}

std::string describe(const StabilityChange& change, bool are_eigenvalues) {
  const auto text = [](const Complex& mu) {
    return mu.imag() == 0.0
               ? fmt::format("{:.6g}", mu.real())
               : fmt::format("{:.6g} {} {:.6g} i", mu.real(), mu.imag() < 0.0 ? "-" : "+", std::abs(mu.imag()));
  };
  const bool is_real = change.before.imag() == 0.0 && change.after.imag() == 0.0;
  const char* through = are_eigenvalues                           ? "the imaginary axis"
                        : !is_real                                ? "the unit circle"
                        : is_through_one(change, are_eigenvalues) ? "+1"
                                                                  : "-1";
  const std::string kind = are_eigenvalues ? "eigenvalue" : "multiplier";
  const int count = std::abs(change.count);
  const std::string what = count == 1 ? fmt::format("one {} goes", kind) : fmt::format("{} {}s go, one", count, kind);
  return fmt::format("the stability changes without a special point: {} from {} to {}, through {}", what,
                     text(change.before), text(change.after), through);
}

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
    // Whether it is a jump is judged by the change over the whole step. Within a short part of it a jump looks smooth,
    // and the errors of Newton's method look like a jump.
    const bool ended = zero.converged() || zero.status == ZeroSearch::jump;
    const bool nothing = std::abs(zero.value) <= rounding_level;
    if (ended && !nothing) zero.status = is_jump(step, bracket, tolerance) ? ZeroSearch::jump : ZeroSearch::located;
    if (zero.converged() || zero.status == ZeroSearch::jump || !halve(bracket, function)) break;
  }
  // No value is smaller than others where the function only switches.
  if (zero.status == ZeroSearch::jump) zero.ds = bracket.low;
  return zero;
}

}  // namespace tchat
