// Location of zeros on a step.
#include <catch2/catch.hpp>
#include <cmath>

#include "stability/test_function.hpp"

using namespace tchat;

namespace {

LocatedZero located(const std::function<double(double)>& f, double ds, double tolerance, int most = 40) {
  return locate_zero([&](double at) { return std::optional<double>(f(at)); }, ds, f(0.0), f(ds), tolerance, 0.0, most);
}

}  // namespace

TEST_CASE("zeros on steps in both directions, steep and flat, to the tolerance") {
  for (const double ds : {1.0, -1.0, 0.01, -3.0}) {
    CAPTURE(ds);
    const double zero = 0.37 * ds;
    // 120 evaluations: a triple zero is found by bisection only.
    for (const auto& f : std::vector<std::function<double(double)>>{
             [&](double s) { return (s - zero) / ds; }, [&](double s) { return std::expm1(8 * (s - zero) / ds); },
             [&](double s) { return std::pow((s - zero) / ds, 3); },
             [&](double s) { return std::atan(100 * (s - zero) / ds); }}) {
      const LocatedZero found = located(f, ds, 1e-9 * std::abs(ds), 120);
      CHECK(found.converged());
      CHECK(std::abs(found.ds - zero) < 2e-9 * std::abs(ds));
      CHECK(std::abs(found.value) <= std::abs(f(0.0)));
    }
  }
}

TEST_CASE("smooth functions take few evaluations") {
  const LocatedZero found = located([](double s) { return std::sin(s) - 0.5; }, 1.0, 1e-12);
  CHECK(found.converged());
  CHECK(found.ds == Approx(std::asin(0.5)).epsilon(1e-11));
  CHECK(found.evaluations <= 12);
}

TEST_CASE("out of evaluations: not converged, the best point so far") {
  const LocatedZero found = located([](double s) { return std::atan(1e4 * (s - 0.3)); }, 1.0, 1e-14, 4);
  CHECK_FALSE(found.converged());
  CHECK(found.evaluations <= 5);
}

TEST_CASE("a trial step that fails or gives NaN ends the search with what is known") {
  const auto failing = [](double s) { return s > 0.2 && s < 0.9 ? std::nullopt : std::optional<double>(s - 0.5); };
  CHECK_FALSE(locate_zero(failing, 1.0, -0.5, 0.5, 1e-9, 0.0, 30).converged());
  const auto undefined = [](double) { return std::optional<double>(NAN); };
  CHECK_FALSE(locate_zero(undefined, 1.0, -0.5, 0.5, 1e-9, 0.0, 30).converged());
}

TEST_CASE("a value at rounding level counts as the zero") {
  const LocatedZero found =
      locate_zero([](double s) { return std::optional<double>(1e-3 * (s - 0.5)); }, 1.0, -5e-4, 5e-4, 1e-15, 1e-6, 30);
  CHECK(found.converged());
  CHECK(std::abs(found.value) <= 1e-6);
}

TEST_CASE("a zero just before the end of the step, where the value is next to nothing") {
  for (const double distance : {1e-12, 1e-9, 1e-8, 3e-8}) {
    CAPTURE(distance);
    const LocatedZero found = located([=](double s) { return s - (0.1 - distance); }, 0.1, 1e-7);
    CHECK(found.converged());
    CHECK(std::abs(found.ds - (0.1 - distance)) < 1e-7);
  }
}

TEST_CASE("jumps and poles are no zeros, steep functions are none of these") {
  const auto jump = [](double s) { return s < 0.37 ? -1.0 : 1e-6; };
  CHECK(located(jump, 1.0, 1e-9, 400).status == ZeroSearch::jump);
  CHECK(located([](double s) { return 1.0 / (s - 0.37); }, 1.0, 1e-9, 80).status == ZeroSearch::jump);
  CHECK(located([](double s) { return std::cbrt(s - 0.37); }, 1.0, 1e-9, 80).status == ZeroSearch::located);
  CHECK(located([](double s) { return std::atan(1e5 * (s - 0.37)); }, 1.0, 1e-9, 80).status == ZeroSearch::located);
}
