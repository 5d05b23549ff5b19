// Newton matrices whose elimination several threads share: of many segments, of one segment in many dimensions. To the
// last bit what one thread makes of them, which other tests compare with independent results; and of 50 dimensions,
// solutions against differences of the residual.
#include <catch2/catch.hpp>
#include <cmath>

#include "directional_derivative.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "support/oscillator_ring.hpp"
#include "support/sampled_orbit.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

/// An orbit that solves nothing, on an uneven mesh.
Orbit any_orbit(const OrbitShape& shape) {
  Orbit x{shape, uniform_mesh(shape), Eigen::MatrixXd(shape.dimension, shape.columns()), parameters({0.9, 0.3, 0.2})};
  for (double& tau : x.mesh) tau = std::pow(tau, 1.3);
  for (Eigen::Index k = 0; k < x.states.cols(); ++k)
    for (Eigen::Index i = 0; i < x.states.rows(); ++i)
      x.states(i, k) = std::sin(0.3 + 0.9 * static_cast<double>(i) + 0.011 * static_cast<double>(k));
  for (int s = 0; s < shape.segments; ++s) x.duration(s) = 0.7 + 0.02 * s;
  return x;
}

/// A problem that threads share in one of the two ways.
struct Shared {
  PeriodicOrbitSystem system;
  OrbitShape shape;
  EliminationThreads two;  // how two threads share it
};

template <int N>
Shared shared(int segments, int intervals, int collocation, const EliminationThreads& two) {
  return {PeriodicOrbitSystem(system_of<OscillatorRing<N>>(), Signature(static_cast<std::size_t>(segments), {1, 1, 1}),
                              {1}),
          {N, segments, intervals, collocation},
          two};
}

Shared many_segments() { return shared<4>(64, 20, 4, {2, 1}); }
/// Each of two segments has as many intervals as the other one lacks of twice 20.
Shared different_segments() {
  Shared result = many_segments();
  std::vector<int> counts;
  for (int s = 0; s < 64; ++s) counts.push_back(s % 2 == 0 ? 5 + s / 4 : 40 - counts.back());
  result.shape.own = OwnIntervals(counts);
  return result;
}

Shared many_dimensions() { return shared<50>(2, 21, 2, {1, 2}); }

Shared many_dimensions_on_own_meshes() {
  Shared result = many_dimensions();
  result.shape.own = OwnIntervals({9, 33});
  return result;
}

/// Everything that is asked of a Newton matrix.
struct Answers {
  Linearization outcome;
  OrbitResidual residual;
  OrbitVector solution, homogeneous, extended;
  std::vector<double> adjoint;
  CondensedSystem::Determinant determinant;
};

Answers answers(const Shared& problem, int threads) {
  const Orbit x = any_orbit(problem.shape);
  CondensedSystem condensed(problem.system, problem.shape, {1}, threads);
  if (threads == 2) {
    CHECK(condensed.threads().segments == problem.two.segments);
    CHECK(condensed.threads().within == problem.two.within);
  }
  const std::vector<OrbitVector> rows{random_vector(condensed, 3)};
  Answers a{Linearization::singular,
            condensed.make_residual(),
            condensed.make_vector(),
            condensed.make_vector(),
            random_vector(condensed, 4),
            std::vector<double>(condensed.make_residual().collocation.size()),
            {}};
  a.outcome = condensed.linearize(x, rows, a.residual);
  condensed.solve(a.residual, std::vector<double>{0.3}, a.solution);
  condensed.solve(std::vector<double>{1.0}, a.homogeneous);
  const OrbitShape& shape = problem.shape;
  const int n = shape.dimension;
  const std::vector<double> ends(static_cast<std::size_t>(shape.segments * (2 * n + 1)), 0.25);
  condensed.extend(ends.data(), a.extended);
  const std::vector<double> weights(static_cast<std::size_t>(shape.segments * n), -0.5);
  condensed.extend_adjoint(weights.data(), a.adjoint);
  a.determinant = condensed.determinant();
  return a;
}

void check_same(const OrbitVector& a, const OrbitVector& b) {
  CHECK(a.states == b.states);
  CHECK(a.durations == b.durations);
  CHECK(a.globals == b.globals);
}

}  // namespace

TEST_CASE("threads that share segments, or the pieces of one, change no bit") {
  const Shared problem =
      GENERATE(many_segments(), different_segments(), many_dimensions(), many_dimensions_on_own_meshes());
  CAPTURE(problem.shape.dimension);
  const Answers alone = answers(problem, 1);
  REQUIRE(alone.outcome == Linearization::ready);
  CHECK(alone.solution.states.allFinite());
  for (const int threads : {2, 3, 5}) {
    CAPTURE(threads);
    for (int turn = 0; turn < 3; ++turn) {
      const Answers together = answers(problem, threads);
      REQUIRE(together.outcome == Linearization::ready);
      CHECK(together.residual.collocation == alone.residual.collocation);
      CHECK(together.residual.coupling == alone.residual.coupling);
      check_same(together.solution, alone.solution);
      check_same(together.homogeneous, alone.homogeneous);
      check_same(together.extended, alone.extended);
      CHECK(together.adjoint == alone.adjoint);
      CHECK(together.determinant.sign == alone.determinant.sign);
      CHECK(together.determinant.log2_size == alone.determinant.log2_size);
    }
  }
}

TEST_CASE("little work is left to one thread") {
  const Shared small = shared<4>(2, 50, 4, {1, 1});
  const CondensedSystem condensed(small.system, small.shape, {1}, 8);
  CHECK(condensed.threads().segments == 1);
  CHECK(condensed.threads().within == 1);
}

TEST_CASE("50 dimensions: solving with the differences of the residual along a direction gives the direction back") {
  const int threads = GENERATE(1, 2);
  const Shared problem = many_dimensions();
  const Orbit x = any_orbit(problem.shape);
  CondensedSystem condensed(problem.system, problem.shape, {1}, threads);
  const OrbitVector v = random_vector(condensed, 1);
  const std::vector<OrbitVector> rows{random_vector(condensed, 10)};
  OrbitResidual residual = condensed.make_residual();
  REQUIRE(condensed.linearize(x, rows, residual) == Linearization::ready);
  OrbitResidual change = directional_derivative(condensed, x, v);
  negate(change);
  OrbitVector found = condensed.make_vector();
  condensed.solve(change, std::vector<double>{dot(rows[0], v)}, found);
  // Differences are exact to about 1e-12 for a field of third degree.
  CHECK((found.states - v.states).cwiseAbs().maxCoeff() < 1e-7);
  CHECK((found.durations - v.durations).cwiseAbs().maxCoeff() < 1e-7);
  CHECK(std::abs(found.globals(0) - v.globals(0)) < 1e-7);
}

TEST_CASE("what cannot be evaluated is told alike by any number of threads") {
  const Shared problem = GENERATE(many_segments(), many_dimensions());
  for (const int threads : {1, 2}) {
    CondensedSystem condensed(problem.system, problem.shape, {1}, threads);
    const std::vector<OrbitVector> rows{random_vector(condensed, 3)};
    OrbitResidual residual = condensed.make_residual();
    for (const Eigen::Index column : {Eigen::Index{1}, static_cast<Eigen::Index>(problem.shape.columns() - 2)}) {
      Orbit x = any_orbit(problem.shape);
      x.states(1, column) = NAN;
      CHECK(condensed.linearize(x, rows, residual) == Linearization::not_finite);
    }
    Orbit x = any_orbit(problem.shape);
    x.mesh[2] = x.mesh[3] = x.mesh[4];  // no length, no field: what is left is regular
    CHECK(condensed.linearize(x, rows, residual) == Linearization::ready);
  }
}
