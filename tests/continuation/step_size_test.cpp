// Step length rules: the factors by Newton iterations, the bounds, halving.
#include <catch2/catch.hpp>

#include "continuation/branch.hpp"

using namespace tchat;

namespace {

/// The factor after a point that took `iterations`, for ITNW = 8.
double factor(int iterations, int max_newton = 8) {
  StepSize step({0.01, 1e-6, 1.0, 1, max_newton});
  step.converged(iterations, 2);
  return step.value() / 0.01;
}

}  // namespace

TEST_CASE("the step grows and shrinks by the Newton iterations it took") {
  const std::vector<double> expected{2.0, 1.5, 1.1, 1.1, 1.0, 1.0, 1.0, 0.5};
  for (int iterations = 1; iterations <= 8; ++iterations)
    CHECK(factor(iterations) == Approx(expected[static_cast<std::size_t>(iterations - 1)]));
  CHECK(factor(0) == Approx(2.0));
  CHECK(factor(9) == Approx(0.5));
  CHECK(factor(3, 5) == Approx(1.0));  // ITNW / 2 = 2
  CHECK(factor(2, 2) == Approx(1.5));
}

TEST_CASE("the step stays within DSMAX, keeps its sign, and adapts every IADS points") {
  StepSize step({-0.04, 1e-6, 0.1, 3, 8});
  CHECK(step.value() == -0.04);
  step.converged(1, 2);
  CHECK(step.value() == -0.04);
  step.converged(1, 3);
  CHECK(step.value() == Approx(-0.08));
  step.converged(1, 6);
  CHECK(step.value() == Approx(-0.1));
}

TEST_CASE("failures halve the step down to DSMIN, which is never below 1e-10 of the largest step") {
  StepSize step({0.08, 0.015, 0.1, 1, 8});
  CHECK(step.failed());
  CHECK(step.value() == Approx(0.04));
  CHECK(step.failed());
  CHECK_FALSE(step.failed());
  CHECK(StepSize({0.08, 0.0, 0.1, 1, 8}).smallest() == Approx(1e-11));
  CHECK(StepSize({-0.5, 0.0, 0.1, 1, 8}).smallest() == Approx(5e-11));
  StepSize endless({0.1, 0.0, 0.1, 1, 8});
  int halvings = 0;
  while (endless.failed() && halvings < 1000) ++halvings;
  CHECK(halvings < 40);
}

TEST_CASE("IADS = 0 fixes the step: no growth, and the first failure is final") {
  StepSize step({0.05, 1e-6, 0.1, 0, 8});
  step.converged(1, 4);
  CHECK(step.value() == 0.05);
  CHECK_FALSE(step.failed());
}
