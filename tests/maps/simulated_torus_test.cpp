// A torus in closed form: a harmonic oscillator of frequency omega that is looked at once a unit of time. Its return
// map is the rotation by omega, its invariant curves are circles, rho = omega / (2 pi).
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "base/messages.hpp"
#include "maps/simulated_torus.hpp"
#include "support/test_system.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double omega = 2.0;
constexpr double radius = 0.7;

/// x' = omega y, y' = -omega x and a clock that is set back to 0 at 1.
struct Watched {
  static constexpr int dimension = 3, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = p[0] * x[1];
    f[1] = -p[0] * x[0];
    f[2] = 1.0;
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return 1.0 - x[2];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* y) const {
    y[0] = x[0];
    y[1] = x[1];
    y[2] = T(0.0);
  }
};

Eigen::Vector3d on_circle(double angle) { return {radius * std::sin(angle), radius * std::cos(angle), 0.0}; }

const Signature one_return{{1, 1, 1}};

}  // namespace

TEST_CASE("points of returns begin where the signature does") {
  const IndexVector a{1, 1, 1}, b{2, 2, 2};
  const auto at = [](double value) { return Eigen::VectorXd::Constant(1, value); };
  // The transient ended within a return: the motion begins with its second segment.
  const std::vector<PassedSegment> motion{{b, at(0.0)}, {a, at(1.0)}, {b, at(2.0)}, {a, at(3.0)}, {b, at(4.0)}};
  const Eigen::MatrixXd points = points_of_returns(motion, {a, b}, "test");
  REQUIRE(points.cols() == 2);
  CHECK(points(0, 0) == 1.0);
  CHECK(points(0, 1) == 3.0);

  const std::vector<PassedSegment> leaving{{a, at(0.0)}, {b, at(1.0)}, {a, at(2.0)}, {a, at(3.0)}};
  CHECK_THROWS_WITH(points_of_returns(leaving, {a, b}, "test"),
                    Catch::StartsWith("test: ") && Catch::Contains("segment 4"));
}

TEST_CASE("no state of a circle on a section is an angle") {
  ParameterVector par{ParameterLayout()};
  par(0) = omega;
  Eigen::MatrixXd points(3, 60);
  for (Eigen::Index k = 0; k < points.cols(); ++k) points.col(k) = on_circle(omega * static_cast<double>(k));
  const PointsWithAngles found = with_angles(system_of<Watched>(), one_return, points, par);
  CHECK(found.winding.empty());
  CHECK(found.points == points);
}

TEST_CASE("orbits from the fitted curve start at equal phases, last one return and end a rotation further") {
  Eigen::MatrixXd points(3, 400);
  for (Eigen::Index k = 0; k < points.cols(); ++k) points.col(k) = on_circle(omega * static_cast<double>(k));
  const FittedCurve fitted = fit_invariant_curve(points, {}, "test");
  const double rho = fitted.curve.rotation();  // either way round
  CHECK(std::min(std::abs(rho - omega / (2 * pi)), std::abs(1.0 - rho - omega / (2 * pi))) < 1e-10);

  ParameterVector par{ParameterLayout()};
  par(0) = omega;
  constexpr int orbits = 5;
  const Orbit x = orbits_from_curve(system_of<Watched>(), one_return, fitted.curve, par, {orbits, 8, 4}, 1.0,
                                    Eigen::VectorXd::Ones(3));
  REQUIRE(x.shape.segments == orbits);
  CHECK(x.par.rotation() == Approx(rho));
  for (int i = 0; i < orbits; ++i) {
    CHECK(x.duration(i) == Approx(1.0).margin(1e-9));
    const Eigen::Map<const Eigen::Vector3d> start(x.start(i)), end(x.end(i));
    CHECK(start.head<2>().norm() == Approx(radius).margin(1e-7));
    const double turned = std::atan2(start.x(), start.y()) + omega;
    CHECK((end.head<2>() - on_circle(turned).head<2>()).norm() < 1e-7);
    const double next = 2 * pi / orbits;  // of phases, either way round
    const Eigen::Map<const Eigen::Vector3d> other(x.start((i + 1) % orbits));
    CHECK((other - start).norm() == Approx(2.0 * radius * std::sin(0.5 * next)).margin(1e-6));
  }
}
