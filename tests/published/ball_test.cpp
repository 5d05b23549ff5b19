// The ball on a table that moves up and down harmonically, as problems/ball/Makefile runs it, against closed forms.
//
// A ball that bounces once in each period 2 pi of the table leaves it with velocity pi and comes back with -pi. With
// c = Gamma cos phi and s = Gamma sin phi the table's velocity and height at the impacts,
//
//     pi = r pi + (1 + r) c,   c = pi (1 - r) / (1 + r),   s^2 = Gamma^2 - c^2 :
//
// two orbits, s > 0 and s < 0, which meet in a fold at Gamma = c. The map of phase and velocity from one impact to the
// next has the determinant r^2 and the trace 1 + r^2 - (1 + r)^2 s, hence the multiplier -1 at s = 2 (1 + r^2) / (1 +
// r)^2.
#include <catch2/catch.hpp>
#include <cmath>

#include "published/makefile_run.hpp"

using namespace test_support;

namespace {

constexpr double pi = 3.14159265358979323846;

double impact_speed_of_table(double r) { return pi * (1.0 - r) / (1.0 + r); }
double height_at_doubling(double r) { return 2.0 * (1.0 + r * r) / ((1.0 + r) * (1.0 + r)); }
double fold(double r) { return impact_speed_of_table(r); }
double doubling(double r) { return std::hypot(impact_speed_of_table(r), height_at_doubling(r)); }

/// Every labelled orbit of one bounce: the state at its impact, and multipliers with that trace and determinant.
void check_bounces(const MakefileRun& chain) {
  const auto points = chain.diagnostics("bounce");
  int seen = 0;
  for (const SolutionEntry& orbit : chain.solutions("bounce")) {
    const double gamma = orbit.parameter(1), r = orbit.parameter(2);
    const auto& x = orbit.states.back();
    INFO("Gamma = " << gamma);
    check_near(orbit.parameter(61), 2.0 * pi);
    check_near(x[1], -pi);
    check_near(x[3], impact_speed_of_table(r));
    check_near(x[0] * x[0], gamma * gamma - x[3] * x[3]);
    const double trace = 1.0 + r * r - (1.0 + r) * (1.0 + r) * x[0];
    const std::complex<double> half_gap = std::sqrt(std::complex<double>(trace * trace / 4.0 - r * r));
    for (const auto& mu : {trace / 2.0 + half_gap, trace / 2.0 - half_gap})
      CHECK(distance_to(with_label(points, orbit.label).multipliers, mu) < 1e-8);
    ++seen;
  }
  CHECK(seen == 5);
  check_near(chain.only("bounce", "LP").parameter(1), fold(0.5));
  check_near(chain.only("bounce", "PD").parameter(1), doubling(0.5));
  CHECK(first_iterations(chain.read("d.bounce")) <= 3);
}

/// Where the orbit with s < 0 touches the table in flight, its parabola and the table's sine are tangent.
void check_contact(const MakefileRun& chain) {
  const SolutionEntry orbit = chain.only("bounce", "GR");
  const double gamma = orbit.parameter(1), c = impact_speed_of_table(0.5), s = -std::sqrt(gamma * gamma - c * c);
  const auto distance = [&](double t) { return s + t * (pi - t / 2.0) - s * std::cos(t) - c * std::sin(t); };
  const auto velocity = [&](double t) { return pi - t + s * std::sin(t) - c * std::cos(t); };
  double t = orbit.internal[3] * 2.0 * pi;  // nearly; Newton on the velocity
  for (int i = 0; i < 20; ++i) t -= velocity(t) / (-1.0 + s * std::cos(t) + c * std::sin(t));
  check_near(velocity(t), 0.0);
  check_near(distance(t), 0.0);
}

template <class Closed>
void check_curve(const MakefileRun& chain, const std::string& name, Closed closed) {
  INFO(name);
  int seen = 0;
  for (const PointSection& section : chain.points(name))
    for (const PointRow& row : section.rows) {
      check_near(row.values[section.column("Gamma")], closed(row.values[section.column("r")]));
      ++seen;
    }
  CHECK(seen > 20);
}

}  // namespace

TEST_CASE("make -j2 in problems/ball: fold, period doubling and contact of one bounce a period in closed form") {
  const MakefileRun chain("ball", "branches");
  chain.check_repeatable(MakefileRun::Chain::is_long);
  chain.check_verified();
  check_bounces(chain);
  check_contact(chain);
  check_curve(chain, "fold_curve", fold);
  check_curve(chain, "period_doubling_curve", doubling);

  // The curve of folds ends on the grazing curve, where the orbit that touches has the multiplier 1.
  const SolutionEntry end = chain.only("fold_curve", "GR"), tangency = chain.only("grazing_curve", "GC");
  check_near(end.parameter(1), tangency.parameter(1));
  check_near(end.parameter(2), tangency.parameter(2));

  check_near(chain.points("doubled").front().rows.front().values.back(), 4.0 * pi);
  check_near(chain.points("fourfold").front().rows.front().values.back(), 8.0 * pi);
}
