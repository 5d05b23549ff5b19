// Orbits along which perturbations grow by e^100 and decay by e^-100: the linear solver keeps the information of both,
// however little they change from one mesh interval to the next. Elimination from one end to the other, with pivots
// among neighbouring rows, does not: it becomes a product of transfer matrices (S. J. Wright, SIAM J. Sci. Comput. 14
// (1993) 231).
#include <Eigen/Dense>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "directional_derivative.hpp"
#include "support/branch_fixture.hpp"
#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

/// x = Q y, Q a rotation that mixes all states; y1, y2 the unit circle with angular frequency PAR(1), attracting, and
/// y_k' = PAR(1) rate_k y_k / (2 pi) beside it. Event j: the angle 2 pi j / 64. The multipliers are e^rate_k, k = 2..8.
struct Dichotomy {
  static constexpr int dimension = 8, parameters = 1, fields = 1, events = 64, jumps = 1;
  static constexpr std::array<double, 8> rates{0.0, -100.0, 100.0, -100.0, -100.0, -100.0, -20.0, -3.0};
  using Frame = Eigen::Matrix<double, dimension, dimension>;

  /// A Hadamard matrix: every state has the same share of every mode, so that the flow over one interval has diagonal
  /// entries below 1, the mean of its multipliers.
  static const Frame& frame() {
    static const Frame q = [] {
      Eigen::Matrix2d two;
      two << 1, 1, 1, -1;
      Frame h;
      for (int i = 0; i < dimension; ++i)
        for (int k = 0; k < dimension; ++k)
          h(i, k) = two(i & 1, k & 1) * two(i >> 1 & 1, k >> 1 & 1) * two(i >> 2, k >> 2);
      return Frame(h / std::sqrt(dimension));
    }();
    return q;
  }
  template <class T>
  static void to_x(const T* y, T* x) {
    for (int i = 0; i < dimension; ++i) {
      x[i] = frame()(i, 0) * y[0];
      for (int k = 1; k < dimension; ++k) x[i] += frame()(i, k) * y[k];
    }
  }
  template <class T>
  static void to_y(const T* x, T* y) {
    for (int i = 0; i < dimension; ++i) {
      y[i] = frame()(0, i) * x[0];
      for (int k = 1; k < dimension; ++k) y[i] += frame()(k, i) * x[k];
    }
  }
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    T y[dimension];
    T slope[dimension];
    to_y(x, y);
    // r' = pull r: the rate of r - 1 is -2 kappa
    const T pull = -0.5 * rates[1] / (2 * pi) * (1.0 - y[0] * y[0] - y[1] * y[1]);
    slope[0] = par[0] * (pull * y[0] - y[1]);
    slope[1] = par[0] * (pull * y[1] + y[0]);
    for (int k = 2; k < dimension; ++k) slope[k] = par[0] * (rates[static_cast<std::size_t>(k)] / (2 * pi)) * y[k];
    to_x(slope, f);
  }
  template <class T>
  T event(int j, const T* x, const T*) const {
    T y[dimension];
    to_y(x, y);
    const double angle = 2 * pi * j / events;
    return std::sin(angle) * y[0] - std::cos(angle) * y[1];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
  }

  /// The circle, cut into m equal segments.
  static Signature signature(int m) {
    Signature result;
    for (int s = 1; s <= m; ++s) result.push_back({1, s * events / m, 1});
    return result;
  }
  static Orbit orbit(int m, int intervals) {
    std::vector<Piece> pieces;
    for (int s = 0; s < m; ++s)
      pieces.push_back({2 * pi / m, [=](double t) {
                          const double angle = 2 * pi * s / m + t;
                          Eigen::VectorXd y = Eigen::VectorXd::Zero(dimension);
                          Eigen::VectorXd x(dimension);
                          y(0) = std::cos(angle), y(1) = std::sin(angle);
                          to_x(y.data(), x.data());
                          return x;
                        }});
    return sampled_orbit(pieces, dimension, intervals, 4, test::parameters({1.0}));
  }
};

struct Cut {
  int segments, intervals;
};

}  // namespace

TEST_CASE("growth by e^100 beside decay by e^-100: the linear system is solved to rounding") {
  const Cut cut =
      GENERATE(Cut{1, 10}, Cut{1, 50}, Cut{1, 100}, Cut{1, 400}, Cut{1, 3000}, Cut{2, 200}, Cut{64, 1}, Cut{64, 7});
  CAPTURE(cut.segments, cut.intervals);
  const Orbit x = Dichotomy::orbit(cut.segments, cut.intervals);
  const PeriodicOrbitSystem system(system_of<Dichotomy>(), Dichotomy::signature(cut.segments), {1});
  CondensedSystem condensed(system, x.shape, {1});
  const OrbitVector v = random_vector(condensed, 1);
  const std::vector<OrbitVector> rows{random_vector(condensed, 2)};
  OrbitResidual residual = condensed.make_residual();
  REQUIRE(condensed.linearize(x, rows, residual) == Linearization::ready);
  OrbitVector found = condensed.make_vector();
  // F is of third degree in the states, linear in durations and parameter, of fifth degree together: differences of
  // fourth order with steps of 1e-3 leave 1e-11.
  OrbitResidual change = directional_derivative(condensed, x, v);
  negate(change);
  condensed.solve(change, std::vector<double>{dot(rows[0], v)}, found);
  CHECK((found.states - v.states).cwiseAbs().maxCoeff() < 1e-7);
  CHECK((found.durations - v.durations).cwiseAbs().maxCoeff() < 1e-7);
  CHECK((found.globals - v.globals).cwiseAbs().maxCoeff() < 1e-7);
}

TEST_CASE("growth by e^100 beside decay by e^-100: Newton finds the orbit from nearby and its multipliers below 1") {
  const Cut cut = GENERATE(Cut{1, 50}, Cut{1, 100}, Cut{1, 400}, Cut{64, 7});
  CAPTURE(cut.segments, cut.intervals);
  const Orbit exact = Dichotomy::orbit(cut.segments, cut.intervals);
  Orbit start = exact;
  for (Eigen::Index k = 0; k < start.states.cols(); ++k)
    for (Eigen::Index i = 0; i < start.states.rows(); ++i)
      start.states(i, k) += 1e-3 * std::sin(0.1 * static_cast<double>(k) + static_cast<double>(i));
  PeriodicOrbits orbits(system_of<Dichotomy>(), Dichotomy::signature(cut.segments), 1, start.shape);
  const PathPoint point = orbits.corrected(start);
  CHECK(orbits.result.converged());
  CHECK(orbits.result.iterations <= 6);
  CHECK(mesh_point_distance(point.orbit, exact) < (cut.intervals == 50 ? 1e-8 : 1e-10));
  CHECK(std::abs(point.orbit.period() - 2 * pi) < (cut.intervals == 50 ? 1e-8 : 1e-10));
  const FloquetMultipliers found = orbits.multipliers(point);
  REQUIRE(found.valid);
  const auto nearest = [&](double value) {
    double result = 1e300;
    for (const auto& mu : found.values) result = std::min(result, std::abs(mu - value));
    return result;
  };
  CHECK(nearest(std::exp(-3.0)) < 1e-8);
  CHECK(nearest(std::exp(-20.0)) < 1e-12);
  CHECK(found.structural < 1e-6);  // divided by what decays it is 1e28
  CHECK(found.stable_count() == 7);
}
