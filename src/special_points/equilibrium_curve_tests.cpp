#include "special_points/equilibrium_curve_tests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bvp/orbit_accuracy.hpp"
#include "stability/equilibrium_eigenvalues.hpp"
#include "stability/lyapunov_coefficient.hpp"

namespace tchat {

namespace {

using Eigenvalues = std::vector<std::complex<double>>;

/// Of differences that a coefficient is made of.
constexpr double difference_accuracy = 1e-8;

double largest_modulus(const Eigenvalues& values) {
  double largest = 0.0;
  for (const auto& value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Without the one that is zero on a fold curve.
Eigenvalues without_zero(Eigenvalues values) {
  const auto zero = std::min_element(values.begin(), values.end(),
                                     [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); });
  if (zero != values.end()) values.erase(zero);
  return values;
}

/// Without the pair that is on the imaginary axis on a Hopf curve.
Eigenvalues without_pair(Eigenvalues values) {
  const EigenvaluePair pair = hopf_pairs(values).nearest;
  for (const auto& value : {pair.first, pair.second})
    if (const auto at = std::find(values.begin(), values.end(), value); at != values.end()) values.erase(at);
  return values;
}

}  // namespace

TestValue EquilibriumCuspTest::evaluate(const TestedPoint&) const {
  return TestValue::of(condition_.cusp_function(), orbit_accuracy);
}

TestValue DoubleZeroTest::evaluate(const TestedPoint&) const {
  return TestValue::of(condition_.multiplicity_function(), orbit_accuracy);
}

TestValue ZeroFrequencyTest::evaluate(const TestedPoint&) const {
  return TestValue::of(condition_.relative_square(), orbit_accuracy);
}

/// omega with the sign of the determinant, which alone may be normalised to a jump. Elsewhere a curve that crosses is
/// none of a double eigenvalue 0.
TestValue MirroredFrequencyTest::evaluate(const TestedPoint& point) const {
  constexpr double nearby = 0.1;
  constexpr double level = 1e-7;  // the root of what rounding makes of omega^2
  const double square = std::abs(condition_.relative_square());
  const TestValue omega = TestValue::of(std::copysign(std::sqrt(square), point.singular_distance), level);
  return square < nearby ? omega : TestValue::undefined(omega.sign);
}

/// omega is known to the accuracy of its location.
bool MirroredFrequencyTest::is_genuine(const TestedPoint&) const {
  constexpr double at_double_zero = 1e-10;
  return std::abs(condition_.relative_square()) <= at_double_zero;
}

TestValue PassedFrequencyTest::evaluate(const TestedPoint&) const {
  constexpr double level = 1e-5;  // at a located point of another kind it is none
  return TestValue::of(condition_.turning(), level);
}

TestValue FoldHopfTest::evaluate(const TestedPoint& point) const {
  const Eigenvalues others = without_zero(point.multipliers.values);
  if (!point.multipliers.valid || others.size() < 2) return TestValue::undefined();
  const HopfPairs pairs = hopf_pairs(others);
  return TestValue::of(pairs.sign * pairs.nearest.distance, orbit_accuracy);
}

bool FoldHopfTest::is_genuine(const TestedPoint& point) const {
  return hopf_pairs(without_zero(point.multipliers.values)).nearest.is_oscillation();
}

SpecialPoint FoldHopfTest::classify(const TestedPoint& point, bool) const {
  const EigenvaluePair pair = hopf_pairs(without_zero(point.multipliers.values)).nearest;
  return {
      PointType::zero_hopf, {}, false, fmt::format("zero-Hopf point, omega = {:.10g}", std::abs(pair.first.imag()))};
}

TestValue HopfFoldTest::evaluate(const TestedPoint& point) const {
  const Eigenvalues others = without_pair(point.multipliers.values);
  if (!point.multipliers.valid || others.empty()) return TestValue::undefined();
  double least = std::abs(others.front());
  double sign = 1.0;
  for (const auto& value : others) {
    least = std::min(least, std::abs(value));
    if (value.imag() == 0.0 && value.real() < 0.0) sign = -sign;
  }
  return TestValue::of(sign * least / largest_modulus(point.multipliers.values), orbit_accuracy);
}

SpecialPoint HopfFoldTest::classify(const TestedPoint&, bool) const {
  const double square = condition_.square();
  return {
      PointType::zero_hopf, {}, false, fmt::format("zero-Hopf point, omega = {:.10g}", std::sqrt(std::abs(square)))};
}

/// Scaled to omega, with which it goes to infinity at a Bogdanov-Takens point.
TestValue BautinTest::evaluate(const TestedPoint& point) const {
  const double square = condition_.square();
  if (!(square > 0.0)) return TestValue::undefined();
  const double omega = std::sqrt(square);
  const double coefficient = omega * first_lyapunov_coefficient(point.condensed.system(), point.orbit, omega);
  if (!std::isfinite(coefficient)) return TestValue::undefined();
  return TestValue::of(coefficient, difference_accuracy);
}

}  // namespace tchat
