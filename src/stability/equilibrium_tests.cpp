#include "stability/equilibrium_tests.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "orbit/orbit.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/equilibrium_eigenvalues.hpp"
#include "stability/normal_form_text.hpp"

namespace tchat {

TestValue HopfTest::evaluate(const TestedPoint& point) const {
  if (!point.multipliers.valid) return TestValue::undefined();
  const HopfPairs pairs = hopf_pairs(point.multipliers.values);
  return TestValue::of(pairs.sign * pairs.nearest.distance, orbit_accuracy);
}

bool HopfTest::is_genuine(const TestedPoint& point) const {
  return hopf_pairs(point.multipliers.values).nearest.is_oscillation();
}

SpecialPoint HopfTest::classify(const TestedPoint& point, bool) const {
  const double omega = std::abs(hopf_pairs(point.multipliers.values).nearest.first.imag());
  return {PointType::hopf,
          {},
          stop_,
          fmt::format("Hopf bifurcation, omega = {:.10g}, period {:.10g}", omega, 2.0 * std::numbers::pi / omega),
          {},
          hopf_text(point, omega)};
}

std::string BoundaryEquilibriumTest::name() const { return fmt::format("h{} at the equilibrium", event_); }

TestValue BoundaryEquilibriumTest::evaluate(const TestedPoint& point) const {
  const HybridSystem& problem = system_.system();
  return TestValue::of(problem.event(event_, point.orbit.end(0), point.orbit.par.data()),
                       orbit_accuracy * event_scale(problem, point.orbit, event_));
}

SpecialPoint BoundaryEquilibriumTest::classify(const TestedPoint& point, bool rising) const {
  const HybridSystem& problem = system_.system();
  return {PointType::user,
          {UserPointKind::boundary_equilibrium, 1, event_, 0.0},
          stop_ && !rising,
          fmt::format("boundary equilibrium: contact with event {} ({}), {}", event_,
                      problem.function_name(FunctionKind::event, event_),
                      state_text(problem, point.orbit, point.orbit.end(0)))};
}

}  // namespace tchat
