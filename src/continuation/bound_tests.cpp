#include "continuation/bound_tests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bvp/orbit_accuracy.hpp"
#include "continuation/solution_measure.hpp"

namespace tchat {

namespace {

/// Bounds as far away are none.
constexpr double no_bound = 1e300;

class BoundTest : public TestFunction {
 public:
  BoundTest(std::string quantity, const char* keyword, double bound)
      : quantity_(std::move(quantity)), keyword_(keyword), bound_(bound) {}

  std::string name() const override { return fmt::format("{} - {}", quantity_, keyword_); }
  TestValue evaluate(const TestedPoint& point) const override {
    const double here = quantity(point);
    return TestValue::of(here - bound_, orbit_accuracy * std::max(std::abs(bound_), std::abs(here)));
  }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::end, {}, true, fmt::format("{} = {:.10g}, the bound {}", quantity_, bound_, keyword_)};
  }

 private:
  virtual double quantity(const TestedPoint& point) const = 0;

  std::string quantity_;
  const char* keyword_;
  double bound_;
};

class ParameterBoundTest final : public BoundTest {
 public:
  ParameterBoundTest(const std::string& name, const char* keyword, double bound, int parameter)
      : BoundTest(name, keyword, bound), parameter_(parameter) {}

 private:
  double quantity(const TestedPoint& point) const override { return point.orbit.par(parameter_ - 1); }

  int parameter_;
};

class MeasureBoundTest final : public BoundTest {
 public:
  MeasureBoundTest(const char* keyword, double bound, int measure, Eigen::VectorXd weights)
      : BoundTest("the solution measure", keyword, bound), measure_(measure), weights_(std::move(weights)) {}

 private:
  double quantity(const TestedPoint& point) const override {
    return solution_measure(point.orbit, point.condensed.rule(), weights_, measure_);
  }

  int measure_;
  Eigen::VectorXd weights_;
};

}  // namespace

std::vector<std::unique_ptr<TestFunction>> bound_tests(const ContinuationSettings& settings,
                                                       const std::string& parameter) {
  std::vector<std::unique_ptr<TestFunction>> tests;
  const auto of_parameter = [&](const char* keyword, double bound) {
    if (std::abs(bound) < no_bound)
      tests.push_back(std::make_unique<ParameterBoundTest>(parameter, keyword, bound, settings.principal));
  };
  const auto of_measure = [&](const char* keyword, double bound) {
    if (std::abs(bound) < no_bound)
      tests.push_back(std::make_unique<MeasureBoundTest>(keyword, bound, settings.measure, settings.state_weights));
  };
  of_parameter("RL0", settings.parameter_min);
  of_parameter("RL1", settings.parameter_max);
  of_measure("A0", settings.measure_min);
  of_measure("A1", settings.measure_max);
  return tests;
}

}  // namespace tchat
