#include <Eigen/Dense>
#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>

#include "grazing_problems.hpp"
#include "maps/composite_map.hpp"
#include "maps/smooth_return.hpp"
#include "motion/hybrid_simulation.hpp"
#include "motion/orbit_flow.hpp"
#include "support/random_matrices.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A grazing orbit with its maps.
struct GrazingCase {
  const HybridSystem* system;
  ParameterVector par;
  VectorXd x;
  Signature segments;
  std::vector<double> durations;
  VectorXd extent;

  GrazingPoint point() const { return grazing_point(*system, 1, 1, 1, x, par, "test"); }
  std::shared_ptr<const PeriodicReturn> smooth(int order) const {
    const auto suspended = std::make_shared<SuspendedSystem>(*system, std::vector<int>{1}, 1, 1);
    return std::make_shared<PeriodicReturn>(suspended, GrazingTurn{x, par, segments, durations, extent},
                                            suspended->least_distance(), order);
  }
  CompositeMap map(MapOrder order, int smooth_order) const {
    return CompositeMap(
        LocalContact(smooth(smooth_order), std::make_shared<DiscontinuityMap>(*system, point()), order));
  }
  ParameterVector at(double parameter) const {
    ParameterVector moved = par;
    moved(0) = parameter;
    return moved;
  }
};

GrazingCase planar() {
  const double d = 2.008619860875;
  return {&system_of<PlanarOscillator>(), full_par({1.0, d, 0.8}), Eigen::Vector2d(d, 0.0),
          {{1, 1, no_function}},          {6.663286859323},        Eigen::Vector2d(4.0, 5.3)};
}

GrazingCase rand3d_028() {
  const double mu = -0.798146332928;
  return {&system_of<ThreeDimensionalOscillator>(),
          full_par({mu, 0.28, 0.8}),
          corrected_contact(system_of<ThreeDimensionalOscillator>(), 1, 1,
                            Eigen::Vector3d(mu, 0.274740619469, 0.624223368742), full_par({mu, 0.28, 0.8}), "test"),
          {{1, 1, no_function}},
          {6.725184221523},
          Eigen::Vector3d(1.6, 1.3, 1.0)};
}

GrazingCase rand3d_039() {
  const double mu = -0.827105485379;
  return {&system_of<ThreeDimensionalOscillator>(),
          full_par({mu, 0.39, 0.8}),
          corrected_contact(system_of<ThreeDimensionalOscillator>(), 1, 1,
                            Eigen::Vector3d(mu, -0.0722726568477, 0.302619782935), full_par({mu, 0.39, 0.8}), "test"),
          {{1, 1, no_function}},
          {8.063881592814},
          Eigen::Vector3d(1.6, 1.3, 1.0)};
}

/// The true orbit with one impact a period by shooting, and where it would meet P if the wall were not there: what its
/// incoming trajectory does, the impact accounted for afterwards.
struct TrueOrbit {
  PeriodicOrbit orbit;
  VectorXd section;
  double velocity = 0.0;
};

/// Along the flow, forward or backward, to the nearest zero of an event function, by Newton's method on the time.
VectorXd flow_to(const HybridSystem& system, int event, const VectorXd& start, const VectorXd& par, double time) {
  VectorXd x = integrate_for(system, 1, start, par, time).end_state;
  for (int k = 0; k < 8; ++k) {
    VectorXd f(x.size()), hx(x.size());
    double h = 0.0;
    system.first(FunctionKind::event, event, x.data(), par.data(), {}, &h, hx.data(), nullptr);
    system.value(FunctionKind::field, 1, x.data(), par.data(), f.data());
    time -= h / hx.dot(f);
    x = integrate_for(system, 1, start, par, time).end_state;
  }
  return x;
}

/// `section`: near the orbit's point on P, behind the wall.
TrueOrbit true_orbit(const GrazingCase& grazing, const VectorXd& section, double parameter) {
  const HybridSystem& system = *grazing.system;
  const ParameterVector par = grazing.at(parameter);
  const double depth = -system.event(1, section.data(), par.data());
  REQUIRE(depth > 0.0);
  const VectorXd before = flow_to(system, 1, section, par, -std::sqrt(2.0 * depth / grazing.point().a));
  VectorXd after(before.size());
  system.value(FunctionKind::jump, 1, before.data(), par.data(), after.data());
  ShootingOptions options;
  options.tolerance = 1e-13;
  TrueOrbit found{shoot(system, {{1, 1, 1}}, after, par, options), {}, 0.0};
  INFO(found.orbit.message);
  REQUIRE(found.orbit.converged);
  found.velocity = found.orbit.map.segments.front().event_velocity;
  const SuspendedSystem with_p(system, {}, 1, 1);
  found.section = flow_to(with_p.system(), with_p.least_distance(), found.orbit.map.segments.front().end, par, 0.0);
  return found;
}

/// Fixed point in contact of the map by Newton's method, its steps halved where they would leave contact.
VectorXd fixed_point(const CompositeMap& map, VectorXd x, const ParameterVector& par) {
  for (int k = 0; k < 40; ++k) {
    const Iterate iterate = map.step(x, par);
    const MatrixXd matrix = MatrixXd::Identity(x.size(), x.size()) - map.tangent(x, par);
    VectorXd step = solution(matrix, iterate.image - x);
    while (step.norm() > 1e-16 && !map.step(x + step, par).contact) step *= 0.5;
    x += step;
    if (step.norm() < 1e-15) break;
  }
  REQUIRE((map.step(x, par).image - x).norm() < 1e-12);
  REQUIRE(map.step(x, par).contact);
  return x;
}

double largest_multiplier(const MatrixXd& matrix) { return lapack_eigenvalues(matrix).cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("planar: the smooth map's derivative, both fixed points (3.7), (3.9) and the derivative on contact") {
  const GrazingCase grazing = planar();
  const auto smooth = grazing.smooth(1);
  const double p1 = smooth->map().first(0, 0), p_mu = smooth->map().first(0, 2);
  CHECK(p1 == Approx(8.596950636e-4).epsilon(1e-7));
  CHECK((1.0 - 0.64 * p1) * (1.0 - p1) == Approx(0.9985905731).epsilon(1e-9));  // (3.13)
  {
    const auto image = [&](double mu) {
      const auto p = SuspendedSystem(system_of<PlanarOscillator>(), {}, 1, 1).least_distance();
      const SuspendedSystem with_p(system_of<PlanarOscillator>(), {}, 1, 1);
      return integrate_segment(with_p.system(), {1, p, 1}, grazing.x, grazing.at(mu)).end_state(0);
    };
    CHECK(p_mu == Approx((image(1.0 + 1e-4) - image(1.0 - 1e-4)) / 2e-4).epsilon(1e-6));
  }
  const CompositeMap map = grazing.map(MapOrder::three_halves, 1);
  // Without contact (3.9) is exact for the linear map.
  const ParameterVector below = grazing.at(0.99);
  VectorXd x = grazing.x;
  for (int k = 0; k < 30; ++k) x = map.step(x, below).image;
  CHECK(x(0) - grazing.x(0) == Approx(p_mu * -0.01 / (1.0 - p1)).epsilon(1e-9));
  // With contact to lowest order (3.7); the term of order 3/2 takes part in the next one.
  const ParameterVector above = grazing.at(1.0 + 1e-6);
  x = grazing.x + Eigen::Vector2d(1e-9, 0.0);
  for (int k = 0; k < 30; ++k) x = map.step(x, above).image;
  CHECK(x(0) - grazing.x(0) == Approx(p_mu * 1e-6 / (1.0 - 0.64 * p1)).epsilon(1e-5));
  // (3.14) as corrected: P1 r^2 (1 + sqrt(2 / d) (d^2 - mu) (1 + r) (x - d)^(1/2)).
  const double d = grazing.x(0);
  const VectorXd off = grazing.x + Eigen::Vector2d(1e-4, 0.0);
  CHECK(map.tangent(off, grazing.par)(0, 0) ==
        Approx(p1 * 0.64 * (1.0 + std::sqrt(2.0 / d) * (d * d - 1.0) * 1.8 * 1e-2)).epsilon(1e-6));
}

TEST_CASE("planar: the impacting orbit of the composite map against the true one, with the right order of error",
          "[slow]") {
  const GrazingCase grazing = planar();
  const double known_velocity = 0.06602396113935;
  const double mu = 1.001;
  const CompositeMap best = grazing.map(MapOrder::exact, 2);
  const TrueOrbit known =
      true_orbit(grazing, fixed_point(best, grazing.x + Eigen::Vector2d(1e-5, 0.0), grazing.at(mu)), mu);
  CHECK(std::abs(known.velocity) == Approx(known_velocity).epsilon(1e-9));
  CHECK(std::abs(known.orbit.map.multipliers(0)) == Approx(6.530430956e-4).epsilon(1e-6));
  const VectorXd x = fixed_point(best, known.section, grazing.at(mu));
  CHECK(largest_multiplier(best.tangent(x, grazing.at(mu))) == Approx(6.530430956e-4).epsilon(2e-3));

  const auto error = [&](MapOrder order, int smooth_order, double dmu) {
    const VectorXd guess = fixed_point(best, grazing.x + Eigen::Vector2d(1e-5, 0.0), grazing.at(1.0 + dmu));
    const TrueOrbit orbit = true_orbit(grazing, guess, 1.0 + dmu);
    const CompositeMap map = grazing.map(order, smooth_order);
    return (fixed_point(map, orbit.section, grazing.at(1.0 + dmu)) - orbit.section).norm();
  };
  // First order in mu leaves mu^2, second order mu^3: a hundredth and a thousandth at a tenth of the distance.
  CHECK(error(MapOrder::exact, 1, 1e-2) / error(MapOrder::exact, 1, 1e-3) == Approx(100.0).epsilon(0.2));
  CHECK(error(MapOrder::exact, 2, 1e-2) / error(MapOrder::exact, 2, 1e-3) == Approx(1000.0).epsilon(0.3));
  CHECK(error(MapOrder::exact, 2, 1e-3) < 0.1 * error(MapOrder::exact, 1, 1e-3));
}

TEST_CASE("rand3d, m = 0.28: the unstable impacting orbit at grazing, orders of the error, and its multiplier") {
  const GrazingCase grazing = rand3d_028();
  const double mu_star = grazing.par(0);
  const CompositeMap best = grazing.map(MapOrder::exact, 2);
  // To lowest order x = A (x + B y) in deviations from x*.
  const MatrixXd a = grazing.smooth(1)->map().first.topLeftCorner(3, 3);
  const VectorXd direction = solution(MatrixXd::Identity(3, 3) - a, a * grazing.point().B);
  const double leading = (grazing.point().event_gradient.transpose() * direction)(0);  // of h_D, by y
  // From grazing, where y = -(mu* - mu) / leading, in steps.
  const auto orbit_at = [&](double mu) {
    VectorXd x = grazing.x + direction * ((mu_star - mu) / 20.0 / -leading);
    for (int k = 1; k <= 20; ++k) {
      x = fixed_point(best, x, grazing.at(mu_star + (mu - mu_star) * k / 20.0));
      if (k < 20) x += (x - grazing.x) / k;
    }
    return true_orbit(grazing, x, mu);
  };
  const TrueOrbit known = orbit_at(-0.799);
  REQUIRE(known.velocity == Approx(-0.0116208376).epsilon(1e-7));
  const VectorXd x = fixed_point(best, known.section, grazing.at(-0.799));
  CHECK((x - known.section).norm() < 2e-5);
  CHECK(lapack_eigenvalues(best.tangent(x, grazing.at(-0.799))).real().maxCoeff() ==
        Approx(2.4782211189).epsilon(1e-2));

  // y = sqrt(-h_D), x - x* and mu - mu* are all of one size on this branch: what an order leaves out is of second order
  // (P_smooth of first order) or third (P_smooth of second order; of order 3/2 y^2 (x - x*)).
  const auto error = [&](MapOrder order, int smooth_order, double dmu) {
    const TrueOrbit orbit = orbit_at(mu_star + dmu);
    return (fixed_point(grazing.map(order, smooth_order), orbit.section, grazing.at(mu_star + dmu)) - orbit.section)
        .norm();
  };
  const auto ratio = [&](MapOrder order, int smooth_order) {
    return error(order, smooth_order, -1e-4) / error(order, smooth_order, -5e-5);
  };
  CHECK(ratio(MapOrder::exact, 1) == Approx(4.0).epsilon(0.15));
  CHECK(ratio(MapOrder::three_halves, 2) == Approx(8.0).epsilon(0.2));
  CHECK(ratio(MapOrder::exact, 2) == Approx(8.0).epsilon(0.2));
  CHECK(error(MapOrder::exact, 2, -1e-4) < 0.1 * error(MapOrder::exact, 1, -1e-4));
}

TEST_CASE("rand3d, m = 0.28: the fold of the composite map comes nearer to the true one with each order", "[slow]") {
  // SN at mu = -0.7999350433: coexistence of both attractors ends there.
  const double true_fold = -0.7999350433;
  const GrazingCase grazing = rand3d_028();
  const auto fold = [&](MapOrder order, int smooth_order) {
    const CompositeMap map = grazing.map(order, smooth_order);
    // Down from where only the impacting attractor is left: the last value at which it exists, by bisection.
    double alive = -0.7975, dead = -0.81;
    VectorXd on = grazing.x;
    for (int k = 0; k < 1500; ++k) on = map.step(on, grazing.at(alive)).image;
    while (alive - dead > 1e-6) {
      const double middle = 0.5 * (alive + dead);
      VectorXd x = on;
      bool impacts = true;
      for (int k = 0; k < 1500 && impacts; ++k) {
        const Iterate iterate = map.step(x, grazing.at(middle));
        impacts = iterate.contact;
        x = iterate.image;
      }
      if (impacts) on = x;
      (impacts ? alive : dead) = middle;
    }
    return std::abs(alive - true_fold);
  };
  const double first = fold(MapOrder::one, 1), linear = fold(MapOrder::exact, 1), second = fold(MapOrder::exact, 2);
  INFO("order 1: " << first << ", exact: " << linear << ", second order: " << second);
  CHECK(first < 2e-3);
  CHECK(linear < first);
  CHECK(second < 0.25 * linear);
  CHECK(second < 1e-4);
}

TEST_CASE("rand3d, m = 0.39: period adding of the composite map beside direct simulation") {
  const GrazingCase grazing = rand3d_039();
  const CompositeMap map = grazing.map(MapOrder::exact, 2);
  MapIteration settings;
  for (const auto& [dmu, period] : {std::pair{5e-7, 4}, {1.0e-4, 2}, {1.0e-3, 2}, {2.0e-3, 1}}) {
    const ParameterVector par = grazing.at(grazing.par(0) + dmu);
    const MapAttractor attractor = iterate_to_attractor(map, grazing.x, par, settings);
    REQUIRE(attractor.kind == AttractorKind::periodic);
    CHECK(attractor.period == period);
    CHECK(std::count(attractor.contacts.begin(), attractor.contacts.end(), true) == 1);
    // By the flow: impacts where they come, and minima of x1 between them.
    const VectorXd start = integrate_for(*grazing.system, 1, grazing.x, grazing.par, 4.0).end_state;
    HybridSimulation simulation(ModeRule(*grazing.system), start, par, SimulationSettings{});
    std::vector<int> events;
    for (int k = 0; k < 400; ++k) events.push_back(simulation.next(1e9).index.event);
    const std::vector<int> tail(events.end() - 120, events.end());
    CHECK(std::count(tail.begin(), tail.end(), 1) == 120 / period);
    for (std::size_t k = 0; k + static_cast<std::size_t>(period) < tail.size(); ++k)
      REQUIRE(tail[k] == tail[k + static_cast<std::size_t>(period)]);
  }
}

TEST_CASE("the composite map's tangent against differences, to every order") {
  const GrazingCase grazing = rand3d_028();
  const ParameterVector par = grazing.at(grazing.par(0) + 3e-4);
  // On P near x*, in contact: along directions in P.
  const GrazingPoint point = grazing.point();
  const VectorXd normal = point.section_gradient.normalized();
  for (const MapOrder order : {MapOrder::half, MapOrder::one, MapOrder::three_halves, MapOrder::exact})
    for (const int smooth_order : {1, 2}) {
      const CompositeMap map = grazing.map(order, smooth_order);
      REQUIRE(map.step(point.x, par).contact);
      const MatrixXd tangent = map.tangent(point.x, par);
      for (Eigen::Index k = 0; k < 3; ++k) {
        VectorXd direction = VectorXd::Unit(3, k);
        direction -= normal * normal.dot(direction);
        const double h = 1e-6;
        const VectorXd difference =
            (map.step(point.x + h * direction, par).image - map.step(point.x - h * direction, par).image) / (2.0 * h);
        CHECK((tangent * direction - difference).norm() < 1e-5 * (1.0 + difference.norm()));
      }
    }
}

TEST_CASE("iterates that leave the neighbourhood of the grazing orbit are told as escape") {
  const GrazingCase grazing = rand3d_028();
  const CompositeMap map = grazing.map(MapOrder::half, 1);
  const MapAttractor attractor = iterate_to_attractor(map, grazing.x, grazing.at(grazing.par(0) + 5.0), MapIteration{});
  CHECK(attractor.kind == AttractorKind::escape);
  CHECK(attractor.message.find("too far from grazing") != std::string::npos);
}
