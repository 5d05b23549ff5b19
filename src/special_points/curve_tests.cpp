#include "special_points/curve_tests.hpp"

#include <cmath>

#include "bvp/transversality.hpp"

namespace tchat {

double CuspTest::zero_level(const TestedPoint&) const {
  const OrbitVector& gradient = condition_.gradient();
  const OrbitVector& v = condition_.null_vector();
  return orbit_accuracy * std::sqrt(dot(gradient, gradient) * dot(v, v));
}

std::optional<double> ResonanceTest::value(const TestedPoint& point) const {
  double result = condition_.multiplicity_function();
  for (const double a : point.transversalities) {
    if (std::abs(a) <= no_transversality) return std::nullopt;
    result *= a;
  }
  return result;
}

/// Against the a_s, with which the function and the factors that it is multiplied by vanish.
double ResonanceTest::zero_level(const TestedPoint& point) const {
  double level = orbit_accuracy;
  for (const double a : point.transversalities) level *= a * a;
  return level;
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

std::optional<double> AngleTest::value(const TestedPoint&) const {
  switch (type_) {
    case PointType::resonance_1:
      return condition_.cosine() - 1.0;
    case PointType::resonance_2:
      return condition_.cosine() + 1.0;
    case PointType::resonance_3:
      return condition_.cosine() + 0.5;
    default:
      return condition_.cosine();
  }
}

SpecialPoint AngleTest::classify(const TestedPoint&, bool) const {
  const bool double_multiplier = type_ == PointType::resonance_1 || type_ == PointType::resonance_2;
  return {type_, {}, double_multiplier, name() + (double_multiplier ? ", where the torus curve ends" : "")};
}

}  // namespace tchat
