// Grazing orbits, their verdicts and the impacting orbits born there, against published numbers and shooting.
#include "maps/grazing_orbit.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "base/messages.hpp"
#include "maps/grazing_problems.hpp"
#include "motion/orbit_flow.hpp"
#include "orbit/ring_system.hpp"
#include "support/random_matrices.hpp"

using namespace tchat;
using namespace tchat::test;
using Catch::Contains;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

/// (4.1), (4.2): PAR = (mu, m, r).
struct ThreeDimensional {
  static constexpr int dimension = 3, parameters = 3, fields = 1, events = 2, jumps = 2;
  template <class T>
  static T velocity(const T* x, const T* p) {
    return (p[1] - x[2]) * x[0] - x[1];
  }
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = velocity(x, p);
    f[1] = p[1] * x[1] + x[0];
    f[2] = -x[2] + x[1] * x[1] + x[0] * x[0] * x[2];
  }
  template <class T>
  T event(int j, const T* x, const T* p) const {
    return j == 1 ? T(x[0] - p[0]) : T(-velocity(x, p));
  }
  template <class T>
  void jump(int k, const T* x, const T* p, T* g) const {
    for (int i = 0; i < 3; ++i) g[i] = x[i];
    if (k == 1) g[1] = x[1] + (1.0 + p[2]) * velocity(x, p);
  }
};

struct Analysis {
  GrazingOrbit orbit;
  DiscontinuityMap map;
  std::vector<ImpactReturn> xi;
  GrazingVerdict verdict;

  Analysis(const HybridSystem& system, const ContactTurn& turn, int returns = 20)
      : orbit(find_grazing_orbit(system, turn, "test")),
        map(system, orbit.point),
        xi(impact_returns(orbit.point.event_gradient, orbit.A, orbit.point.impact, returns)),
        verdict(grazing_verdict(orbit, map, xi)) {}
};

ContactTurn turn_of(const VectorXd& x, const ParameterVector& par, double period, int parameter = 1) {
  ContactTurn turn;
  turn.contact = {1, 1, 1};
  turn.x = x;
  turn.par = par;
  turn.segments = {{1, 1, no_function}};
  turn.durations = {period};
  turn.parameter = parameter;
  return turn;
}

// Off by some 1e-3, which Newton's method has to mend.
ContactTurn at_028() { return turn_of(Vector3d(-0.7975, 0.2752, 0.6237), parameters({-0.797, 0.28, 0.8}), 6.724); }
ContactTurn at_039() { return turn_of(Vector3d(-0.8271, -0.0722, 0.3026), parameters({-0.8272, 0.39, 0.8}), 8.0635); }
ContactTurn planar() { return turn_of(Eigen::Vector2d(2.0086, 1e-4), parameters({1.001, 2.008619860875, 0.8}), 6.663); }

/// The impacting orbit of one impact in k returns by shooting, at an impact velocity V. Unknowns: the state x after the
/// impact (n), the time T from one impact to the next, the parameter; with z the state after T, x = g(z), h_D(z) = 0
/// and h_x f(z) = -V: n + 2 each. No event is searched for, so that Newton's method may begin anywhere near grazing.
struct Shot {
  double delta = 0.0;
  std::complex<double> multiplier;
};
Shot shot(const HybridSystem& system, const Analysis& analysis, const BornOrbit& born, double velocity) {
  const GrazingPoint& at = analysis.orbit.point;
  const Eigen::Index n = at.x.size(), k = analysis.orbit.parameter - 1;
  ParameterVector par = at.par;
  VectorXd x = at.x;
  double time = born.returns * analysis.orbit.period();
  FlowOptions options;
  options.active = {analysis.orbit.parameter};
  SurfaceRate wall(static_cast<int>(n), 1);
  double size = 1.0;
  for (int iteration = 0; iteration < 30 && size > 1e-14; ++iteration) {
    const SegmentFlow flow = integrate_for(system, 1, x, par, time, options);
    const VectorXd& z = flow.end_state;
    VectorXd f(n), g(n);
    Eigen::MatrixXd gx(n, n), gp(n, 1);
    system.value(FunctionKind::field, 1, z.data(), par.data(), f.data());
    system.first(FunctionKind::jump, 1, z.data(), par.data(), options.active, g.data(), gx.data(), gp.data());
    wall.evaluate(system, {1, 1, 1}, z.data(), par.data(), options.active);
    Eigen::MatrixXd end(n, n + 2);  // of z, by x, T and the parameter
    end << flow.jacobian, f, flow.parameter_derivative;
    Eigen::MatrixXd matrix(n + 2, n + 2);
    matrix << -gx * end, wall.hx.transpose() * end, wall.rate_x.transpose() * end;
    matrix.topLeftCorner(n, n) += Eigen::MatrixXd::Identity(n, n);
    matrix.topRightCorner(n, 1) -= gp;
    matrix(n, n + 1) += wall.hp(0);
    matrix(n + 1, n + 1) += wall.rate_p(0);
    VectorXd right(n + 2);
    right << g - x, -wall.h, -velocity - wall.rate;
    const VectorXd step = solution(matrix, right);
    x += step.head(n);
    time += step(n);
    par(k) += step(n + 1);
    size = step.norm();
  }
  REQUIRE(size < 1e-10);
  Signature signature{{1, 1, 1}};
  for (int i = 1; i < born.returns; ++i) signature.insert(signature.begin(), {1, 2, 2});
  const ReturnMap map = return_map(system, signature, x, par);
  INFO(map.message);
  REQUIRE(map.ok);
  CHECK(map.period == Approx(time).epsilon(1e-9));  // no other event on the way
  return {par(k) - at.par(k), map.multipliers(0)};
}

}  // namespace

TEST_CASE("The orbit at m = 0.28: contact, return map, xi_n, verdict") {
  const HybridSystem& system = system_of<ThreeDimensional>();
  const Analysis at(system, at_028());
  CHECK(at.orbit.point.par(0) == Approx(-0.798146332928).margin(2e-12));
  CHECK((at.orbit.point.x - Vector3d(-0.798146332928, 0.274740619469, 0.624223368742)).norm() < 2e-12);
  CHECK(at.orbit.period() == Approx(6.725184221523).margin(2e-12));
  CHECK(at.orbit.point.a == Approx(0.600629246036).margin(2e-12));
  CHECK((at.orbit.point.B - Vector3d(0.0, 0.3960905933, 0.4962631248)).norm() < 1e-10);
  CHECK(std::abs(at.orbit.multipliers(0) - 0.539641978337) < 1e-11);
  CHECK(std::abs(at.orbit.multipliers(1) - 0.0239214365814) < 1e-11);
  CHECK(std::abs(at.orbit.multipliers(2)) < 1e-11);
  CHECK(at.xi[0].xi == Approx(-0.0230671242).margin(1e-10));
  CHECK(at.xi[1].xi == Approx(-0.0129997873).margin(1e-10));
  CHECK(at.verdict.words() == "discontinuous, n = 1");
  CHECK_THAT(at.verdict.reason, Contains("xi_1 = -0.0230671242") && Contains("< 0"));
}

TEST_CASE("The orbit at m = 0.39: contact, return map, xi_n, verdict") {
  const HybridSystem& system = system_of<ThreeDimensional>();
  const Analysis at(system, at_039());
  CHECK(at.orbit.point.par(0) == Approx(-0.827105485379).margin(2e-12));
  CHECK((at.orbit.point.B - Vector3d(0.0, 0.2153721072, 0.2603925509)).norm() < 1e-10);
  CHECK(std::abs(at.orbit.multipliers(0) - 0.191866575221) < 1e-11);
  CHECK(at.xi[0].xi == Approx(0.0274746760).margin(1e-10));
  CHECK(at.xi[1].xi == Approx(0.0059289424).margin(1e-10));
  CHECK(at.verdict.words() == "continuous");
  CHECK_THAT(at.verdict.reason,
             Contains("xi_1 ... xi_20 are positive") && Contains("0.191867") && Contains("real and positive"));
}

TEST_CASE("Impacting orbits born at grazing: side, velocity and multiplier by shooting") {
  const HybridSystem& system = system_of<ThreeDimensional>();
  for (const bool first : {true, false}) {
    const Analysis at(system, first ? at_028() : at_039());
    const BornOrbits born = born_orbits(system, at.orbit, at.map, 3);
    CAPTURE(first);
    CHECK(born.clearance < 0.0);  // without contact: mu below grazing
    for (const BornOrbit& one : born.orbits) {
      CAPTURE(one.returns);
      if (first && one.returns > 1) {
        CHECK_FALSE(one.exists());  // xi_n < 0: the impact recurs after one period
        continue;
      }
      REQUIRE(one.exists());
      CHECK(one.side == (first ? -1 : 1));
      CHECK(one.beyond_contact == !first);
      // Errors of the leading order are proportional to the velocity: extrapolated from one and its half.
      const double velocity = 2e-4;
      const Shot far = shot(system, at, one, velocity);
      const Shot near = shot(system, at, one, 0.5 * velocity);
      CHECK(far.delta * one.side > 0.0);
      const double slope = 2.0 * near.delta / (0.5 * velocity) - far.delta / velocity;
      CHECK(slope == Approx(one.side / (std::sqrt(2.0 * at.orbit.point.a) * one.rate)).epsilon(1e-5));
      const double multiplier =
          2.0 * near.multiplier.real() * std::abs(near.delta) - far.multiplier.real() * std::abs(far.delta);
      CHECK(multiplier == Approx(one.multiplier.real()).epsilon(1e-4));
    }
  }
}

TEST_CASE("The planar oscillator: (3.13), continuous without a square root") {
  const HybridSystem& system = system_of<PlanarOscillator>();
  const Analysis at(system, planar());
  CHECK(at.orbit.point.par(0) == Approx(1.0).margin(1e-11));
  CHECK(at.orbit.period() == Approx(6.663286859323).margin(1e-11));
  CHECK(at.orbit.A(0, 0) == Approx(8.596950636e-4).epsilon(1e-9));
  CHECK(at.verdict.is_linear);
  CHECK(at.verdict.linear == Approx(0.9985905731).margin(5e-11));
  CHECK(at.verdict.words() == "continuous");
  CHECK_THAT(at.verdict.reason, Contains("0.9985905731 > 0 (3.12)"));

  const BornOrbits born = born_orbits(system, at.orbit, at.map, 2);
  CHECK_FALSE(born.has_square_root);
  const BornOrbit& one = born.orbits.front();
  REQUIRE(one.exists());
  CHECK(one.side == 1);
  CHECK(one.beyond_contact);
  CHECK_FALSE(born.orbits[1].exists());
  // delta / v^2 is linear in the velocity to leading order: extrapolated from one and its half.
  const double velocity = 4e-3;
  const Shot far = shot(system, at, one, velocity);
  const Shot near = shot(system, at, one, 0.5 * velocity);
  const double slope = 2.0 * near.delta / (0.25 * velocity * velocity) - far.delta / (velocity * velocity);
  CHECK(slope == Approx(1.0 / (2.0 * at.orbit.point.a * one.rate)).epsilon(1e-4));
  CHECK(2.0 * near.multiplier.real() - far.multiplier.real() == Approx(one.multiplier.real()).epsilon(1e-4));
}

TEST_CASE("Verdicts of orbits that bifurcate or are unstable without contact") {
  const HybridSystem& system = system_of<ThreeDimensional>();
  const Analysis at(system, at_028());
  GrazingOrbit orbit = at.orbit;
  const auto scaled_to = [&](double largest) {
    orbit.A = at.orbit.A * largest / at.orbit.multipliers(0).real();
    orbit.multipliers = at.orbit.multipliers * (largest / at.orbit.multipliers(0).real());
    return grazing_verdict(orbit, at.map, impact_returns(orbit.point.event_gradient, orbit.A, orbit.point.impact, 20));
  };
  CHECK(scaled_to(1.5).words() == "none");
  CHECK_THAT(scaled_to(1.5).reason, Contains("unstable without contact") && Contains("1.5"));
  CHECK(scaled_to(1.0).words() == "cannot tell");
  CHECK_THAT(scaled_to(-1.0).reason, Contains("bifurcates without contact"));
  // A negative dominant eigenvalue whose xi_1 is positive: xi_2 is negative.
  CHECK(scaled_to(-0.5).words() == "discontinuous, n = 2");
  const GrazingVerdict short_look =
      grazing_verdict(orbit, at.map, impact_returns(orbit.point.event_gradient, orbit.A, orbit.point.impact, 1));
  CHECK(short_look.words() == "cannot tell");
  CHECK_THAT(short_look.reason, Contains("is negative, so that xi_n changes its sign") && Contains("--xi 4"));
}

TEST_CASE("A turn that is none says so") {
  const HybridSystem& system = system_of<ThreeDimensional>();
  ContactTurn turn = at_028();
  turn.x = Vector3d(5.0, 5.0, 5.0);  // from where no orbit is near
  CHECK_THROWS_WITH(find_grazing_orbit(system, turn, "label 2 of q.x"),
                    Contains("label 2 of q.x: Newton's method does not find the orbit in contact"));
}
