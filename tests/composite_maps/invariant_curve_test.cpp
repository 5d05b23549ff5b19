#include <Eigen/Dense>
#include <algorithm>
#include <catch2/catch.hpp>

#include "base/messages.hpp"
#include "maps/invariant_curve.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double two_pi = 6.283185307179586476925;
constexpr double golden = 0.38196601125010515;
constexpr double other = 0.7071067811865476;

/// A curve in space with infinitely many harmonics, and one state that is an angle.
Eigen::Vector3d ring(double phi) {
  const double s = std::sin(two_pi * phi), c = std::cos(two_pi * phi);
  return {c / (1.3 - 0.4 * s), 0.5 * s + 0.1 * std::exp(c), two_pi * phi + 0.3 * s};
}

MatrixXd points_of(double rotation, int count, bool reduced_angle = true) {
  MatrixXd points(3, count);
  for (int k = 0; k < count; ++k) {
    points.col(k) = ring(rotation * k);
    if (reduced_angle) points(2, k) -= two_pi * std::floor(points(2, k) / two_pi);
  }
  return points;
}

}  // namespace

TEST_CASE("a curve with known phase from its points: rotation number, values, derivatives") {
  const MatrixXd points = points_of(golden, 2000);
  CurveSettings settings;
  settings.angles = {2};
  const FittedCurve fit = fit_invariant_curve(points, settings, "points");
  CHECK(std::abs(fit.curve.rotation() - golden) < 1e-14);
  CHECK(fit.error < 1e-12);
  CHECK(fit.curve.is_angle(2));
  CHECK_FALSE(fit.curve.is_angle(0));
  for (const double phi : {0.0, 0.123, 0.5, 0.9}) {
    CHECK(fit.curve.difference(fit.curve.at(phi), ring(phi)).cwiseAbs().maxCoeff() < 1e-11);
    const double h = 1e-4;
    const VectorXd first = (ring(phi + h) - ring(phi - h)) / (2.0 * h);
    const VectorXd second = (ring(phi + h) - 2.0 * ring(phi) + ring(phi - h)) / (h * h);
    CHECK((fit.curve.derivative(phi) - first).cwiseAbs().maxCoeff() < 3e-6);      // h^2 u''' / 6
    CHECK((fit.curve.derivative(phi, 2) - second).cwiseAbs().maxCoeff() < 2e-4);  // likewise, and rounding / h^2
  }
}

TEST_CASE("without angles the phase turns about the curve's centre, and noise is told as the error of the fit") {
  MatrixXd points = points_of(other, 1500).topRows(2);
  const FittedCurve clean = fit_invariant_curve(points, {}, "points");
  // Either way round the curve: rho or 1 - rho.
  CHECK(std::min(std::abs(clean.curve.rotation() - other), std::abs(clean.curve.rotation() - (1.0 - other))) < 1e-13);
  for (Eigen::Index k = 0; k < points.cols(); ++k) points(0, k) += 1e-8 * std::sin(1e3 * static_cast<double>(k * k));
  const FittedCurve noisy = fit_invariant_curve(points, {}, "points");
  CHECK(noisy.error > 1e-9);
  CHECK(noisy.error < 2e-8);
  CHECK(noisy.rotation_error < 1e-10);
  CHECK(std::abs(noisy.curve.rotation() - clean.curve.rotation()) < 10.0 * noisy.rotation_error);
}

TEST_CASE("points that are no torus are refused with the reason") {
  CHECK_THROWS_WITH(fit_invariant_curve(points_of(golden, 50), {}, "O.events"),
                    Catch::Contains("O.events: 50 points") && Catch::Contains("too few"));
  CHECK_THROWS_WITH(fit_invariant_curve(points_of(0.4, 1000).topRows(2), {}, "O.events"),
                    Catch::Contains("is a periodic orbit") && Catch::Contains("every 5 points it repeats"));
  Eigen::MatrixXd settling(2, 1000);
  for (Eigen::Index k = 0; k < settling.cols(); ++k) {
    const double phase = 2.0 * M_PI * golden * static_cast<double>(k);
    settling.col(k) = Eigen::Vector2d(1.0, 2.0) +
                      std::exp(-0.03 * static_cast<double>(k)) * Eigen::Vector2d(std::cos(phase), std::sin(phase));
  }
  CHECK_THROWS_WITH(fit_invariant_curve(settling, {}, "O.events"),
                    Catch::Contains("settles on a periodic orbit: every point repeats"));
  MatrixXd cloud(2, 1000);
  double x = 0.3, y = 0.2;
  for (int k = 0; k < 1000; ++k) {
    const double moved = 1.0 - 1.4 * x * x + y;  // Henon's attractor
    y = 0.3 * x, x = moved;
    cloud.col(k) << x, y;
  }
  CHECK_THROWS_WITH(fit_invariant_curve(cloud, {}, "O.events"), Catch::Contains("no smooth closed curve"));
}

TEST_CASE("projections to a curve: by an angle, by the angle of a pair, to the nearest point") {
  CurveSettings settings;
  settings.angles = {2};
  const InvariantCurve curve = fit_invariant_curve(points_of(golden, 2000), settings, "points").curve;
  const CurveProjection nearest(curve), by_angle(curve, 2), by_pair(curve, 1, 0);
  for (const double phi : {0.05, 0.3, 0.62, 0.97}) {
    const VectorXd u = curve.at(phi);
    for (const CurveProjection* projection : {&nearest, &by_angle, &by_pair})
      CHECK(std::abs(projection->phase(u) - phi) < 1e-11);
    VectorXd x = u;
    x(0) += 1e-3, x(1) -= 2e-3;
    CHECK(std::abs(by_angle.phase(x) - phi) < 1e-11);
    const double pair = by_pair.phase(x);
    const VectorXd on_curve = curve.at(pair);
    CHECK(std::atan2(on_curve(1), on_curve(0)) == Approx(std::atan2(x(1), x(0))).margin(1e-11));
    // No point of the curve is nearer than the nearest, in the metric of extents.
    const VectorXd scale = curve.extent().cwiseMax(0.1 * curve.extent().maxCoeff());
    const auto distance = [&](double at) { return curve.difference(x, curve.at(at)).cwiseQuotient(scale).norm(); };
    const double found = nearest.phase(x);
    for (int k = 0; k < 1000; ++k) CHECK(distance(found) <= distance(k / 1000.0) + 1e-12);
    for (const CurveProjection* projection : {&nearest, &by_angle, &by_pair}) {
      const Eigen::RowVectorXd gradient = projection->gradient(x, projection->phase(x));
      for (Eigen::Index i = 0; i < 3; ++i) {
        VectorXd forward = x, backward = x;
        forward(i) += 1e-5, backward(i) -= 1e-5;
        CHECK(gradient(i) == Approx((projection->phase(forward) - projection->phase(backward)) / 2e-5).margin(1e-7));
      }
    }
  }
  CHECK_THROWS_WITH(CurveProjection(curve, 0, 2), Catch::Contains("no graph"));
}
