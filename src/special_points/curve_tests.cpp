#include "special_points/curve_tests.hpp"

#include <cmath>

namespace tchat {

std::optional<double> ResonanceTest::value(const TestedPoint& point) const {
  constexpr double grazing_level = 1e-6;
  double result = condition_.multiplicity_function();
  for (const double a : point.transversalities) {
    if (std::abs(a) < grazing_level) return std::nullopt;
    result *= a;
  }
  return result;
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
