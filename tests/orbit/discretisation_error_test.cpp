// The estimated error of collocation solutions, against the solutions that they stand for.
#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cmath>

#include "orbit/collocation_rule.hpp"
#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

/// x = x(0) exp(sin(omega t)), y = t: x' = omega x cos(omega y). Collocation is linear in x.
struct Pulsation {
  static constexpr int dimension = 2, parameters = 1, fields = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    using std::cos;
    f[0] = x[1] < 0.0 ? T(NAN) : p[0] * x[0] * cos(p[0] * x[1]);
    f[1] = T(1.0);
  }
};

double exact(double omega, double t) { return std::exp(std::sin(omega * t)); }

/// The collocation polynomials from x = 1 on, one interval after the other.
Orbit collocated(double omega, double duration, int intervals, const CollocationRule& rule) {
  const int c = rule.points();
  Orbit x{{2, 1, intervals, c}, uniform_mesh(intervals), {}, parameters({omega})};
  x.states.resize(2, x.shape.columns());
  x.duration(0) = duration;
  for (int k = 0; k < x.shape.nodes(); ++k) x.states(1, k) = x.tau(k) * duration;
  x.states(0, 0) = 1.0;
  const double h = duration / intervals;
  for (int j = 0; j < intervals; ++j) {
    const Eigen::VectorXd times = (j + rule.gauss.array()).matrix() * h;
    const Eigen::VectorXd rates = h * omega * (omega * times.array()).cos();
    const Eigen::MatrixXd rows = rule.slope - rates.asDiagonal() * rule.value;
    x.states.row(0).segment(j * c + 1, c) =
        rows.rightCols(c).partialPivLu().solve(-rows.col(0) * x.states(0, j * c)).transpose();
  }
  return x;
}

/// The largest error of x between mesh points, relative to 1 + max |u|.
double error_of(const Orbit& x, double omega, const CollocationRule& rule) {
  constexpr int parts = 50;
  const int c = rule.points();
  Eigen::VectorXd basis(c + 1);
  double worst = 0.0;
  for (int j = 0; j < x.shape.intervals; ++j)
    for (int k = 0; k <= parts; ++k) {
      const double sigma = static_cast<double>(k) / parts;
      rule.basis(sigma, basis.data(), nullptr);
      const double t = x.duration(0) * (j + sigma) / x.shape.intervals;
      worst = std::max(worst, std::abs(x.states.row(0).segment(j * c, c + 1).dot(basis) - exact(omega, t)));
    }
  return worst / (1.0 + x.states.cwiseAbs().maxCoeff());
}

double estimate(const Orbit& x, const CollocationRule& rule) {
  return estimated_error(system_of<Pulsation>(), {{1, no_function, no_function}}, x, rule);
}

}  // namespace

TEST_CASE("estimated error: that between mesh points where the mesh resolves the orbit") {
  const int c = GENERATE(2, 3, 4, 5, 7);
  const CollocationRule rule(c);
  for (const int intervals : {20, 40}) {
    const Orbit x = collocated(1.0, 2.0 * pi, intervals, rule);
    const double error = error_of(x, 1.0, rule);
    CAPTURE(c, intervals, error, estimate(x, rule));
    // Below 1e-13 the error is rounding.
    if (error < 1e-13) continue;
    CHECK(estimate(x, rule) > 0.5 * error);
    CHECK(estimate(x, rule) < 2.0 * error);
  }
}

TEST_CASE("estimated error: not far too small where the mesh does not resolve the orbit") {
  const int c = GENERATE(2, 3, 4, 5);
  const CollocationRule rule(c);
  for (const int intervals : {1, 2, 3, 5, 8}) {
    const Orbit x = collocated(1.0, 2.0 * pi, intervals, rule);
    const double error = error_of(x, 1.0, rule);
    CAPTURE(c, intervals, error, estimate(x, rule));
    CHECK(estimate(x, rule) > 0.1 * error);
    CHECK(estimate(x, rule) < 100.0 * error);
  }
}

TEST_CASE("estimated error: a field without a value at the start of a segment hides nothing else") {
  const CollocationRule rule(3);
  Orbit x = collocated(1.0, 2.0 * pi, 8, rule);
  const double known = estimate(x, rule);
  x.states(1, 0) = -1e-18;
  CHECK(estimate(x, rule) > 0.3 * known);
  CHECK(estimate(x, rule) <= known);
}

TEST_CASE("estimated error: segments without duration have none, and states that are not finite no finite one") {
  const CollocationRule rule(3);
  Orbit x = collocated(1.0, 2.0 * pi, 4, rule);
  Orbit still = x;
  still.duration(0) = 0.0;
  CHECK(estimate(still, rule) == 0.0);
  x.states(0, 0) = INFINITY;
  CHECK_FALSE(std::isfinite(estimate(x, rule)));
}
