// Problems that leave a direction undetermined are refused with its name.
#include <catch2/catch.hpp>

#include "base/messages.hpp"
#include "run/first_correction.hpp"
#include "support/branch_fixture.hpp"
#include "support/linear_oscillator.hpp"

using namespace tchat;
using namespace tchat::test;
using Catch::Matchers::Contains;

namespace {

/// x'' + 0.1 x' + x = a cos(theta) with a bystander: no field of its own, identity jump. With jump 2 it is set.
struct Bystander {
  static constexpr int dimension = 5, parameters = 2, fields = 1, events = 1, jumps = 2;
  static constexpr const char* state_names[] = {"x", "velocity", "s", "c", "load"};
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    const T radius = x[2] * x[2] + x[3] * x[3];
    f[0] = x[1];
    f[1] = p[0] * x[3] - 0.1 * x[1] - x[0];
    f[2] = x[2] + p[1] * x[3] - x[2] * radius;
    f[3] = x[3] - p[1] * x[2] - x[3] * radius;
    f[4] = T(0.0);
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[1];
  }
  template <class T>
  void jump(int k, const T* x, const T*, T* g) const {
    for (int i = 0; i < 5; ++i) g[i] = x[i];
    if (k == 2) g[4] = T(0.25);
  }
};

/// The forced oscillator's closed form with the bystander at 0.25.
Orbit start() {
  const OscillatorOrbit orbit = nonimpacting_orbit(2.0, 3.0);
  const Piece piece{pi, [orbit](double t) {
                      Eigen::VectorXd x(5);
                      x << orbit.state(t), 0.25;
                      return x;
                    }};
  return sampled_orbit({piece}, 5, 30, 4, parameters({3.0, 2.0}));
}

FirstPoint first_point_with(int jump) {
  PeriodicOrbits orbits(system_of<Bystander>(), {{1, 1, jump}}, 1, start().shape);
  SelectedStart selected;
  selected.start.orbit = start();
  selected.known_parameters = selected.start.orbit.par;
  selected.source = "test.dat";
  return first_point(orbits.follower, orbits.system, selected, RunSettings{});
}

}  // namespace

TEST_CASE("a state with zero field and identity jump: refused, and named") {
  CHECK_THROWS_AS(first_point_with(1), ComputationError);
  CHECK_THROWS_WITH(first_point_with(1), Contains("singular") && Contains("load"));
  CHECK_THROWS_WITH(first_point_with(1), !Contains("velocity"));
}

TEST_CASE("pinned by a jump it is accepted") {
  const FirstPoint first = first_point_with(2);
  CHECK(first.point.orbit.start(0)[4] == Approx(0.25).epsilon(1e-12));
  CHECK(first.point.orbit.start(0)[0] == Approx(3.0 / std::abs(OscillatorConstants{2.0}.stiffness())).epsilon(1e-7));
}

TEST_CASE("no convergence at the first point lists the residual of every condition") {
  PeriodicOrbits orbits(linosc(), {{1, 1, 1}}, 1, {4, 1, 10, 4});
  SelectedStart selected;
  selected.source = "test.dat";
  selected.start.orbit =
      sampled_orbit({{3.0, [](double t) { return Eigen::VectorXd::Constant(4, std::cos(7 * t) * 40); }}}, 4, 10, 4,
                    parameters({3.0, 2.0, 0.05, 0.8}));
  selected.known_parameters = selected.start.orbit.par;
  CHECK_THROWS_WITH(first_point(orbits.follower, orbits.system, selected, RunSettings{}),
                    Contains("test.dat") && Contains("event 1 (wall)") && Contains("x1 at the start of segment 1") &&
                        Contains("y2 at the start of segment 1") && Contains("differential equations on segment 1"));
}
