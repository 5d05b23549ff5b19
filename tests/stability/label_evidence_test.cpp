// What is known of multipliers, and which changes of stability are certain.
#include "stability/test_function.hpp"

#include <catch2/catch.hpp>

using namespace tchat;
using Catch::Matchers::Contains;

namespace {

FloquetMultipliers with_values(std::vector<std::complex<double>> values, double structural = 1e-12) {
  FloquetMultipliers multipliers;
  multipliers.values = std::move(values);
  multipliers.structural = structural;
  multipliers.valid = true;
  return multipliers;
}

}  // namespace

TEST_CASE("a multiplier that crosses +1, -1 or the unit circle changes the stability") {
  const StabilityChange rising = stability_change(with_values({0.93, 0.2}), with_values({0.3, 1.49}));
  CHECK(rising.count == 1);
  CHECK(rising.before == 0.93);
  CHECK(rising.after == 1.49);
  CHECK_THAT(describe(rising, false), Contains("one multiplier goes from 0.93 to 1.49, through +1"));

  const StabilityChange falling = stability_change(with_values({3.0, -1.1}), with_values({3.2, -0.9}));
  CHECK(falling.count == -1);
  CHECK(falling.before == -1.1);
  CHECK(falling.after == -0.9);
  CHECK_THAT(describe(falling, false), Contains("through -1"));

  const std::complex<double> inside(0.6, 0.7), outside(0.7, 0.8);
  const StabilityChange pair =
      stability_change(with_values({inside, std::conj(inside)}), with_values({outside, std::conj(outside)}));
  CHECK(pair.count == 2);
  CHECK_THAT(describe(pair, false), Contains("2 multipliers go") && Contains("the unit circle"));
}

TEST_CASE("within its uncertainty of the unit circle a multiplier decides nothing") {
  CHECK(stability_change(with_values({0.9}), with_values({1.0 + 5e-6})).count == 0);
  CHECK(stability_change(with_values({1.0 - 5e-6}), with_values({1.1})).count == 0);
  // A mesh that leaves 1e-3 of the structural zero tells no multiplier better.
  CHECK(stability_change(with_values({0.9}, 1e-3), with_values({1.0 + 5e-4}, 1e-3)).count == 0);
  CHECK(stability_change(with_values({0.9}, 1e-3), with_values({1.01}, 1e-3)).count == 1);
}

TEST_CASE("multipliers through infinity, of no known value, or of an unresolved orbit change nothing") {
  CHECK(stability_change(with_values({1e9, 0.2}), with_values({-1e9, 0.2})).count == 0);
  FloquetMultipliers unknown = with_values({0.2});
  unknown.undetermined = 1;
  CHECK(stability_change(unknown, with_values({0.2, 1.5})).count == 0);
  CHECK(stability_change(with_values({0.2}), with_values({1.5}, 0.1)).count == 0);
}

TEST_CASE("the trivial multiplier of an orbit without a section is not counted") {
  FloquetMultipliers before = with_values({0.999, 0.5}), after = with_values({1.001, 0.6});
  before.has_trivial = after.has_trivial = true;
  CHECK(stability_change(before, after).count == 0);
  CHECK(multiplier_distance(after, 1.0) == Approx(0.4));
}

TEST_CASE("eigenvalues of an equilibrium cross the imaginary axis") {
  FloquetMultipliers before = with_values({-0.1, -3.0}), after = with_values({0.1, -3.0});
  before.are_eigenvalues = after.are_eigenvalues = true;
  const StabilityChange change = stability_change(before, after);
  CHECK(change.count == 1);
  CHECK_THAT(describe(change, true), Contains("one eigenvalue goes from -0.1 to 0.1, through the imaginary axis"));
}
