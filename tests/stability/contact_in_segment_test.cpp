// Contact inside a segment. On the circle (cos theta, sin theta), theta' = 1, the event function is the trigonometric
// polynomial h = a + b cos theta + c sin theta + d cos 2 theta (as cos^2 - sin^2), so that all its minima are known.
#include "stability/grazing_tests.hpp"

#include <catch2/catch.hpp>

#include "impacting_orbits.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "recorded_branch.hpp"
#include "stability/bifurcation_tests.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

struct Circle {
  static constexpr int dimension = 2, parameters = 4, fields = 1, events = 2, jumps = 1;
  template <class T>
  void field(int, const T* u, const T*, T* f) const {
    const T growth = 1.0 - u[0] * u[0] - u[1] * u[1];
    f[0] = u[0] * growth - u[1];
    f[1] = u[1] * growth + u[0];
  }
  template <class T>
  T event(int j, const T* u, const T* p) const {
    if (j == 1) return u[1];
    return p[0] + p[1] * u[0] + p[2] * u[1] + p[3] * (u[0] * u[0] - u[1] * u[1]);
  }
  template <class T>
  void jump(int, const T* u, const T*, T* g) const {
    g[0] = u[0], g[1] = u[1];
  }
};

/// The same on a narrow ring around the circle, and without a value elsewhere.
struct Ring : Circle {
  template <class T>
  void field(int i, const T* u, const T* p, T* f) const {
    Circle::field(i, u, p, f);
    const T excess = 1e-5 - (1.0 - u[0] * u[0] - u[1] * u[1]) * (1.0 - u[0] * u[0] - u[1] * u[1]);
    f[0] = f[0] + 0.0 * sqrt(excess);
  }
};

double h(const std::array<double, 4>& p, double theta) {
  return p[0] + p[1] * std::cos(theta) + p[2] * std::sin(theta) + p[3] * std::cos(2 * theta);
}

/// One revolution from the angle `from`.
Orbit revolution(const std::array<double, 4>& p, double from, int intervals, int collocation) {
  const auto state = [=](double t) { return Eigen::VectorXd(Eigen::Vector2d(std::cos(from + t), std::sin(from + t))); };
  return sampled_orbit({{2 * pi, state}}, 2, intervals, collocation, parameters({p[0], p[1], p[2], p[3]}));
}

/// Of event 2, with the orbit converged on the section of event `terminal`.
template <class Problem = Circle>
std::optional<EventMinimum> least(const Orbit& start, int terminal) {
  PeriodicOrbits orbits(system_of<Problem>(), {{1, terminal, 1}}, 1, start.shape, {12, 6, 1e-12, 1e-12});
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  return least_value(orbits.system, orbits.follower.condensed().rule(), point.orbit, 0, 2);
}

/// Continues PAR(parameter) with event 2 monitored.
RecordedBranch continued(const std::array<double, 4>& p, double from, int terminal, int parameter, double ds,
                         int points, bool stop = true) {
  const Orbit start = revolution(p, from, 30, 4);
  PeriodicOrbits orbits(system_of<Circle>(), {{1, terminal, 1}}, parameter, start.shape, {12, 6, 1e-10, 1e-10});
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(start.shape, parameter, ds, std::abs(ds), points);
  settings.location_tolerance = 1e-10;
  settings.max_location = 25;
  return record(orbits.follower, orbits.system, point, settings, one_test<ContactTest>(orbits.system, 0, 2, stop));
}

/// The angle where h falls through zero between two angles.
double falls(const std::array<double, 4>& p, double low, double high) {
  return root_between([&](double theta) { return h(p, theta); }, low, high);
}

}  // namespace

// The polynomial of degree 4 on 60 intervals of the circle has an error of about (2 pi / 60)^5 / 4^5 = 1e-8.
TEST_CASE("a least value where the flow cannot be integrated is that of the polynomial") {
  const std::array<double, 4> p{0.3, 0.0, 0.5, 0.2};
  const Orbit start = revolution(p, pi, 60, 4);
  const auto exact = least(start, 1);
  const auto found = least<Ring>(start, 1);
  REQUIRE(exact);
  REQUIRE(found);
  CHECK(found->value == Approx(exact->value).margin(1e-7));
  CHECK((found->state - exact->state).norm() < 1e-6);
}

TEST_CASE("contact: an interior minimum is polished to the order of mesh points") {
  const std::array<double, 4> p{2.0, 0.3, 0.2, -0.7};
  // The least of h, to rounding, from its derivative; found by hand to lie near theta = pi.
  const auto slope = [&](double t) { return -p[1] * std::sin(t) + p[2] * std::cos(t) - 2 * p[3] * std::sin(2 * t); };
  const double at = root_between(slope, pi - 0.5, pi + 0.5);
  for (double t = 0; t < 2 * pi; t += 0.01) REQUIRE(h(p, t) >= h(p, at));
  const double section = pi;  // y falls through zero; the minimum is moved inside by c
  for (const int collocation : {2, 3, 4}) {
    std::vector<double> values;
    std::vector<double> states;
    for (const int intervals : {8, 16}) {
      const auto contact = least(revolution(p, section, intervals, collocation), 1);
      REQUIRE(contact);
      values.push_back(std::abs(contact->value - h(p, at)));
      states.push_back((contact->state - Eigen::Vector2d(std::cos(at), std::sin(at))).norm());
      CHECK(contact->tau * 2 * pi + section == Approx(at < section ? at + 2 * pi : at).margin(5e-3));
    }
    CAPTURE(collocation, values, states);
    // At least the order of mesh points, 2 NCOL; that of the polynomial between them is NCOL + 1.
    const auto order = [](const std::vector<double>& e) { return std::log2(e[0] / std::max(e[1], 1e-15)); };
    if (values[1] > 1e-13) CHECK(order(values) > 2 * collocation - 0.6);
    if (states[1] > 1e-12) CHECK(order(states) > 2 * collocation - 0.6);
  }
  const auto fine = least(revolution(p, section, 40, 5), 1);
  REQUIRE(fine);
  CHECK(fine->value == Approx(h(p, at)).epsilon(1e-13));
}

TEST_CASE("contact: an end point counts, minimum or not, unless it is pinned") {
  // h = 2 - cos(theta - theta0)-like: least at the section's end, sloping or exactly flat.
  const auto flat = least(revolution({2.0, 1.0, 0.0, 0.0}, pi, 20, 4), 1);
  REQUIRE(flat);
  CHECK(flat->value == Approx(1.0).epsilon(1e-8));
  // Terminal event itself: pinned at both ends. Its minimum before it rises hangs on the start, so nothing is left.
  const std::array<double, 4> p{0.5, 0.0, 1.0, 0.0};
  const double from = falls(p, pi, 1.5 * pi);
  CHECK_FALSE(least(revolution(p, from, 20, 4), 2));
  // A second minimum in between is a candidate: a + c - d at theta = pi / 2.
  const std::array<double, 4> dipped{0.5, 0.0, 1.0, 1.0};
  const double before = falls(dipped, pi, 1.5 * pi);
  const auto dip = least(revolution(dipped, before, 40, 5), 2);
  REQUIRE(dip);
  CHECK(dip->value == Approx(0.5).margin(1e-10));
  CHECK(dip->state(1) == Approx(1.0).epsilon(1e-9));
}

TEST_CASE("contact: of the start of a flight after an impact only what comes later counts") {
  // Impacting orbit, event 1 both terminal and monitored: both ends are pinned, and x1 has no maximum in between.
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, 0.5);
  const CutOrbit cut = whole(orbit);
  PeriodicOrbits orbits(linosc(), cut.signature, 1, {4, 1, 50, 4});
  const PathPoint point = orbits.corrected(sampled_orbit(cut.pieces, 4, 50, 4, orbit.par()));
  CHECK_FALSE(least_value(orbits.system, orbits.follower.condensed().rule(), point.orbit, 0, 1));
  // Cut at the minimum of x1, event 1 on the first segment: pinned start, 1 - min x1 is no minimum of 1 - x1, but the
  // free end counts.
  const CutOrbit two = cut_at_minimum(orbit, false);
  PeriodicOrbits halves(linosc(), two.signature, 1, {4, 2, 50, 4});
  const PathPoint cut_point = halves.corrected(sampled_orbit(two.pieces, 4, 50, 4, orbit.par()));
  const auto end = least_value(halves.system, halves.follower.condensed().rule(), cut_point.orbit, 0, 1);
  REQUIRE(end);
  CHECK(end->tau == 1.0);
  CHECK(end->value == Approx(1 - two.pieces[0].state(two.pieces[0].duration)(0)).epsilon(1e-9));
}

TEST_CASE("contact: located, falling ends the branch, rising does not") {
  // Minima a - d +- c at theta = +- pi / 2.
  const RecordedBranch falling = continued({1.5, 0.0, 0.0, 1.0}, pi, 1, 1, -0.1, 20);
  REQUIRE(falling.special().size() == 1);
  const RecordedPoint& contact = *falling.special()[0];
  CHECK(contact.orbit.par(0) == Approx(1.0).margin(1e-8));
  CHECK(contact.special.ends_branch);
  CHECK(contact.special.kind.kind == UserPointKind::contact);
  CHECK(contact.special.kind.segment == 1);
  CHECK(falling.points.back().number == contact.number);
  const RecordedBranch rising = continued({0.5, 0.0, 0.0, 1.0}, pi, 1, 1, 0.1, 10);
  REQUIRE(rising.special().size() == 1);
  CHECK(rising.special()[0]->orbit.par(0) == Approx(1.0).margin(1e-8));
  CHECK(rising.points.size() == 10);
}

TEST_CASE("contact: of two minima that cross within a step the first one is labelled") {
  for (const double c : {0.01, -0.01}) {
    // Steps of 0.1 from 1.34: one of them leads from 1.04 to 0.94, across both zeros.
    const RecordedBranch branch = continued({1.34, 0.0, c, 1.0}, pi, 1, 1, -0.1, 20);
    REQUIRE(branch.special().size() == 1);
    const double before = branch.points[branch.points.size() - 2].orbit.par(0);
    CHECK(before > 1.01);
    CHECK(before - 0.1 < 0.99);
    // a - d - |c| = 0 comes first.
    CHECK(branch.special()[0]->orbit.par(0) == Approx(1.01).margin(1e-8));
    const double angle = branch.special()[0]->special.kind.tau * 2 * pi + pi;
    CHECK(std::sin(angle) == Approx(c > 0 ? -1.0 : 1.0).margin(1e-6));
    const RecordedBranch on = continued({1.34, 0.0, c, 1.0}, pi, 1, 1, -0.1, 8, false);
    CHECK(on.points.back().orbit.par(0) < 0.99);
    REQUIRE(on.special().size() == 1);
    CHECK(on.special()[0]->orbit.par(0) == Approx(1.01).margin(1e-8));
    CHECK(on.notes.empty());
  }
}

TEST_CASE("contact: a minimum that appears or vanishes raises no alarm") {
  // The dip at theta = pi / 2 between pinned ends exists while c < 4 d; its value a + c - d stays positive.
  const auto start = [](double c) { return falls({0.5, 0.0, c, 1.0}, pi, 1.5 * pi); };
  for (const double largest : {0.05, 0.5}) {
    const RecordedBranch vanishing =
        continued({0.5, 0.0, 3.0, 1.0}, start(3.0), 2, 3, largest, 8 + static_cast<int>(1 / largest));
    CHECK(vanishing.special().empty());
    CHECK(vanishing.notes.empty());
    CHECK(vanishing.points.front().values[0].has_value());
    CHECK_FALSE(vanishing.points.back().values[0].has_value());
    const RecordedBranch appearing =
        continued({0.5, 0.0, 5.0, 1.0}, start(5.0), 2, 3, -largest, 8 + static_cast<int>(1 / largest));
    CHECK(appearing.special().empty());
    CHECK(appearing.notes.empty());
    CHECK_FALSE(appearing.points.front().values[0].has_value());
    CHECK(appearing.points.back().values[0].has_value());
  }
}

TEST_CASE("contact: a minimum that appears and touches within one step is found") {
  // With d growing from 0.2 the dip appears at d = c / 4 with the value a + 3 c / 4 and touches at d = a + c = 1.5.
  const std::array<double, 4> p{0.5, 0.0, 1.0, 0.2};
  for (const double largest : {0.1, 1.6}) {
    CAPTURE(largest);
    const RecordedBranch branch = continued(p, falls(p, pi, 1.5 * pi), 2, 4, largest, 30);
    REQUIRE(branch.special().size() == 1);
    CHECK(branch.special()[0]->orbit.par(3) == Approx(1.5).margin(1e-8));
    CHECK(branch.special()[0]->special.ends_branch);
  }
}

TEST_CASE("impact velocity: rising ends the branch when asked") {
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, 0.02);
  for (const bool stop : {true, false}) {
    const Orbit start = sampled_orbit(whole(orbit).pieces, 4, 50, 4, orbit.par());
    PeriodicOrbits orbits(linosc(), {{1, 1, 1}}, 1, start.shape);
    const PathPoint point = orbits.corrected(start);
    const RecordedBranch branch =
        record(orbits.follower, orbits.system, point, branch_settings(start.shape, 1, -0.005, 0.005, 12),
               one_test<ImpactVelocityTest>(orbits.system, 0, stop));
    REQUIRE(branch.special().size() == 1);
    CHECK(branch.special()[0]->special.ends_branch == stop);
    CHECK((branch.points.size() < 12) == stop);
  }
}

TEST_CASE("contact: an event function that cannot be asked for many points at once is asked one by one") {
  const std::array<double, 4> p = {1.5, 0.3, 0.2, 0.4};
  const Orbit x = revolution(p, 0.3, 30, 4);
  const PeriodicOrbitSystem plain(system_of<Circle>(), {{1, 1, 1}}, {1});
  tchat_problem table = system_of<Circle>().table();
  // As the guard of a plugin does where one point throws: nothing is known.
  table.first_at_points = [](const void*, std::int32_t, std::int32_t, std::int32_t points, const double*, const double*,
                             const std::int32_t*, std::int32_t, double* out, double* dx, double*) {
    std::fill_n(out, points, NAN);
    std::fill_n(dx, points * Circle::dimension, NAN);
  };
  const HybridSystem hybrid(table);
  const PeriodicOrbitSystem spoiled(hybrid, {{1, 1, 1}}, {1});
  const std::vector<EventMinimum> expected = least_candidates(plain, CollocationRule(4), x, 0, 2);
  const std::vector<EventMinimum> found = least_candidates(spoiled, CollocationRule(4), x, 0, 2);
  REQUIRE(expected.size() > 2);
  REQUIRE(found.size() == expected.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    CHECK(found[k].tau == expected[k].tau);
    CHECK(found[k].value == expected[k].value);
  }
}
