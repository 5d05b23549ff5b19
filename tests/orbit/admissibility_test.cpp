// Which solutions of the boundary value problem are orbits of the model.
#include <catch2/catch.hpp>

#include "orbit/admissibility.hpp"
#include "support/linear_oscillator.hpp"

using namespace tchat;
using namespace tchat::test;
using Catch::Matchers::Contains;

namespace {

std::vector<Violation> of_impacting(double v) {
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, v);
  const Orbit x = sampled_orbit({orbit.piece(0, orbit.constants.period())}, 4, 40, 4, orbit.par());
  return inadmissibilities(linosc(), {{1, 1, 1}}, {{1}}, x, CollocationRule(4), 0.0);
}

std::vector<Violation> of_nonimpacting(double alpha, const std::vector<int>& monitored = {1}) {
  const OscillatorOrbit orbit = nonimpacting_orbit(2.0, alpha);
  const Orbit x = sampled_orbit({orbit.piece(0, orbit.constants.period())}, 4, 40, 4, orbit.par());
  return inadmissibilities(linosc(), {{1, 2, 2}}, {monitored}, x, CollocationRule(4), 0.0);
}

}  // namespace

TEST_CASE("an impacting orbit starts and ends on the wall: pinned, no violation") {
  CHECK(of_impacting(0.5).empty());
  CHECK(of_impacting(1e-4).empty());
  CHECK(of_impacting(0.0).empty());
}

TEST_CASE("a negative impact velocity leaves through the wall") {
  const std::vector<Violation> found = of_impacting(-0.3);
  REQUIRE_FALSE(found.empty());
  const Violation& last = found.back();
  CHECK(last.kind == Violation::leaving_terminal_surface);
  CHECK(last.segment == 1);
  CHECK(last.event == 1);
  CHECK(last.value == Approx(0.3));
  CHECK_THAT(describe(last, linosc()), Contains("segment 1") && Contains("wall"));
}

TEST_CASE("a nonimpacting orbit beyond the wall violates the monitored event where it is worst: at its ends") {
  CHECK(of_nonimpacting(3.0).empty());  // amplitude 0.9978
  const std::vector<Violation> found = of_nonimpacting(3.1);
  REQUIRE(found.size() == 1);
  CHECK(found[0].kind == Violation::event_crossed);
  CHECK(found[0].event == 1);
  CHECK((found[0].tau == 0.0 || found[0].tau == 1.0));
  CHECK(found[0].value == Approx(1 - 3.1 / std::abs(OscillatorConstants{2.0}.stiffness())));
  CHECK_THAT(describe(found[0], linosc()), Contains("h1 (wall)"));
  CHECK(of_nonimpacting(3.1, {}).empty());  // not monitored
}

TEST_CASE("the section itself, monitored: both ends pinned, its crossing in between is seen") {
  const std::vector<Violation> found = of_nonimpacting(2.0, {2});
  REQUIRE(found.size() == 1);  // x2 < 0 on the first half of the orbit
  CHECK(found[0].tau == Approx(0.25).margin(0.01));
}

TEST_CASE("a negative duration is one, rounding is not") {
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, 0.5);
  Orbit x = sampled_orbit({orbit.piece(0, orbit.constants.period())}, 4, 40, 4, orbit.par());
  Orbit two = sampled_orbit({orbit.piece(0, orbit.constants.period()), orbit.piece(0, 0)}, 4, 40, 4, orbit.par());
  two.duration(1) = -1e-3;
  const std::vector<Violation> found =
      inadmissibilities(linosc(), {{1, 1, 2}, {1, 2, 1}}, {{}, {}}, two, CollocationRule(4), 0.0);
  REQUIRE(found.size() >= 1);
  CHECK(found[0].kind == Violation::negative_duration);
  CHECK(found[0].segment == 2);
  CHECK(found[0].value == -1e-3);
  CHECK_THAT(describe(found[0], linosc()), Contains("negative duration"));
  two.duration(1) = -1e-11;
  for (const Violation& v : inadmissibilities(linosc(), {{1, 1, 2}, {1, 2, 1}}, {{}, {}}, two, CollocationRule(4), 0.0))
    CHECK(v.kind != Violation::negative_duration);
  CHECK(inadmissibilities(linosc(), {{1, 1, 1}}, {{1}}, x, CollocationRule(4), 0.0).empty());
}

TEST_CASE("a contact between nodes is seen") {
  // Without forcing beyond the wall at the nodes: eight nodes a period, none of them where x1 is largest.
  const OscillatorOrbit orbit = nonimpacting_orbit(2.0, 3.02);
  const double period = orbit.constants.period();
  const Piece whole = orbit.piece(0, period);
  const CollocationRule rule(4);
  const auto worst = [&](double shift, double error) {
    const Piece piece{period, [&, shift](double t) { return whole.state(t + shift * period); }};
    const Orbit x = sampled_orbit({piece}, 4, 4, 4, orbit.par());
    return inadmissibilities(linosc(), {{1, 2, 2}}, {{1}}, x, rule, error);
  };
  const double depth = 3.02 / std::abs(OscillatorConstants{2.0}.stiffness()) - 1.0;
  REQUIRE(depth > 0.0);
  // The nearest nodes are a 32nd of the period away from the maximum: x1 is less by 2 % there.
  for (const double shift : {1.0 / 32, 3.0 / 32}) {
    CAPTURE(shift);
    const std::vector<Violation> found = worst(shift, 1e-5);
    REQUIRE(found.size() == 1);
    CHECK(found[0].value == Approx(-depth).epsilon(1e-3));
    // Where the states are not known so well, h may be positive.
    CHECK(worst(shift, depth).empty());
  }
}
