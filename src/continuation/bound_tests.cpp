#include "continuation/bound_tests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bvp/orbit_accuracy.hpp"

namespace tchat {

namespace {

/// Bounds as far away are none.
constexpr double no_bound = 1e300;

class BoundTest final : public TestFunction {
 public:
  BoundTest(const BranchBounds& bounds, std::string keyword, double bound, const ContinuationSettings& settings)
      : bounds_(bounds), keyword_(std::move(keyword)), bound_(bound), settings_(settings) {}

  /// Both bounds of a quantity have the keyword BOUNDS, so the value distinguishes them.
  std::string name() const override {
    return bounds_.least_keyword == bounds_.most_keyword ? fmt::format("{} - {:g}", bounds_.quantity, bound_)
                                                         : fmt::format("{} - {}", bounds_.quantity, keyword_);
  }
  TestValue evaluate(const TestedPoint& point) const override {
    const double here = bounded_value(bounds_, settings_, point.orbit, point.condensed.rule());
    return TestValue::of(here - bound_, orbit_accuracy * std::max(std::abs(bound_), std::abs(here)));
  }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::end, {}, true, fmt::format("{} = {:.10g}, the bound {}", bounds_.quantity, bound_, keyword_)};
  }

 private:
  BranchBounds bounds_;
  std::string keyword_;
  double bound_;
  ContinuationSettings settings_;
};

}  // namespace

std::vector<std::unique_ptr<TestFunction>> bound_tests(const ContinuationSettings& settings) {
  std::vector<std::unique_ptr<TestFunction>> tests;
  const auto add = [&](const BranchBounds& bounds, const std::string& keyword, double bound) {
    if (std::abs(bound) < no_bound) tests.push_back(std::make_unique<BoundTest>(bounds, keyword, bound, settings));
  };
  for (const BranchBounds& bounds : branch_bounds(settings)) {
    add(bounds, bounds.least_keyword, bounds.least);
    add(bounds, bounds.most_keyword, bounds.most);
  }
  return tests;
}

}  // namespace tchat
