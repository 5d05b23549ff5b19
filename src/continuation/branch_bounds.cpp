#include "continuation/branch_bounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "continuation/solution_measure.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

namespace {

/// A bound as far away is none.
constexpr double no_bound = 1e300;

class BoundTest final : public TestFunction {
 public:
  BoundTest(BranchBounds bounds, std::string keyword, double bound)
      : bounds_(std::move(bounds)), keyword_(std::move(keyword)), bound_(bound) {}

  /// Both bounds of a quantity have the keyword BOUNDS, so the value distinguishes them.
  std::string name() const override {
    return bounds_.least_keyword == bounds_.most_keyword ? fmt::format("{} - {:g}", bounds_.quantity, bound_)
                                                         : fmt::format("{} - {}", bounds_.quantity, keyword_);
  }
  TestValue evaluate(const TestedPoint& point) const override {
    const double here = bounds_.value(point.orbit, point.condensed.rule());
    return TestValue::of(here - bound_, orbit_accuracy * std::max(std::abs(bound_), std::abs(here)));
  }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::end, {}, true, fmt::format("{} = {:.10g}, the bound {}", bounds_.quantity, bound_, keyword_)};
  }

 private:
  BranchBounds bounds_;
  std::string keyword_;
  double bound_;
};

}  // namespace

double BranchBounds::value(const Orbit& orbit, const CollocationRule& rule) const {
  if (parameter != solution_measure) return orbit.par(parameter - 1);
  return tchat::solution_measure(orbit, rule, weights, measure);
}

bool BranchBounds::is_finite() const { return least > -no_bound || most < no_bound; }

std::string BranchBounds::keywords() const {
  return least_keyword == most_keyword ? least_keyword : least_keyword + ", " + most_keyword;
}

std::vector<std::unique_ptr<TestFunction>> bound_tests(const std::vector<BranchBounds>& bounds) {
  std::vector<std::unique_ptr<TestFunction>> tests;
  const auto add = [&](const BranchBounds& range, const std::string& keyword, double bound) {
    if (std::abs(bound) < no_bound) tests.push_back(std::make_unique<BoundTest>(range, keyword, bound));
  };
  for (const BranchBounds& range : bounds) {
    add(range, range.least_keyword, range.least);
    add(range, range.most_keyword, range.most);
  }
  return tests;
}

}  // namespace tchat
