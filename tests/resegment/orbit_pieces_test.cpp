// Cutting, repeating and reordering the segments of an orbit: states against the functions that the orbit samples.
#include "resegment/orbit_pieces.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace tchat;

namespace {

/// Two segments of x = (sin(1 + t), exp(-t)), t the time since the start of segment 1; T = 0.7 and 1.3.
Eigen::Vector2d exact(double time) { return {std::sin(1.0 + time), std::exp(-time)}; }
constexpr double durations[] = {0.7, 1.3};
constexpr double starts[] = {0.0, 0.7};

OrbitStart sample(int intervals, int collocation) {
  OrbitStart start;
  Orbit& x = start.orbit;
  x.shape = {2, 2, intervals, collocation};
  for (int j = 0; j <= intervals; ++j) x.mesh.push_back(std::pow(static_cast<double>(j) / intervals, 1.3));
  x.states.resize(2, x.shape.columns());
  x.par = ParameterVector(ParameterLayout());
  x.par(0) = 3.5;
  start.direction = OrbitVector(x.shape, 1);
  start.direction->globals(0) = 0.25;
  for (int s = 0; s < 2; ++s) {
    x.duration(s) = durations[s];
    start.direction->durations(s) = 10.0 + s;
    for (int k = 0; k < x.shape.nodes(); ++k) {
      x.states.col(s * x.shape.nodes() + k) = exact(starts[s] + durations[s] * x.tau(k));
      start.direction->states.col(s * x.shape.nodes() + k).setConstant(s + x.tau(k));
    }
  }
  return start;
}

/// The same on meshes of their own, of 30 and 60 intervals.
OrbitStart sample_on_own_meshes(int collocation) {
  OrbitStart start = sample(45, collocation);
  Orbit& x = start.orbit;
  x.shape.own = OwnIntervals({30, 60});
  x.mesh = uniform_mesh(x.shape);
  for (int s = 0; s < 2; ++s)
    for (int k = 0; k < x.shape.nodes_of(s); ++k) {
      x.states.col(x.shape.first_node(s) + k) = exact(starts[s] + durations[s] * x.tau(s, k));
      start.direction->states.col(x.shape.first_node(s) + k).setConstant(s + x.tau(s, k));
    }
  return start;
}

double worst_error(const Orbit& x, int s, double from_time) {
  double worst = 0.0;
  for (int k = 0; k < x.shape.nodes_of(s); ++k) {
    const Eigen::Map<const Eigen::Vector2d> state(x.node(s, k));
    worst = std::max(worst, (state - exact(from_time + x.duration(s) * x.tau(s, k))).cwiseAbs().maxCoeff());
  }
  return worst;
}

}  // namespace

TEST_CASE("the polynomial between nodes has order NCOL + 1") {
  double before = 0.0;
  for (const int intervals : {8, 16, 32}) {
    const OrbitStart start = sample(intervals, 3);
    const CollocationRule rule(3);
    double worst = 0.0;
    for (int k = 0; k <= 300; ++k)
      worst = std::max(
          worst, (state_at(start.orbit, rule, 1, k / 300.0) - exact(0.7 + 1.3 * k / 300.0)).cwiseAbs().maxCoeff());
    if (before > 0.0) CHECK(std::log2(before / worst) == Approx(4.0).margin(0.3));
    before = worst;
  }
}

TEST_CASE("a segment cut in two: the same curve, the same time") {
  for (const double cut : {0.3251225797, 0.01, 0.999}) {
    CAPTURE(cut);
    const OrbitStart old = sample(40, 5);
    const OrbitStart made = assemble(old, {{0, 0.0, 1.0}, {1, 0.0, cut}, {1, cut, 1.0}});
    const Orbit& x = made.orbit;
    REQUIRE(x.shape == OrbitShape{2, 3, 40, 5});
    CHECK(x.period() == Approx(2.0).epsilon(1e-15));
    CHECK(x.duration(1) == Approx(1.3 * cut).epsilon(1e-15));
    CHECK(x.duration(2) == Approx(1.3 * (1.0 - cut)).epsilon(1e-15));
    CHECK(x.par(0) == 3.5);
    CHECK_FALSE(made.direction);
    CHECK(x.mesh.front() == 0.0);
    CHECK(x.mesh.back() == 1.0);
    CHECK(worst_error(x, 0, 0.0) < 1e-11);
    CHECK(worst_error(x, 1, 0.7) < 1e-11);
    CHECK(worst_error(x, 2, 0.7 + 1.3 * cut) < 1e-11);
    const Eigen::Map<const Eigen::Vector2d> end(x.end(1));
    const Eigen::Map<const Eigen::Vector2d> next(x.start(2));
    CHECK((end - next).cwiseAbs().maxCoeff() < 1e-14);
  }
}

TEST_CASE("a segment of zero duration is constant and leaves the mesh alone") {
  const OrbitStart old = sample(20, 4);
  const OrbitStart with = assemble(old, {{0, 0.0, 1.0}, {0, 1.0, 1.0}, {1, 0.0, 1.0}});
  CHECK(with.orbit.duration(1) == 0.0);
  CHECK(with.orbit.duration(2) == 1.3);
  for (int k = 0; k < with.orbit.shape.nodes(); ++k) {
    const Eigen::Map<const Eigen::Vector2d> state(with.orbit.node(1, k));
    CHECK((state - exact(0.7)).cwiseAbs().maxCoeff() < 1e-14);
  }
  for (std::size_t j = 0; j < with.orbit.mesh.size(); ++j)
    CHECK(with.orbit.mesh[j] == Approx(old.orbit.mesh[j]).margin(0.01));
}

TEST_CASE("whole segments in another order, or twice: exact copies, the direction with them") {
  const OrbitStart old = sample(10, 4);
  const OrbitStart made = assemble(old, {{1, 0.0, 1.0}, {0, 0.0, 1.0}, {1, 0.0, 1.0}});
  const Eigen::Index nodes = old.orbit.shape.nodes();
  CHECK(made.orbit.mesh == old.orbit.mesh);
  CHECK(made.orbit.duration(0) == 1.3);
  CHECK(made.orbit.duration(1) == 0.7);
  CHECK(made.orbit.duration(2) == 1.3);
  CHECK(made.orbit.states.leftCols(nodes) == old.orbit.states.rightCols(nodes));
  CHECK(made.orbit.states.middleCols(nodes, nodes) == old.orbit.states.leftCols(nodes));
  REQUIRE(made.direction);
  CHECK(made.direction->globals == old.direction->globals);
  CHECK(made.direction->durations(0) == 11.0);
  CHECK(made.direction->durations(1) == 10.0);
  CHECK(made.direction->states.rightCols(nodes) == old.direction->states.rightCols(nodes));
}

TEST_CASE("durations beyond the new number of segments are cleared") {
  const OrbitStart made = assemble(sample(10, 4), {{1, 0.0, 1.0}});
  CHECK(made.orbit.duration(0) == 1.3);
  CHECK(made.orbit.duration(1) == 0.0);
}

TEST_CASE("own meshes: pieces have their shares of the intervals, whole segments are copied, and joined they agree") {
  const OrbitStart old = sample_on_own_meshes(5);
  const Orbit cut = assemble(old, {{0, 0.0, 1.0}, {1, 0.0, 0.25}, {1, 0.25, 1.0}}).orbit;
  CHECK(cut.shape.total_intervals() == 3 * 45);
  CHECK(std::abs(cut.shape.intervals_of(0) - 30 * 3 * 45 / 90) <= 6);
  CHECK(std::abs(3 * cut.shape.intervals_of(1) - cut.shape.intervals_of(2)) <= 12);
  CHECK(worst_error(cut, 0, 0.0) < 1e-11);
  CHECK(worst_error(cut, 1, 0.7) < 1e-11);
  CHECK(worst_error(cut, 2, 0.7 + 0.25 * 1.3) < 1e-11);

  const Orbit joined = joined_orbit(cut, {{{0, 0.0, 1.0}}, {{1, 0.0, 1.0}, {2, 0.0, 1.0}}});
  CHECK(joined.shape.total_intervals() == 2 * 45);
  CHECK(worst_error(joined, 0, 0.0) < 1e-10);
  CHECK(worst_error(joined, 1, 0.7) < 1e-10);

  const OrbitStart turned = assemble(old, {{1, 0.0, 1.0}, {0, 0.0, 1.0}});
  CHECK(turned.orbit.shape.intervals_of(0) == 60);
  CHECK(turned.orbit.shape.intervals_of(1) == 30);
  REQUIRE(turned.direction);
  const Eigen::Index nodes = old.orbit.shape.nodes_of(0);
  CHECK(turned.orbit.states.rightCols(nodes) == old.orbit.states.leftCols(nodes));
  CHECK(turned.direction->states.rightCols(nodes) == old.direction->states.leftCols(nodes));
}
