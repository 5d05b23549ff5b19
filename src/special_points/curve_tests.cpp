#include "special_points/curve_tests.hpp"

#include <cmath>

#include "bvp/critical_multiplier.hpp"
#include "bvp/critical_pair.hpp"
#include "bvp/orbit_accuracy.hpp"
#include "bvp/transversality.hpp"

namespace tchat {

namespace {

/// The condition that the curve's problem type has made.
template <class Condition>
const Condition& condition_at(const TestedPoint& point) {
  return static_cast<const Condition&>(*point.condition);
}

constexpr double at_resonance = 1e-6;  // of the cosine at a located resonance

bool has_double_multiplier(const TestedPoint& point) {
  return std::abs(std::abs(condition_at<CriticalPair>(point).cosine()) - 1.0) <= at_resonance;
}

PointType double_resonance(const TestedPoint& point) {
  return condition_at<CriticalPair>(point).cosine() > 0.0 ? PointType::resonance_1 : PointType::resonance_2;
}

}  // namespace

/// The zero level is against the sizes of the two vectors.
TestValue CuspTest::evaluate(const TestedPoint& point) const {
  const auto& condition = condition_at<CriticalMultiplier>(point);
  const OrbitVector& gradient = condition.gradient(0);
  const OrbitVector& v = condition.null_vector();
  return TestValue::of(condition.cusp_function(), orbit_accuracy * std::sqrt(dot(gradient, gradient) * dot(v, v)));
}

/// The zero level is against the a_s, with which the function and the factors that it is multiplied by vanish.
TestValue ResonanceTest::evaluate(const TestedPoint& point) const {
  double result = condition_at<RealMultiplierCondition>(point).multiplicity_function();
  double level = orbit_accuracy;
  for (const double a : point.transversalities) {
    if (std::abs(a) <= no_transversality) return TestValue::undefined();
    result *= a;
    level *= a * a;
  }
  return TestValue::of(result, level);
}

std::string AngleTest::name() const {
  switch (type_) {
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

TestValue AngleTest::evaluate(const TestedPoint& point) const {
  const double cosine = condition_at<CriticalPair>(point).cosine();
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
  const double square = 2.0 * std::abs(std::abs(condition_at<CriticalPair>(point).cosine()) - 1.0);
  const TestValue angle = TestValue::of(std::copysign(std::sqrt(square), point.singular_distance), level);
  return square < 2.0 * nearby ? angle : TestValue::undefined(angle.sign);
}

bool MirroredResonanceTest::is_genuine(const TestedPoint& point) const { return has_double_multiplier(point); }

SpecialPoint MirroredResonanceTest::classify(const TestedPoint& point, bool) const {
  const PointType type = double_resonance(point);
  return {type, {}, true, AngleTest(type).name() + ", where the torus curve ends: it meets its mirror image"};
}

TestValue PassedResonanceTest::evaluate(const TestedPoint& point) const {
  constexpr double level = 1e-5;  // at a located resonance of another kind it is none
  return TestValue::of(condition_at<CriticalPair>(point).turning(), level);
}

SpecialPoint PassedResonanceTest::classify(const TestedPoint& point, bool) const {
  const PointType type = double_resonance(point);
  return {type, {}, false, AngleTest(type).name() + ", which the angle passes: two eigenvectors, the curve goes on"};
}

}  // namespace tchat
