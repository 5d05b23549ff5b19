#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <memory>

#include "fvdp_torus.hpp"
#include "maps/composite_map.hpp"
#include "maps/torus_return.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// fvdp's torus at the grazing point, on P (event function 2) or on the section of constant phase (3).
struct FvdpCase {
  std::shared_ptr<const TorusReturn> torus;
  TorusGrazing grazing;
  GrazingPoint point;
  std::optional<CrossSection> section;

  std::shared_ptr<const DiscontinuityMap> contact() const {
    return std::make_shared<const DiscontinuityMap>(system_of<ForcedVanDerPol>(), point, section);
  }
  double phase() const { return torus->projection().phase(section ? torus->on_curve(grazing.phase) : point.x); }
  ParameterVector at(double dmu) const {
    ParameterVector par = grazing.par;
    par(0) -= dmu;
    return par;
  }
};

FvdpCase fvdp_case(int event) {
  const HybridSystem& system = system_of<ForcedVanDerPol>();
  const ParameterVector par = full_par({5.0, 0.1, 0.75, 1.505, 0.8, 2.923685098});
  CurveSettings settings;
  if (event == 2) settings.angles = {2};
  const FittedCurve fit = fit_invariant_curve(torus_points(par, event, 4000), settings, "points");
  const CurveProjection projection = event == 2 ? CurveProjection(fit.curve, 2) : CurveProjection(fit.curve);
  const auto suspended = std::make_shared<SuspendedSystem>(system, std::vector<int>{1}, 1, 1);
  TorusSettings coarse;  // the contact's part of the map is what is tested
  coarse.most_nodes = 128;
  coarse.accuracy = 1.0;
  FvdpCase result;
  result.torus = std::make_shared<TorusReturn>(suspended, fit.curve, projection, par,
                                               event == 2 ? suspended->least_distance() : event, coarse);
  result.grazing = torus_grazing(system, *result.torus, 1, 1, 1, "points");
  const VectorXd x = corrected_contact(system, 1, 1, result.grazing.x, result.grazing.par, "points");
  result.point = grazing_point(system, 1, 1, 1, x, result.grazing.par, "points");
  if (event != 2) result.section = CrossSection{event, 0};
  return result;
}

/// d phi' / d phi of a map by differences.
double difference(const IteratedMap& map, const TorusReturn& torus, const ParameterVector& par, double phi) {
  const double h = 1e-6;
  const auto image = [&](double at) { return torus.projection().phase(map.step(torus.on_curve(at), par).image); };
  const double d = image(phi + h) - image(phi - h);
  return (d - std::round(d)) / (2.0 * h);
}

}  // namespace

TEST_CASE("fvdp on P: the torus's grazing point, rho_1 and rho_2 of (3.28), (3.29), reduced maps", "[slow]") {
  const FvdpCase fvdp = fvdp_case(2);
  CHECK(fvdp.grazing.par(0) == Approx(2.4053817).margin(5e-8));
  CHECK(fvdp.point.x(2) == Approx(2.9236851).margin(5e-8));
  CHECK(fvdp.point.a == Approx(3.1376457).epsilon(1e-7));
  const EllipseMap ellipse(fvdp.torus, fvdp.contact(), fvdp.phase());
  // In terms of the phase x3: phi times x3' there.
  const double slope = fvdp.torus->curve().derivative(fvdp.phase())(2);
  const double dmu = 1e-4;
  const ContactEllipse of = ellipse.ellipse(fvdp.at(dmu));
  CHECK(std::abs(of.height * slope) == Approx(2.162828354 * std::sqrt(dmu)).epsilon(1e-6));
  CHECK(std::abs(of.width * slope) == Approx(std::sqrt(2.0 * dmu / 1.0084856)).epsilon(1e-5));

  // The full reduced map comes to the ellipse as mu -> mu*: what is left is of the order of dmu, beside sqrt(dmu).
  const auto full = [&](MapOrder order) {
    return ReducedMap(fvdp.torus, LocalContact(fvdp.torus, fvdp.contact(), order, 0.25));
  };
  const ReducedMap reduced = full(MapOrder::exact);
  const auto off = [&](double distance) {
    const double phi = fvdp.phase() + 0.3 * ellipse.ellipse(fvdp.at(distance)).width;
    const VectorXd x = fvdp.torus->on_curve(phi);
    const double a = fvdp.torus->projection().phase(reduced.step(x, fvdp.at(distance)).image);
    const double b = fvdp.torus->projection().phase(ellipse.step(x, fvdp.at(distance)).image);
    return std::abs(a - b - std::round(a - b));
  };
  CHECK(off(1e-4) / off(1e-6) == Approx(100.0).epsilon(0.2));
  for (const double share : {-0.7, 0.1, 0.6}) {
    const ParameterVector par = fvdp.at(dmu);
    const double phi = fvdp.phase() + share * of.width;
    const VectorXd x = fvdp.torus->on_curve(phi);
    CHECK(reduced.step(x, par).contact);
    CHECK(reduced.tangent(x, par)(0, 0) == Approx(difference(reduced, *fvdp.torus, par, phi)).epsilon(1e-4));
    CHECK(ellipse.tangent(x, par)(0, 0) == Approx(difference(ellipse, *fvdp.torus, par, phi)).epsilon(1e-4));
  }
  // Before contact all of them are the rotation: a torus, exponent zero.
  const MapAttractor before = iterate_to_attractor(reduced, fvdp.point.x, fvdp.at(-1e-4), MapIteration{});
  CHECK(before.kind == AttractorKind::quasi_periodic);
  CHECK(before.spectrum->exponents(0) == 0.0);

  // The full map: contact moves the phase by (3.18), the rest of the state by (1 - r^2) of the penetration.
  const CompositeMap map(LocalContact(fvdp.torus, fvdp.contact(), MapOrder::one, 0.25));
  const ParameterVector par = fvdp.at(dmu);
  const VectorXd x = fvdp.point.x;
  const LocalContact::Result after = LocalContact(fvdp.torus, fvdp.contact(), MapOrder::one, 0.25).apply(x, par);
  CHECK(after.penetration == Approx(dmu).epsilon(1e-9));
  CHECK(after.x(2) - x(2) == Approx(-2.162828354 * 1e-2 - 0.2689291577 * dmu).epsilon(1e-7));
  CHECK(after.x(0) - x(0) == Approx(-0.36 * dmu).epsilon(1e-6));
  const MatrixXd tangent = map.tangent(x, par);
  for (const Eigen::Index k : {0, 2}) {  // along P: x2 = 0
    const double h = 1e-7;
    const VectorXd d = fvdp.torus->difference(map.step(x + h * VectorXd::Unit(3, k), par).image,
                                              map.step(x - h * VectorXd::Unit(3, k), par).image) /
                       (2.0 * h);
    CHECK((tangent.col(k) - d).norm() < 1e-4 * (1.0 + d.norm()));
  }
}

TEST_CASE("fvdp on the section of constant phase: rho_1 and rho_2 of (3.40), (3.41)", "[slow]") {
  const FvdpCase fvdp = fvdp_case(3);
  CHECK(fvdp.grazing.par(0) == Approx(2.4053817).margin(5e-8));
  CHECK(std::abs(fvdp.grazing.time) < 1e-6);
  const EllipseMap ellipse(fvdp.torus, fvdp.contact(), fvdp.phase());
  const VectorXd first = fvdp.torus->curve().derivative(fvdp.phase());
  const VectorXd second = fvdp.torus->curve().derivative(fvdp.phase(), 2);
  // x1 = gamma(x2) on the curve: gamma'' = (u1'' - gamma' u2'') / u2'^2, gamma' = 0 at the contact; h_D'(x) = mu - x1 -
  // alpha / 2 x2^2, alpha = 2 * 0.159355151 (3.32).
  CHECK(first(0) / first(1) == Approx(0.0).margin(1e-5));
  const double curvature = (second(0) - first(0) / first(1) * second(1)) / (first(1) * first(1));
  const double dmu = 1e-4;
  const ContactEllipse of = ellipse.ellipse(fvdp.at(dmu));
  CHECK(std::abs(of.height * first(1)) == Approx(4.509095686 * std::sqrt(dmu)).epsilon(1e-4));
  CHECK(std::abs(of.width * first(1)) ==
        Approx(std::sqrt(2.0 * dmu / std::abs(curvature + 2.0 * 0.159355151))).epsilon(1e-4));
}
