#include "special_points/user_value_test.hpp"

#include <fmt/format.h>

#include <cmath>

namespace tchat {

std::string UserValueTest::name() const { return fmt::format("{} - {:.10g}", parameter_name_, wanted_); }

std::optional<double> UserValueTest::value(const TestedPoint& point) const {
  return point.orbit.par(parameter_ - 1) - wanted_;
}

double UserValueTest::zero_level(const TestedPoint&) const { return 1e-9 * (1.0 + std::abs(wanted_)); }

SpecialPoint UserValueTest::classify(const TestedPoint&, bool) const {
  return {PointType::user,
          {UserPointKind::user_value, 0, parameter_, 0.0},
          stop_,
          fmt::format("user value {} = {:.10g}", parameter_name_, wanted_)};
}

}  // namespace tchat
