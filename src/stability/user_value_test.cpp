#include "stability/user_value_test.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "orbit/orbit.hpp"

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

}  // namespace tchat
