// The discontinuity map against maps derived by hand, published coefficients, and forward integration by CVODES.
#include "maps/discontinuity_map.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "base/messages.hpp"
#include "maps/grazing_problems.hpp"
#include "motion/orbit_flow.hpp"

using namespace tchat;
using namespace tchat::test;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

double largest_difference(const MatrixXd& a, const MatrixXd& b) { return (a - b).cwiseAbs().maxCoeff(); }

GrazingPoint contact(const HybridSystem& system, const VectorXd& x, const ParameterVector& par, int jump = 1) {
  const VectorXd corrected = corrected_contact(system, 1, 1, x, par, "test");
  return grazing_point(system, 1, 1, jump, corrected, par, "test");
}

// The pushed mass touches its floor at q = v = 0. On P, v = 0: from (q, 0, s) with contact, in deviations,
//   q -> q + (1 - r^2) y^2,   s -> s - (1 + r) sqrt(2/a) omega y,
// and on constant s, with u = (1 + r) sqrt(2 a) y: q -> q + 2 (1 + r) y^2 + (1 + r) sqrt(2/a) v y, v -> v + u.
constexpr double a = 1.7, r = 0.6, omega = 2.3;
const double root = std::sqrt(2.0 / a);
const ParameterVector pushed = parameters({a, r, omega, 0.25});
const VectorXd pushed_contact = Vector3d(0.25, 0.0, 0.4);

GrazingPoint pushed_point() { return contact(system_of<PushedMass>(), pushed_contact, pushed); }

}  // namespace

TEST_CASE("A mass pushed off a floor: the map on P is the one derived by hand") {
  const DiscontinuityMap map(system_of<PushedMass>(), pushed_point());
  const DiscontinuityExpansion& x = map.expansion();
  CHECK(map.point().a == Approx(a).epsilon(1e-15));
  CHECK(largest_difference(x.y, Vector3d(0.0, 0.0, -(1 + r) * root * omega)) < 1e-14);
  CHECK(largest_difference(x.yy, Vector3d(1.0 - r * r, 0.0, 0.0)) < 1e-11);
  CHECK(largest_difference(x.yyy, Vector3d::Zero()) < 1e-10);
  MatrixXd along(3, 3);  // q and s on P; e_v is along f, up to (0, 0, -omega / a)
  along << 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -omega / a, 1.0;
  CHECK(largest_difference(x.dx, along) < 1e-14);
  CHECK(largest_difference(x.ydx, MatrixXd::Zero(3, 3)) < 1e-10);
  CHECK(largest_difference(x.dp, MatrixXd::Zero(3, 4)) < 1e-10);
  MatrixXd by_parameters = MatrixXd::Zero(3, 4);
  by_parameters.row(2) << (1 + r) * omega * root / (2.0 * a), -root * omega, -(1 + r) * root, 0.0;
  CHECK(largest_difference(x.ydp, by_parameters) < 1e-9);
  CHECK(x.error < 1e-9);
}

TEST_CASE("A mass pushed off a floor: the map on a section of constant clock") {
  const DiscontinuityMap map(system_of<PushedMass>(), pushed_point(), CrossSection{0, 3});
  const DiscontinuityExpansion& x = map.expansion();
  CHECK(largest_difference(x.y, Vector3d(0.0, (1 + r) * root * a, 0.0)) < 1e-13);
  CHECK(largest_difference(x.yy, Vector3d(2.0 * (1 + r), 0.0, 0.0)) < 1e-10);
  CHECK(largest_difference(x.yyy, Vector3d::Zero()) < 1e-9);
  CHECK(x.ydx(0, 1) == Approx((1 + r) * root).margin(1e-9));
  CHECK(std::abs(x.ydx(1, 1)) < 1e-9);
  CHECK(largest_difference(x.dx.leftCols(2), MatrixXd::Identity(3, 2)) < 1e-13);

  // Far from x* too: the closed form is exact.
  const double q = -0.03, v = 0.11;
  const double y2 = -q + v * v / (2.0 * a);
  const double u = (1 + r) * std::sqrt(2.0 * a * y2);
  const VectorXd start = pushed_contact + Vector3d(q, v, 0.0);
  CHECK(map.penetration(start, pushed) == Approx(y2).epsilon(1e-13));
  const Vector3d expected(q + 2.0 * (1 + r) * y2 + (1 + r) * root * v * std::sqrt(y2), v + u, 0.0);
  CHECK(largest_difference(map.exact(start, pushed), pushed_contact + expected) < 1e-14);
  // The expansion ends with these terms: to order 3/2 it is exact as well.
  CHECK(largest_difference(map.apply(start, pushed, MapOrder::three_halves), pushed_contact + expected) < 1e-10);
}

TEST_CASE("A short slip after the impact is part of the map") {
  // With V = sqrt(2 a) y: slip for c V with force b, then back to v = 0 with force a.
  const double c = 0.7, b = -0.4;
  const HybridSystem& system = system_of<SlippingSupport>();
  const ParameterVector par = parameters({a, r, omega, c, b});
  const VectorXd at = Eigen::Vector4d(0.0, 0.0, 0.3, 0.0);
  const DiscontinuityMap map(system, grazing_point(system, 1, 1, 1, at, par, "test", {{2, 2, 2}}));
  const double after = r + b * c;  // velocity after the slip, by V
  const double back = (-1.0 / a + c - after / a) * std::sqrt(2.0 * a);
  const double height = 1.0 + 2.0 * a * (r * c + 0.5 * b * c * c - 0.5 * after * after / a);
  CHECK(largest_difference(map.expansion().y, Eigen::Vector4d(0.0, 0.0, back * omega, 0.0)) < 1e-13);
  CHECK(largest_difference(map.expansion().yy, Eigen::Vector4d(height, 0.0, 0.0, 0.0)) < 1e-10);
  const double y2 = 0.01;
  const VectorXd x1 = map.exact(at - y2 * Eigen::Vector4d::Unit(0), par);
  const Eigen::Vector4d expected(y2 * (height - 1.0), 0.0, 0.3 + back * omega * std::sqrt(y2), 0.0);
  CHECK(largest_difference(x1, expected) < 1e-14);
  // A segment that lasts, or leaves its surface tangentially, is no slip.
  CHECK_THROWS_WITH(grazing_point(system, 1, 1, 1, at, par, "test", {{1, 2, 2}}), Catch::Contains("tangentially"));
  CHECK_THROWS_WITH(grazing_point(system, 1, 1, 1, at + 0.5 * Eigen::Vector4d::Unit(3), par, "test", {{2, 2, 2}}),
                    Catch::Contains("lasts"));
}

TEST_CASE("The event function of a section does what its hyperplane does") {
  const DiscontinuityMap by_event(system_of<PushedMass>(), pushed_point(), CrossSection{2, 0});
  const DiscontinuityMap by_state(system_of<PushedMass>(), pushed_point(), CrossSection{0, 3});
  CHECK(largest_difference(by_event.expansion().yy, by_state.expansion().yy) < 1e-12);
  const VectorXd start = pushed_contact + Vector3d(-0.02, 0.03, 0.0);
  CHECK(largest_difference(by_event.exact(start, pushed), by_state.exact(start, pushed)) < 1e-14);
}

TEST_CASE("Derivatives of the map are those of its values, to every order") {
  const HybridSystem& system = system_of<ForcedVanDerPol>();
  const ParameterVector par = parameters({2.4053817, 0.1, 0.75, 1.505, 0.8});
  const GrazingPoint point = contact(system, Vector3d(2.4053817, 0.0, 2.9236851), par);
  for (const auto& section : {std::optional<CrossSection>(), std::optional(CrossSection{0, 3})}) {
    const DiscontinuityMap map(system, point, section);
    const VectorXd start = point.x + (section ? Vector3d(0.01, 0.02, 0.0) : Vector3d(0.01, 0.0, 0.02));
    for (const MapOrder order : {MapOrder::half, MapOrder::one, MapOrder::three_halves, MapOrder::exact}) {
      CAPTURE(section.has_value(), static_cast<int>(order));
      const MatrixXd derivative = map.derivative(start, par, order);
      for (int k = 0; k < 3; ++k) {
        if (k == (section ? 2 : 1)) continue;  // along the section
        constexpr double step = 1e-4;          // truncation and rounding of a central difference: 1e-9
        const VectorXd up = map.apply(start + step * VectorXd::Unit(3, k), par, order);
        const VectorXd down = map.apply(start - step * VectorXd::Unit(3, k), par, order);
        CHECK(largest_difference(derivative.col(k), (up - down) / (2.0 * step)) < 2e-4 * (1.0 + derivative.norm()));
      }
    }
  }
}

TEST_CASE("The planar oscillator: (3.3), corrected") {
  const HybridSystem& system = system_of<PlanarOscillator>();
  const double mu = 1.0, d = 2.008619860875, restitution = 0.8;
  const ParameterVector par = parameters({mu, d, restitution});
  const DiscontinuityMap map(system, contact(system, Eigen::Vector2d(d, 0.0), par));
  const DiscontinuityExpansion& x = map.expansion();
  const double r2 = restitution * restitution;
  CHECK(map.point().a == Approx(d).epsilon(1e-15));
  CHECK_FALSE(map.point().has_square_root());
  CHECK(largest_difference(x.y, Eigen::Vector2d::Zero()) < 1e-14);
  // x1 - d = y^2 on P: together r^2 (x1 - d) + r^2 sqrt(2/d) (d^2 - mu) (2/3) (1 + r) (x1 - d)^(3/2)
  CHECK(largest_difference(x.yy, Eigen::Vector2d(r2 - 1.0, 0.0)) < 1e-10);
  CHECK(largest_difference(x.dx.col(0), Eigen::Vector2d(1.0, 0.0)) < 1e-14);
  const double third = r2 * std::sqrt(2.0 / d) * (d * d - mu) * (2.0 / 3.0) * (1.0 + restitution);
  CHECK(largest_difference(x.yyy, Eigen::Vector2d(third, 0.0)) < 1e-8);
  CHECK(largest_difference(x.ydx.col(0), Eigen::Vector2d::Zero()) < 1e-8);
}

TEST_CASE("The forced van der Pol oscillator: (3.18), (3.32), corrected") {
  const HybridSystem& system = system_of<ForcedVanDerPol>();
  const ParameterVector par = parameters({2.4053817, 0.1, 0.75, 1.505, 0.8});
  const GrazingPoint point = contact(system, Vector3d(2.4053817, 0.0, 2.9236851), par);
  CHECK(point.a == Approx(3.1376457).margin(1e-7));
  // The contact is known to 1e-7, which is what the coefficients are compared to.
  const DiscontinuityExpansion p = DiscontinuityMap(system, point).expansion();
  CHECK(p.y(2) == Approx(-2.162828354).margin(1e-7));
  CHECK(p.yy(2) == Approx(-0.2689291577).margin(1e-7));
  CHECK(p.yy(0) == Approx(-(1.0 - 0.64)).margin(1e-10));
  CHECK(largest_difference(p.dx.col(2), Vector3d::Unit(2)) < 1e-13);
  const DiscontinuityMap constant_phase(system, point, CrossSection{0, 3});
  const DiscontinuityExpansion& c = constant_phase.expansion();
  CHECK(c.y(1) == Approx(-4.509095686).margin(3e-7));
  CHECK(c.yy(1) == Approx(1.241933170).margin(1e-7));
  CHECK(c.yy(0) == Approx(-3.6).margin(1e-9));
  const Vector3d beside(0.0, 1e-3, 0.0);  // both sides of x*: without the third order
  const double depth = constant_phase.penetration_of_deviation(beside);
  CHECK(0.5 * (depth + constant_phase.penetration_of_deviation(-beside)) == Approx(0.159355151e-6).epsilon(1e-5));
}

TEST_CASE("The forced three-dimensional oscillator: (4.11), (4.15), (4.17)") {
  const HybridSystem& system = system_of<ForcedThreeDimensional>();
  const auto at = [&](double mu, double forcing, double omega_, double x2, double x3, double phase) {
    return contact(system, Eigen::Vector4d(mu, x2, x3, phase), parameters({mu, 0.28, 0.8, forcing, omega_}));
  };
  const GrazingPoint first = at(-0.7297075335, 1.1, 1.9, 0.3634312273, 0.7780505348, 3.0088915663);
  CHECK(first.a == Approx(1.549219048).margin(1e-8));
  CHECK(largest_difference(first.B, Eigen::Vector4d(0.0, 0.3457509803, 0.4738213112, -3.8858379900)) < 1e-8);
  const DiscontinuityMap constant_phase(system, first, CrossSection{0, 4});
  CHECK(constant_phase.expansion().y(1) == Approx(-3.1684285428).margin(1e-8));
}

TEST_CASE("The forced three-dimensional oscillator: the printed digits of (4.15) and (4.17)") {
  // States are printed with four digits, cut off, and so are the coefficients: among the states with these digits (x2
  // follows from h_P = 0) there is one whose coefficients have the printed ones, all of them.
  const HybridSystem& system = system_of<ForcedThreeDimensional>();
  const auto at = [&](double mu, double forcing, double omega_, double x3, double phase) {
    return contact(system, Eigen::Vector4d(mu, (0.28 - x3) * mu, x3, phase),
                   parameters({mu, 0.28, 0.8, forcing, omega_}));
  };
  const auto cut = [](double value) { return std::trunc(1e4 * value); };
  const GrazingPoint second = at(-0.49409, 1.25, 1.9, 0.47160, 3.21880);
  CHECK(cut(second.x(1)) == 946);
  CHECK(cut(second.B(1)) == 3519);
  CHECK(cut(second.B(2)) == 7123);
  CHECK(cut(second.B(3)) == -38947);
  const GrazingPoint third = at(-0.85481, 1.5, 4.0, 0.61891, 2.93171);
  CHECK(cut(third.x(1)) == 2897);
  const DiscontinuityMap constant_phase(system, third, CrossSection{0, 4});
  CHECK(cut(constant_phase.expansion().y(1)) == -37499);
  CHECK(std::abs(constant_phase.expansion().y(0)) + std::abs(constant_phase.expansion().y(2)) < 1e-12);
}

TEST_CASE("The exact map agrees with forward integration") {
  const HybridSystem& system = system_of<ForcedVanDerPol>();
  const ParameterVector par = parameters({2.4053817, 0.1, 0.75, 1.505, 0.8});
  const GrazingPoint point = contact(system, Vector3d(2.4053817, 0.0, 2.9236851), par);
  const DiscontinuityMap map(system, point);
  for (const double depth : {0.05, 1e-2, 1e-4}) {
    CAPTURE(depth);
    const VectorXd x0 = point.x + Vector3d(depth, 0.0, 0.3 * depth);
    const VectorXd before = integrate_for(system, 1, x0, par, -0.5).end_state;
    const SegmentFlow to_wall = integrate_segment(system, {1, 1, 1}, before, par);
    REQUIRE(to_wall.status == FlowStatus::event_reached);
    VectorXd out(3);
    system.value(FunctionKind::jump, 1, to_wall.end_state.data(), par.data(), out.data());
    const VectorXd x1 = map.exact(x0, par);
    CHECK(std::abs(x1(1)) < 1e-15);  // on P
    const VectorXd back = integrate_for(system, 1, x1, par, (out(2) - x1(2)) / par(3)).end_state;
    // CVODES' errors of 1e-14 in h are divided by the velocity at the wall, sqrt(2 a depth).
    CHECK(largest_difference(back, out) < 1e-13 / std::sqrt(depth));
  }
}

TEST_CASE("The map at other parameters is that of the grazing point there") {
  // The wall moved by 0.01: the contact of the mass moves with it, and so does the map.
  const DiscontinuityMap map(system_of<PushedMass>(), pushed_point());
  ParameterVector par = pushed;
  par(3) += 0.01;
  par(0) += 0.2;
  const VectorXd contact_there = pushed_contact + Vector3d(0.01, 0.0, 0.0);
  const double y2 = 0.004;
  const Vector3d expected(-r * r * y2, 0.0, 0.03 - (1 + r) * std::sqrt(2.0 / par(0) * y2) * omega);
  const VectorXd got = map.exact(contact_there + Vector3d(-y2, 0.0, 0.03), par);
  CHECK(largest_difference(got, contact_there + expected) < 1e-14);
  CHECK(map.exact(contact_there + Vector3d(1e-9, 0.0, 0.03), par) == contact_there + Vector3d(1e-9, 0.0, 0.03));
  // To order 3/2 the change of a by 0.2 leaves its square times y.
  const VectorXd expanded = map.apply(contact_there + Vector3d(-y2, 0.0, 0.03), par, MapOrder::three_halves);
  CHECK(largest_difference(expanded, got) < 0.2 * 0.2 * std::sqrt(y2));
}

TEST_CASE("Deviations keep their digits at the smallest penetrations") {
  const HybridSystem& system = system_of<ForcedVanDerPol>();
  const ParameterVector par = parameters({2.4053817, 0.1, 0.75, 1.505, 0.8});
  const DiscontinuityMap map(system, contact(system, Vector3d(2.4053817, 0.0, 2.9236851), par));
  const std::array<MapOrder, 3> orders{MapOrder::half, MapOrder::one, MapOrder::three_halves};
  std::array<double, 3> coarse{}, fine{};
  for (const double depth : {1e-4, 1e-8}) {
    const Vector3d d(depth, 0.0, 0.0);
    CHECK(map.penetration_of_deviation(d) == Approx(depth).epsilon(1e-14));
    const double y = std::sqrt(depth);
    for (std::size_t k = 0; k < 3; ++k)
      (depth == 1e-4 ? coarse : fine)[k] =
          (map.smooth_deviation(d, y) - map.expanded_deviation(d, y, orders[k])).norm();
  }
  for (std::size_t k = 0; k < 3; ++k) {
    CAPTURE(k, coarse[k], fine[k]);
    CHECK(std::log10(coarse[k] / fine[k]) / 2.0 == Approx(static_cast<double>(k + 2)).margin(0.05));
  }
}

TEST_CASE("What is no grazing point is said, with the cure") {
  const HybridSystem& system = system_of<PushedMass>();
  const auto message = [&](int jump, const VectorXd& x, const ParameterVector& par) {
    try {
      grazing_point(system, 1, 1, jump, x, par, "label 3 of q.mass");
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  using Catch::Contains;
  CHECK_THAT(message(2, pushed_contact, pushed),
             Contains("label 3 of q.mass") && Contains("identity") && Contains("--jump"));
  CHECK_THAT(message(3, pushed_contact, pushed), Contains("changes states in grazing contact"));
  CHECK_THAT(message(4, pushed_contact, pushed), Contains("no error"));
  CHECK_THAT(message(1, pushed_contact + Vector3d(1e-3, 0, 0), pushed),
             Contains("no grazing point") && Contains("--correct"));
  CHECK_THAT(message(1, pushed_contact, parameters({-a, r, omega, 0.25})), Contains("a* = -1.7 is negative"));
  CHECK_THAT(message(1, pushed_contact, parameters({0.0, r, omega, 0.25})), Contains("zero to rounding"));
  CHECK_THROWS_WITH(DiscontinuityMap(system, pushed_point(), CrossSection{1, 0}),
                    Contains("tangent") && Contains("surface in contact"));
}
