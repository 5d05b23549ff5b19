#include "stability/label_evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "orbit/admissibility.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

namespace {

using Complex = std::complex<double>;

/// The rule of the column PT: |mu| <= 1 + 1e-5 is stable. Closer to the circle nothing is decided.
constexpr double stability_margin = 1e-5;

bool is_known(const FloquetMultipliers& multipliers) {
  return multipliers.determined() && multipliers.structural <= structural_bound;
}

double doubt_of_stability(const FloquetMultipliers& multipliers) {
  if (multipliers.are_eigenvalues) return orbit_accuracy * largest_modulus(multipliers.nontrivial());
  return std::max(stability_margin, multiplier_accuracy(multipliers));
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

double largest_modulus(std::span<const Complex> values) {
  double largest = 0.0;
  for (const Complex& value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

double stability_excess(const FloquetMultipliers& multipliers, const Complex& mu) {
  return multipliers.are_eigenvalues ? mu.real() : std::abs(mu) - 1.0;
}

double multiplier_accuracy(const FloquetMultipliers& multipliers) {
  return std::max(orbit_accuracy, multipliers.are_eigenvalues ? 0.0 : multipliers.structural);
}

double multiplier_distance(const FloquetMultipliers& multipliers, double target) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Complex& mu : multipliers.nontrivial()) nearest = std::min(nearest, std::abs(mu - target));
  return nearest;
}

int touching_segment(const TestedPoint& point) {
  constexpr double tangent = 1e-4;
  for (std::size_t s = 0; s < point.transversalities.size(); ++s)
    if (std::abs(point.transversalities[s]) < tangent) return static_cast<int>(s);
  return -1;
}

std::string objection_without_multiplier(const TestedPoint& point, int target, const std::string& what) {
  const FloquetMultipliers& multipliers = point.multipliers;
  if (!point.one_parameter_family || multipliers.are_eigenvalues || !multipliers.determined()) return "";
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

}  // namespace tchat
