#include "special_points/curve_tests.hpp"

#include <cmath>

#include "bvp/orbit_accuracy.hpp"
#include "bvp/transversality.hpp"

namespace tchat {

namespace {

constexpr double at_resonance = 1e-6;  // of the cosine at a located resonance

bool has_double_multiplier(const CriticalPair& pair) { return std::abs(std::abs(pair.cosine()) - 1.0) <= at_resonance; }

PointType double_resonance(const CriticalPair& pair) {
  return pair.cosine() > 0.0 ? PointType::resonance_1 : PointType::resonance_2;
}

}  // namespace

/// The zero level is against the sizes of the two vectors.
TestValue CuspTest::evaluate(const TestedPoint&) const {
  const OrbitVector& gradient = condition_.gradient(0);
  const OrbitVector& v = condition_.null_vector();
  return TestValue::of(condition_.cusp_function(), orbit_accuracy * std::sqrt(dot(gradient, gradient) * dot(v, v)));
}

/// The zero level is against the a_s, with which the function and the factors that it is multiplied by vanish.
TestValue ResonanceTest::evaluate(const TestedPoint& point) const {
  double result = condition_.multiplicity_function();
  double level = orbit_accuracy;
  for (const double a : point.transversalities) {
    if (std::abs(a) <= no_transversality) return TestValue::undefined();
    result *= a;
    level *= a * a;
  }
  return TestValue::of(result, level);
}

namespace {

std::string resonance_name(PointType type) {
  switch (type) {
    case PointType::resonance_1:
      return "1:1 resonance";
    case PointType::resonance_2:
      return "1:2 resonance";
    case PointType::resonance_3:
      return "1:3 resonance";
    default:
      return "1:4 resonance";
  }
}

}  // namespace

std::string AngleTest::name() const { return resonance_name(type_); }

TestValue AngleTest::evaluate(const TestedPoint&) const {
  const double cosine = condition_.cosine();
  const auto above = [cosine](double resonant) { return TestValue::of(cosine - resonant, orbit_accuracy); };
  switch (type_) {
    case PointType::resonance_1:
      return above(1.0);
    case PointType::resonance_2:
      return above(-1.0);
    case PointType::resonance_3:
      return above(-0.5);
    default:
      return above(0.0);
  }
}

Resolution AngleTest::resolution() const {
  const bool double_multiplier = type_ == PointType::resonance_1 || type_ == PointType::resonance_2;
  return double_multiplier ? Resolution::direction : Resolution::crossings;
}

SpecialPoint AngleTest::classify(const TestedPoint&, bool) const {
  const bool double_multiplier = type_ == PointType::resonance_1 || type_ == PointType::resonance_2;
  return {type_, {}, double_multiplier, name() + (double_multiplier ? ", where the torus curve ends" : "")};
}

/// The angle from 0 or pi with the sign of the determinant, which alone may be normalised to a jump. Elsewhere a curve
/// that crosses is none of a resonance.
TestValue MirroredResonanceTest::evaluate(const TestedPoint& point) const {
  constexpr double nearby = 0.5;
  constexpr double level = 1e-6;  // the root of what rounding makes of a cosine
  const double square = 2.0 * std::abs(std::abs(condition_.cosine()) - 1.0);
  const TestValue angle = TestValue::of(std::copysign(std::sqrt(square), point.singular_distance), level);
  return square < 2.0 * nearby ? angle : TestValue::undefined(angle.sign);
}

bool MirroredResonanceTest::is_genuine(const TestedPoint&) const { return has_double_multiplier(condition_); }

SpecialPoint MirroredResonanceTest::classify(const TestedPoint&, bool) const {
  const PointType type = double_resonance(condition_);
  return {type, {}, true, resonance_name(type) + ", where the torus curve ends: it meets its mirror image"};
}

TestValue PassedResonanceTest::evaluate(const TestedPoint&) const {
  constexpr double level = 1e-5;  // at a located resonance of another kind it is none
  return TestValue::of(condition_.turning(), level);
}

SpecialPoint PassedResonanceTest::classify(const TestedPoint&, bool) const {
  const PointType type = double_resonance(condition_);
  return {type, {}, false, resonance_name(type) + ", which the angle passes: two eigenvectors, the curve goes on"};
}

}  // namespace tchat
