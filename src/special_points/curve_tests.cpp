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

std::optional<double> AngleTest::value(const TestedPoint&) const {
  constexpr double pi = 3.14159265358979323846;
  return std::arg(condition_.multiplier()) - (type_ == PointType::resonance_3 ? 2.0 * pi / 3.0 : pi / 2.0);
}

}  // namespace tchat
