// The minimal conditions of fold, period-doubling and torus curves: zero where the closed forms have the bifurcation,
// gradients against differences of the values.
#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <random>

#include "impacting_orbits.hpp"
#include "langford.hpp"
#include "orbit/curve_conditions.hpp"
#include "orbit/monitor.hpp"
#include "orbit/monitor_gradient.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "stability/floquet_multipliers.hpp"
#include "stability/normal_form.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

/// A condition with what it needs: evaluated at any orbit of the shape, an orbit of the model or not.
class ConditionAt {
 public:
  ConditionAt(const HybridSystem& hybrid, const Signature& signature, const Orbit& like,
              const std::vector<int>& free = {1, 2})
      : system(hybrid, signature, free),
        condensed(system, like.shape, {static_cast<int>(free.size())}),
        residual_(condensed.make_residual()) {
    for (std::size_t r = 0; r < free.size(); ++r) border_.push_back(random_vector(condensed.make_vector()));
  }
  double value(OrbitCondition& condition, const Orbit& x, int number = 0) {
    REQUIRE(condensed.linearize(x, border_, residual_) == Linearization::ready);
    REQUIRE(condition.evaluate(condensed, x));
    return condition.value(number);
  }
  bool evaluates(OrbitCondition& condition, const Orbit& x) {
    REQUIRE(condensed.linearize(x, border_, residual_) == Linearization::ready);
    return condition.evaluate(condensed, x);
  }
  OrbitVector random_vector(OrbitVector v) {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (auto* part : {&v.durations, &v.globals})
      for (double& entry : *part) entry = uniform(random_);
    for (double& entry : v.states.reshaped()) entry = uniform(random_);
    return v;
  }

  PeriodicOrbitSystem system;
  CondensedSystem condensed;

 private:
  std::mt19937 random_{7};
  std::vector<OrbitVector> border_;
  OrbitResidual residual_;
};

/// d G in the direction v by extrapolated central differences. The condition's border follows the null vectors at every
/// evaluation: it is brought back to that of `memory` before each.
double difference(ConditionAt& at, OrbitCondition& condition, int number, const std::vector<double>& memory,
                  const Orbit& x, const OrbitVector& v, double step) {
  const auto moved = [&](double length) {
    condition.recall(memory);
    Orbit y = x;
    advance(y, length, v, at.system.free_parameters());
    return at.value(condition, y, number);
  };
  const auto central = [&](double h) { return (moved(h) - moved(-h)) / (2 * h); };
  return (4 * central(step / 2) - central(step)) / 3;
}

/// Of the differences, and how much of the largest derivative a gradient may be off by.
struct Accuracy {
  double step = 2e-4;
  double share = 1e-9;
};

/// The gradient against differences in random directions and along single unknowns of every kind.
void check_gradient_of(ConditionAt& at, OrbitCondition& condition, int number, const Orbit& x,
                       const Accuracy& accuracy) {
  at.value(condition, x);
  std::vector<double> memory;
  condition.remember(memory);
  condition.recall(memory);
  at.value(condition, x);
  const OrbitVector gradient = condition.gradient(number);
  std::vector<OrbitVector> directions;
  for (int i = 0; i < 3; ++i) directions.push_back(at.random_vector(at.condensed.make_vector()));
  const OrbitVector zero = at.condensed.make_vector();
  for (Eigen::Index s = 0; s < zero.durations.size(); ++s)
    directions.push_back(zero), directions.back().durations(s) = 1.0;
  for (Eigen::Index g = 0; g < zero.globals.size(); ++g) directions.push_back(zero), directions.back().globals(g) = 1.0;
  const Eigen::Index columns = zero.states.cols();
  for (const Eigen::Index column : {Eigen::Index{0}, Eigen::Index{1}, columns / 2, columns - 1}) {
    directions.push_back(zero);
    directions.back().states.col(column).setLinSpaced(1.0, -0.4);
  }
  double largest = 0.0;
  for (const OrbitVector& v : directions) largest = std::max(largest, std::abs(dot(gradient, v)));
  REQUIRE(largest > 0.0);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double exact = dot(gradient, directions[i]);
    const double found = difference(at, condition, number, memory, x, directions[i], accuracy.step);
    CAPTURE(i, exact, found);
    CHECK(std::abs(found - exact) < 1e-6 * std::abs(exact) + accuracy.share * largest);
  }
}

void check_gradient(ConditionAt& at, OrbitCondition& condition, const Orbit& x, const Accuracy& accuracy = {}) {
  for (int number = 0; number < condition.count(); ++number) check_gradient_of(at, condition, number, x, accuracy);
}

Orbit sampled(const CutOrbit& cut, const OscillatorOrbit& orbit, int intervals, int collocation) {
  return sampled_orbit(cut.pieces, 4, intervals, collocation, orbit.par());
}

std::vector<CutOrbit> all_cuts(const OscillatorOrbit& orbit) {
  return {whole(orbit), cut_at_minimum(orbit, false), cut_at_minimum(orbit, true)};
}

}  // namespace

TEST_CASE("bifurcations of the one-impact orbit: closed form and published values agree") {
  CHECK(one_impact_orbit(2.0072, period_doubling_velocity()).alpha == Approx(doubling_alpha).epsilon(1e-13));
  CHECK(period_doubling_velocity() == Approx(0.033243892548135).epsilon(1e-10));
  CHECK(one_impact_orbit(1.8901, fold_velocity()).alpha == Approx(fold_alpha).epsilon(1e-13));
  CHECK(fold_velocity() == Approx(5.1987423726031).epsilon(1e-9));
}

TEST_CASE("critical multiplier: zero at the closed-form bifurcation, in every cut") {
  struct Kind {
    int multiplier;
    double omega, v;
  };
  const Kind kind = GENERATE(Kind{-1, 2.0072, period_doubling_velocity()}, Kind{1, 1.8901, fold_velocity()});
  for (std::size_t cut = 0; cut < 3; ++cut) {
    CAPTURE(kind.multiplier, cut);
    std::vector<double> values;
    for (const double factor : {0.99, 1.0, 1.01}) {
      const OscillatorOrbit orbit = one_impact_orbit(kind.omega, factor * kind.v);
      const CutOrbit pieces = all_cuts(orbit)[cut];
      const Orbit x = sampled(pieces, orbit, 60, 5);
      ConditionAt at(linosc(), pieces.signature, x);
      CriticalMultiplier condition(at.system, x.shape, kind.multiplier);
      values.push_back(at.value(condition, x));
    }
    CHECK(values[0] * values[2] < 0.0);
    CHECK(std::abs(values[1]) < 1e-8 * std::min(std::abs(values[0]), std::abs(values[2])) * 100);
  }
}

TEST_CASE("critical multiplier: finite and smooth through grazing") {
  std::vector<double> values;
  for (const double v : {-2e-6, -1e-6, 0.0, 1e-6, 2e-6}) {
    const OscillatorOrbit orbit = one_impact_orbit(2.0072, v);
    const Orbit x = sampled(whole(orbit), orbit, 40, 4);
    ConditionAt at(linosc(), {{1, 1, 1}}, x);
    CriticalMultiplier condition(at.system, x.shape, -1);
    values.push_back(at.value(condition, x));
    REQUIRE(std::isfinite(values.back()));
  }
  const double slope = (values[4] - values[0]) / 4;
  for (int i = 0; i < 5; ++i)
    CHECK(values[static_cast<std::size_t>(i)] - values[2] == Approx((i - 2) * slope).margin(1e-3 * std::abs(slope)));
}

TEST_CASE("critical multiplier: gradient") {
  struct Kind {
    int multiplier;
    double omega, v;
  };
  // At a bifurcation, near one and far from any.
  const Kind kind = GENERATE(Kind{-1, 2.0072, period_doubling_velocity()}, Kind{1, 1.8901, fold_velocity()},
                             Kind{-1, 2.0072, 0.05}, Kind{1, 1.8901, 3.0});
  const OscillatorOrbit orbit = one_impact_orbit(kind.omega, kind.v);
  for (const CutOrbit& cut : all_cuts(orbit)) {
    CAPTURE(kind.multiplier, kind.v, cut.signature.size());
    const Orbit x = sampled(cut, orbit, 7, 4);
    ConditionAt at(linosc(), cut.signature, x);
    CriticalMultiplier condition(at.system, x.shape, kind.multiplier);
    check_gradient(at, condition, x);
  }
}

TEST_CASE("critical multiplier: null vector solves the linearised problem") {
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, period_doubling_velocity());
  const Orbit x = sampled(whole(orbit), orbit, 60, 5);
  ConditionAt at(linosc(), {{1, 1, 1}}, x);
  CriticalMultiplier condition(at.system, x.shape, -1);
  at.value(condition, x);
  const OrbitVector& v = condition.null_vector();
  // h_x v = 0 at the end and v(0) = -g_x v(1), with g_x = diag(1, -r, 1, 1).
  const Eigen::Vector4d start = v.states.col(0);
  const Eigen::Vector4d end = v.states.rightCols(1);
  CHECK(start.norm() > 0.1);
  CHECK(std::abs(end(0)) < 1e-9);
  CHECK((start + Eigen::Vector4d(end(0), -0.8 * end(1), end(2), end(3))).norm() < 1e-8);
}

TEST_CASE("critical pair: zero at the closed-form torus bifurcation, with its angle") {
  const LangfordCircle circle = LangfordCircle{}.at_torus();
  CHECK(circle.trace() == Approx(0.0).margin(1e-14));
  // a = b^2 + e r^2 with r^2 = (c + a b - b^3 / 3) / (1 + e b), as the problem's header says.
  CHECK(circle.a == Approx(circle.b * circle.b + circle.e * circle.radius_squared()));
  for (const double change : {-0.02, 0.0, 0.02}) {
    LangfordCircle moved = circle;
    moved.a += change;
    const Orbit x = moved.orbit(40, 5);
    ConditionAt at(system_of<Langford>(), {{1, 1, 1}}, x);
    CriticalPair condition(at.system, x.shape, circle.multiplier() * std::polar(1.02, 0.03));
    CAPTURE(change);
    CHECK(at.value(condition, x) == Approx(std::norm(moved.multiplier()) - 1).margin(1e-10));
    CHECK(std::abs(condition.multiplier() - moved.multiplier()) < 1e-10);
  }
}

TEST_CASE("critical pair: complex or just become real, its product is the contraction of areas") {
  // Position and velocity lose area by e^{-2 zeta T} in flight and restitution^2 at the impact.
  const auto product = [](const OscillatorOrbit& orbit) {
    return std::pow(orbit.constants.r, 2) * std::exp(-2.0 * orbit.constants.zeta * orbit.constants.period());
  };
  const OscillatorOrbit first = one_impact_orbit(2.0072, 0.5);
  Orbit x = sampled(whole(first), first, 40, 5);
  ConditionAt at(linosc(), {{1, 1, 1}}, x);
  CriticalPair pair(at.system, x.shape, {0.5896957647, 0.34676174832});
  CHECK(at.value(pair, x) == Approx(product(first) - 1.0).margin(1e-9));
  std::vector<double> memory;
  pair.remember(memory);
  constexpr double least = 0.02;
  double v = 0.5;
  bool real = false;
  for (; v > least; v *= 0.97) {
    const OscillatorOrbit orbit = one_impact_orbit(2.0072, v);
    x = sampled(whole(orbit), orbit, 40, 5);
    if (!at.evaluates(pair, x)) break;
    CAPTURE(v);
    CHECK(pair.value() == Approx(product(orbit) - 1.0).margin(1e-9));
    real = real || pair.multiplier().imag() == 0.0;
  }
  CHECK(real);
  // Far beyond the meeting the two are no pair any more.
  CHECK(v > least);
  pair.recall(memory);
  CHECK(at.value(pair, sampled(whole(first), first, 40, 5)) == Approx(product(first) - 1.0).margin(1e-9));
}

TEST_CASE("cubic terms from the vectors of a condition are those from the vectors of the return map") {
  const auto check = [](const HybridSystem& hybrid, const Signature& signature, const Orbit& x, auto multiplier,
                        auto make_condition) {
    ConditionAt at(hybrid, signature, x);
    auto condition = make_condition(at.system, x.shape);
    at.value(condition, x);
    NormalFormSolver solver(at.system);
    const FloquetMultipliers multipliers = FloquetSolver(x.shape).compute(at.condensed, x);
    const std::optional<Coefficient> on_curve = solver.find(at.condensed, x, condition, multipliers);
    const OrbitVector tangent = at.random_vector(at.condensed.make_vector());
    const std::optional<NormalForm> of_label = normal_form(at.system, x, tangent, multiplier);
    REQUIRE(on_curve);
    REQUIRE(of_label);
    CHECK(on_curve->value == Approx(of_label->coefficient.real()).epsilon(1e-7));
  };
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, period_doubling_velocity());
  for (const CutOrbit& cut : all_cuts(orbit)) {
    CAPTURE(cut.signature.size());
    check(linosc(), cut.signature, sampled(cut, orbit, 40, 5), -1.0,
          [](const DefiningSystem& system, const OrbitShape& shape) { return CriticalMultiplier(system, shape, -1); });
  }
  const LangfordCircle circle = LangfordCircle{}.at_torus();
  const std::complex<double> mu = circle.multiplier() / std::abs(circle.multiplier());
  check(system_of<Langford>(), {{1, 1, 1}}, circle.orbit(40, 5), mu,
        [&](const DefiningSystem& system, const OrbitShape& shape) { return CriticalPair(system, shape, mu); });
}

TEST_CASE("critical pair: gradient") {
  for (const double change : {0.0, 0.05}) {
    LangfordCircle circle = LangfordCircle{}.at_torus();
    circle.a += change;
    const Orbit x = circle.orbit(9, 4);
    ConditionAt at(system_of<Langford>(), {{1, 1, 1}}, x);
    CriticalPair condition(at.system, x.shape, circle.multiplier());
    CAPTURE(change);
    check_gradient(at, condition, x);
  }
  // A complex pair of an impacting orbit, in one and in two segments.
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, 0.5);
  for (const CutOrbit& cut : {whole(orbit), cut_at_minimum(orbit, false)}) {
    const Orbit x = sampled(cut, orbit, 9, 4);
    ConditionAt at(linosc(), cut.signature, x);
    CriticalPair condition(at.system, x.shape, {0.5896957647, 0.34676174832});
    check_gradient(at, condition, x);
  }
}

TEST_CASE("critical pair of a fixed angle: the cosine in closed form, gradients of both conditions") {
  LangfordCircle circle = LangfordCircle{}.at_torus();
  circle.a += 0.05;
  const Orbit fine = circle.orbit(40, 5);
  ConditionAt exact(system_of<Langford>(), {{1, 1, 1}}, fine);
  CriticalPair pair(exact.system, fine.shape, circle.multiplier(), 0.3);
  REQUIRE(pair.count() == 2);
  CHECK(exact.value(pair, fine, 1) == Approx(circle.multiplier().real() - 0.3).margin(1e-10));
  const Orbit x = circle.orbit(9, 4);
  ConditionAt at(system_of<Langford>(), {{1, 1, 1}}, x);
  CriticalPair condition(at.system, x.shape, circle.multiplier(), 0.3);
  check_gradient(at, condition, x);
}

TEST_CASE("critical branch point: gradients of both conditions") {
  // At a fold, where the second number is not zero, and far from any bifurcation.
  for (const double v : {fold_velocity(), 3.0}) {
    const OscillatorOrbit orbit = one_impact_orbit(1.8901, v);
    for (const CutOrbit& cut : all_cuts(orbit)) {
      CAPTURE(v, cut.signature.size());
      const Orbit x = sampled(cut, orbit, 7, 4);
      ConditionAt at(linosc(), cut.signature, x);
      CriticalBranchPoint condition(at.system, x.shape);
      REQUIRE(condition.count() == 2);
      check_gradient(at, condition, x);
    }
  }
  const Orbit circle = LangfordCircle{}.orbit(9, 4);
  ConditionAt at(system_of<Langford>(), {{1, 1, 1}}, circle);
  CriticalBranchPoint condition(at.system, circle.shape);
  check_gradient(at, condition, circle);
}

TEST_CASE("stationary monitors: gradients agree with differences, for all kinds of monitors, held ones too") {
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, 2.5);
  const CutOrbit pieces = cut_at_minimum(orbit, false);
  const Orbit x = sampled(pieces, orbit, 20, 4);
  const auto monitor = [&](const DefiningSystem& system, const std::string& name) {
    return std::shared_ptr<const Monitor>(make_monitor(parse_monitor(linosc(), name, "test"), system));
  };
  const std::string name =
      GENERATE(as<std::string>{}, "integral(x1, 1)", "start(x2)", "end(y1, 1)", "max(x2)", "velocity(1)");
  const std::string held = GENERATE(as<std::string>{}, "", "mean(x1)");
  CAPTURE(name, held);
  ConditionAt at(linosc(), pieces.signature, x,
                 held.empty() ? std::vector<int>{1, 3, 4} : std::vector<int>{1, 3, 4, 2});
  std::vector<HeldMonitor> list;
  if (!held.empty()) list.push_back({monitor(at.system, held), 0.0, held});
  StationaryMonitor condition(at.system, x.shape, monitor(at.system, name), list);
  REQUIRE(condition.count() == 2);
  // Second derivatives of monitors are differences themselves. Displacements of single nodes move the place of a
  // maximum far, so that larger ones say little of its derivative.
  check_gradient(at, condition, x, {name == "max(x2)" ? 1e-5 : 2e-4, 1e-7});
}
