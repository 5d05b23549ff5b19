// From data and labels to orbits on the mesh of a run, compared with polynomials and circles.
#include <catch2/catch.hpp>
#include <cmath>

#include "base/messages.hpp"
#include "run/orbit_start.hpp"
#include "support/sampled_orbit.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

using State = std::function<Eigen::VectorXd(double)>;

constexpr double turn = 2.0 * 3.14159265358979323846;
const State circle = [](double t) { return Eigen::Vector2d(std::cos(turn * t), std::sin(turn * t)); };
const State cubic = [](double t) { return Eigen::Vector2d(1.0 - t + 4.0 * t * t * t, 3.0 * t * t); };

DatFile rows_of(const State& state, const std::vector<double>& tau) {
  DatFile data;
  data.tau = tau;
  data.states.resize(state(0.0).size(), static_cast<Eigen::Index>(tau.size()));
  for (std::size_t k = 0; k < tau.size(); ++k) data.states.col(static_cast<Eigen::Index>(k)) = state(tau[k]);
  return data;
}

std::vector<double> even_times(int rows) {
  std::vector<double> tau;
  for (int k = 0; k <= rows; ++k) tau.push_back(static_cast<double>(k) / rows);
  return tau;
}

/// Largest distance at the nodes; one segment.
double distance_to(const State& state, const Orbit& x) {
  double worst = 0.0;
  for (int k = 0; k < x.shape.nodes(); ++k)
    worst = std::max(worst, (x.states.col(k) - state(x.tau(k))).cwiseAbs().maxCoeff());
  return worst;
}

Orbit two_segments() {
  const ParameterVector par = parameters({0.5, 2.0, -1.0});
  return sampled_orbit({{1.5, [](double t) { return cubic(t / 1.5); }}, {0.5, [](double t) { return cubic(2.0 * t); }}},
                       2, 3, 4, par, {0.0, 0.2, 0.7, 1.0});
}

OrbitVector direction_of(const Orbit& x, int globals) {
  OrbitVector v(x.shape, globals);
  v.states = 0.1 * x.states;
  v.durations << 0.3, -0.4;
  for (int g = 0; g < globals; ++g) v.globals(g) = 1.0 + g;
  return v;
}

/// Two segments with two and four intervals of their own.
Orbit on_own_meshes() {
  Orbit x = two_segments();
  x.shape.own = OwnIntervals({2, 4});
  x.mesh = {0.0, 0.3, 1.0, 0.0, 0.1, 0.2, 0.7, 1.0};
  for (int s = 0; s < 2; ++s)
    for (int k = 0; k < x.shape.nodes_of(s); ++k)
      Eigen::VectorXd::Map(x.node(s, k), 2) = cubic(x.tau(s, k)) + Eigen::Vector2d::Constant(std::sin(3.0 * k + s));
  return x;
}

}  // namespace

TEST_CASE("cubic data are met exactly between rows of any distance") {
  const DatFile data = rows_of(cubic, {0.0, 0.07, 0.1, 0.31, 0.5, 0.52, 0.83, 0.9, 1.0});
  const Orbit x = orbit_from_data(data, {2, 1, 20, 4}, parameters({3.0}));
  CHECK(x.shape.intervals == 20);
  CHECK(x.par(0) == 3.0);
  CHECK(distance_to(cubic, x) < 1e-12);
}

TEST_CASE("many rows of a circle give it to the fourth order of their distance") {
  double before = 0.0;
  for (const int rows : {101, 202}) {
    const double error =
        distance_to(circle, orbit_from_data(rows_of(circle, even_times(rows)), {2, 1, 10, 4}, parameters({})));
    CHECK(error < 2.0 * std::pow(turn / rows, 4) / 24.0);
    if (before > 0.0) CHECK(before / error > 8.0);
    before = error;
  }
}

TEST_CASE("rows that divide intervals of a mesh are an orbit on that mesh") {
  const std::vector<double> mesh{0.0, 0.1, 0.4, 1.0};
  std::vector<double> tau;
  for (std::size_t j = 0; j < 3; ++j)
    for (int k = 0; k < 4; ++k) tau.push_back(mesh[j] + (mesh[j + 1] - mesh[j]) * k / 4);
  tau.push_back(1.0);
  const Orbit x = orbit_from_data(rows_of(circle, tau), {2, 1, 3, 4}, parameters({}));
  REQUIRE(x.mesh.size() == 4);
  for (std::size_t j = 0; j < 4; ++j) CHECK(std::abs(x.mesh[j] - mesh[j]) < 1e-14);
  CHECK(distance_to(circle, x) < 1e-14);
  CHECK_FALSE(
      orbit_from_rows(rows_of(circle, even_times(12)), {2, 1, 3, 4}, parameters({})).has_value());  // a uniform mesh
}

TEST_CASE("an orbit with its direction comes back from its label") {
  const Orbit x = two_segments();
  const OrbitVector v = direction_of(x, 2);
  const std::vector<int> listed{3, ParameterLayout().first_duration(), 1, ParameterLayout().first_duration() + 1};
  LabelledSolution label = labelled_solution(x, v, {1, 3}, listed);
  CHECK(label.parameter_direction == std::vector<double>{2.0, 0.3, 1.0, -0.4});

  const OrbitStart same = orbit_from_solution(label, x.shape, {1, 3}, "q.x");
  CHECK(same.orbit.states == x.states);
  CHECK(same.orbit.mesh == x.mesh);
  CHECK(same.orbit.par.head(3) == x.par.head(3));
  CHECK(same.orbit.duration(1) == 0.5);
  REQUIRE(same.direction.has_value());
  CHECK(same.direction->states == v.states);
  CHECK(same.direction->durations == v.durations);
  CHECK(same.direction->globals == Eigen::Vector2d(1.0, 2.0));
  const OrbitStart other_order = orbit_from_solution(label, x.shape, {3, 1}, "q.x");
  CHECK(other_order.direction->globals == Eigen::Vector2d(2.0, 1.0));
  CHECK_FALSE(orbit_from_solution(label, x.shape, {1, 2}, "q.x").direction.has_value());
}

TEST_CASE("on another mesh a label is the same polynomial") {
  const Orbit x = two_segments();
  const LabelledSolution label = labelled_solution(x, {}, {}, {});
  const Orbit y = orbit_from_solution(label, {2, 2, 9, 3}, {}, "q.x").orbit;
  REQUIRE(y.shape.intervals == 9);
  for (int s = 0; s < 2; ++s)
    for (int k = 0; k < y.shape.nodes(); ++k)
      CHECK((y.states.col(s * y.shape.nodes() + k) - cubic(y.tau(k))).norm() < 1e-13);
}

TEST_CASE("labels that do not fit are refused") {
  const Orbit x = two_segments();
  const LabelledSolution label = labelled_solution(x, {}, {}, {});
  CHECK_THROWS_AS(orbit_from_solution(label, {2, 1, 3, 4}, {}, "q.x"), UserError);
  CHECK_THROWS_AS(orbit_from_solution(label, {4, 1, 3, 4}, {}, "q.x"), UserError);  // as many states in all
  LabelledSolution folded = label;
  folded.tau[4] = folded.tau[8];
  CHECK_THROWS_WITH(orbit_from_solution(folded, x.shape, {}, "q.x"), Catch::Contains("does not rise at interval 2"));
  CHECK_THROWS_WITH(
      orbit_from_solution(labelled_solution(point_from_data(rows_of(circle, {0.0}), parameters({})), {}, {}, {}),
                          {2, 1, 3, 4}, {}, "q.x"),
      Catch::Contains("is an equilibrium, not an orbit"));
}

TEST_CASE("the period of AUTO's orbits, PAR(11), is the duration of the only segment") {
  const Orbit x = sampled_orbit({{1.0, circle}}, 2, 5, 4, parameters({0.5}));
  LabelledSolution label = labelled_solution(x, {}, {}, {});
  label.problem_type = 2;
  label.dimension = 2;
  label.parameters.assign(36, 0.0);
  label.parameters[10] = 6.25;
  const Orbit start = orbit_from_solution(label, x.shape, {}, "q.x").orbit;
  CHECK(start.duration(0) == 6.25);
  CHECK(start.par(10) == 0.0);
}

TEST_CASE("an orbit on own meshes comes back from its labelled solution, with its direction") {
  const Orbit x = on_own_meshes();
  const OrbitVector v = direction_of(x, 1);
  const LabelledSolution solution = labelled_solution(x, v, {1}, {1, 61, 62});
  CHECK(solution.own_mesh == x.mesh);
  const OrbitStart again = orbit_from_solution(solution, x.shape.in_common().with_own_meshes(), {1}, "q.x");
  CHECK(again.orbit.shape == x.shape);
  CHECK(again.orbit.mesh == x.mesh);
  CHECK((again.orbit.states - x.states).cwiseAbs().maxCoeff() < 1e-12);
  REQUIRE(again.direction.has_value());
  CHECK((again.direction->states - v.states).cwiseAbs().maxCoeff() < 1e-12);
  CHECK(again.direction->durations == v.durations);
}

TEST_CASE("own meshes of another size keep their share of the intervals, and a mesh in common is dealt out anew") {
  const Orbit x = on_own_meshes();
  const LabelledSolution solution = labelled_solution(x, {}, {}, {});
  const Orbit larger = orbit_from_solution(solution, OrbitShape{2, 2, 30, 4}.with_own_meshes(), {1}, "q.x").orbit;
  CHECK(larger.shape.intervals_of(0) + larger.shape.intervals_of(1) == 60);
  CHECK(std::abs(larger.shape.intervals_of(1) - 40) <= 3);
  const Orbit common = orbit_from_solution(solution, {2, 2, 30, 4}, {1}, "q.x").orbit;
  CHECK_FALSE(common.shape.own);

  const double sharp = 40.0;
  const ParameterVector par = parameters({0.5});
  const auto smooth = [](double t) { return Eigen::Vector2d(std::cos(t), std::sin(t)); };
  const auto layer = [&](double t) { return Eigen::Vector2d(std::exp(-sharp * t), std::sin(t)); };
  const Orbit both = sampled_orbit({{1.0, layer}, {1.0, smooth}}, 2, 100, 4, par);
  const LabelledSolution fine = labelled_solution(both, {}, {}, {});
  const Orbit dealt = orbit_from_solution(fine, OrbitShape{2, 2, 20, 4}.with_own_meshes(), {1}, "q.x").orbit;
  CHECK(dealt.shape.intervals_of(0) > 2 * dealt.shape.intervals_of(1));
  const Orbit same = orbit_from_solution(fine, both.shape.with_own_meshes(), {1}, "q.x").orbit;
  CHECK(same.states == both.states);
}

TEST_CASE("data give each segment a mesh of its own") {
  DatFile data;
  for (int k = 0; k <= 400; ++k) {
    data.tau.push_back(k / 400.0);
    data.states.conservativeResize(2, k + 1);
    data.states.col(k) << std::exp(-60.0 * k / 400.0), std::cos(k / 400.0);
  }
  ParameterVector par = parameters({0.5});
  par.durations(2).setOnes();
  const Orbit x = orbit_from_data(data, OrbitShape{1, 2, 20, 4}.with_own_meshes(), par);
  CHECK(x.shape.total_intervals() == 40);
  CHECK(x.shape.intervals_of(0) > x.shape.intervals_of(1));
  for (int s = 0; s < 2; ++s)
    for (int k = 0; k < x.shape.nodes_of(s); ++k) {
      const double tau = x.tau(s, k), exact = s == 0 ? std::exp(-60.0 * tau) : std::cos(tau);
      CHECK(std::abs(x.node(s, k)[0] - exact) < 1e-3);
    }
}
