// The planar oscillator (3.1)-(3.2) by the real executable, as problems/planar/Makefile runs it.
#include <catch2/catch.hpp>
#include <cmath>

#include "published/makefile_run.hpp"

using namespace test_support;

TEST_CASE("planar: grazing at mu = 1, the impacting orbit beyond, the verdict of (3.13)") {
  const MakefileRun chain("planar");
  const SolutionEntry contact = chain.only("grazing", "GR");
  check_near(contact.parameter(1), 1.0, 1e-9);
  check_near(contact.parameter(61), 6.663286859323, 1e-9);

  const SolutionEntry impacting = chain.only("impacting", "UZ");
  check_near(impacting.parameter(1), 1.001);
  check_near(impacting.parameter(61), 6.604910506061);
  check_near(impacting.states.back()[1], 0.06602396113935);
  const DiagnosticPoint point = chain.point("impacting", "UZ");
  CHECK(point.point < 0);  // stable
  CHECK(distance_to(point.multipliers, 6.530430956e-4) < 1e-11);

  const std::string analysis = chain.read("analysis");
  INFO(analysis);
  const auto shows = [&](const std::string& part) { CHECK(analysis.find(part) != std::string::npos); };
  shows("a* = 2.00861986");
  shows("beta = 0: the map has no square root on P");
  shows("Verdict: continuous");
  shows("det(Id - A L) det(Id - A) = 0.9985905731 > 0");
  shows("y^2.00 (order 1/2");
  shows("y^3.00 (order 1,");
  shows("y^4.00 (order 3/2");
  chain.check_verified();
  chain.check_repeatable();
}
