/// Comparison of sets of multipliers, in whatever order they come.
#pragma once

#include <algorithm>
#include <complex>
#include <limits>
#include <vector>

namespace tchat::test {

using Multipliers = std::vector<std::complex<double>>;

/// Largest |found - expected| / scale(expected) under the best of the greedy one-to-one matchings: expected values are
/// served in order of size, largest first. Infinite when the numbers differ.
template <class Scale>
double matched_distance(Multipliers found, Multipliers expected, const Scale& scale) {
  if (found.size() != expected.size()) return std::numeric_limits<double>::infinity();
  const auto larger = [](const auto& a, const auto& b) { return std::abs(a) > std::abs(b); };
  std::stable_sort(expected.begin(), expected.end(), larger);
  double worst = 0.0;
  for (const std::complex<double>& mu : expected) {
    const auto nearer = [&](const auto& a, const auto& b) { return std::abs(a - mu) < std::abs(b - mu); };
    const auto nearest = std::min_element(found.begin(), found.end(), nearer);
    const double distance = std::abs(*nearest - mu) / scale(mu);
    worst = std::max(worst, std::isnan(distance) ? std::numeric_limits<double>::infinity() : distance);
    found.erase(nearest);
  }
  return worst;
}

inline double absolute_distance(const Multipliers& found, const Multipliers& expected) {
  return matched_distance(found, expected, [](const auto&) { return 1.0; });
}

/// Relative to max(1, |mu|).
inline double mixed_distance(const Multipliers& found, const Multipliers& expected) {
  return matched_distance(found, expected, [](const auto& mu) { return std::max(1.0, std::abs(mu)); });
}

/// Relative to |mu|; both sets without zeros.
inline double relative_distance(const Multipliers& found, const Multipliers& expected) {
  return matched_distance(found, expected, [](const auto& mu) { return std::abs(mu); });
}

/// The n - 1 multipliers besides the structural zero, which is listed with the value `structural`.
inline Multipliers nontrivial(Multipliers values, double structural) {
  const auto zero = std::find(values.begin(), values.end(), std::complex<double>(structural));
  if (zero != values.end()) values.erase(zero);
  return values;
}

}  // namespace tchat::test
