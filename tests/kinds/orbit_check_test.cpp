// Orbits of the linear oscillator in closed form pass; each kind of fault is found and named.
#include "kinds/orbit_check.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "support/linear_oscillator.hpp"
#include "support/multiplier_sets.hpp"
#include "support/test_system.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

constexpr double tolerance = 1e-6;

RunSettings settings_of(const Signature& signature, const std::vector<int>& monitored = {}) {
  RunSettings settings;
  settings.dimension = 4;
  for (const IndexVector& index : signature) settings.segments.push_back({1, index, monitored});
  return settings;
}

Orbit orbit(const OscillatorOrbit& of, const std::vector<double>& durations) {
  std::vector<Piece> pieces;
  double from = 0.0;
  for (const double duration : durations) {
    pieces.push_back(of.piece(from, from + duration));
    from += duration;
  }
  return sampled_orbit(pieces, 4, 10, 4, of.par());
}

Orbit impacting(double v) {
  const OscillatorOrbit closed_form = one_impact_orbit(2.0072, v);
  return orbit(closed_form, {closed_form.constants.period()});
}

using Defects = std::vector<Defect>;

/// x' = 1, z' = rate z: along x with z beside it.
struct Drift {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    f[0] = T(1.0);
    f[1] = par[0] * x[1];
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[1];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0];
    g[1] = x[1];
  }
};

/// A circle, cut where y falls through zero, and a surface whose gradient vanishes where the circle meets it.
struct Circle {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 2, jumps = 1;
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    f[0] = -x[1];
    f[1] = x[0];
  }
  template <class T>
  T event(int j, const T* x, const T* par) const {
    if (j == 1) return x[1];
    return (1.0 - x[0]) * (1.0 - x[0]) + x[1] * x[1] + par[0];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0];
    g[1] = x[1];
  }
};

/// One segment of a problem with states of a closed form.
Orbit piece_of(double duration, std::function<Eigen::VectorXd(double)> state, double par) {
  return sampled_orbit({{duration, std::move(state)}}, 2, 10, 4, parameters({par}));
}

RunSettings plane_settings(const std::vector<int>& monitored = {}) {
  RunSettings settings = settings_of({{1, 1, 0}}, monitored);
  settings.dimension = 2;
  return settings;
}

Defects defects(const HybridSystem& system, const RunSettings& settings, const Orbit& x) {
  return defects_of(check_orbit(system, settings, x, {}, tolerance), 0, tolerance);
}

bool has(const Defects& all, Defect defect) { return std::find(all.begin(), all.end(), defect) != all.end(); }

}  // namespace

TEST_CASE("a small event function excuses no time: h = z = 1e-10 all along is never met") {
  const auto along = [](double t) { return Eigen::Vector2d(t, 1e-10); };
  const OrbitCheck check = check_orbit(system_of<Drift>(), plane_settings(), piece_of(3.0, along, 0.0), {}, tolerance);
  CHECK(std::isinf(check.segments[0].time_defect));
  CHECK(has(defects_of(check, 0, tolerance), Defect::time));
  // z falls to 1e-10 and would go on falling for ever.
  const auto falling = [](double t) { return Eigen::Vector2d(t, std::exp(-t)); };
  CHECK(has(defects(system_of<Drift>(), plane_settings(), piece_of(23.0, falling, -1.0)), Defect::time));
}

TEST_CASE("contact with a surface whose gradient vanishes there is measured by its gradient along the orbit") {
  const auto circle = [](double t) { return Eigen::Vector2d(std::cos(t - pi), std::sin(t - pi)); };
  const RunSettings settings = plane_settings({2});
  // At (1, 0) h = par: located to 1e-9 it is a contact, at -1e-3 it is an event.
  const auto wrong = [&](double least) {
    return check_orbit(system_of<Circle>(), settings, piece_of(2 * pi, circle, least), {}, tolerance).segments[0].wrong;
  };
  CHECK(wrong(-1e-9).empty());
  const auto found = wrong(-1e-3);
  REQUIRE(found.size() == 1);
  CHECK(found[0].depth < 1e-3);  // of the size of h_x, 4 at the far side
  CHECK(found[0].depth > 1e-4);
}

TEST_CASE("an orbit lasts a positive time, and its numbers are finite") {
  const auto circle = [](double t) { return Eigen::Vector2d(std::cos(t), std::sin(t)); };
  const Orbit right = piece_of(2 * pi, circle, 1.0);
  for (const double duration : {-2 * pi, 0.0, std::nan("")}) {
    CAPTURE(duration);
    Orbit x = right;
    x.duration(0) = duration;
    CHECK(has(defects(system_of<Circle>(), plane_settings(), x), Defect::duration));
  }
  CHECK_FALSE(has(defects(system_of<Circle>(), plane_settings(), right), Defect::duration));
  for (const Eigen::Index column : {Eigen::Index{0}, Eigen::Index{40}}) {
    Orbit x = right;
    x.states(1, column) = NAN;
    CHECK_FALSE(defects(system_of<Circle>(), plane_settings(), x).empty());
  }
}

TEST_CASE("where errors of the start grow by more than 1e7 the end says nothing") {
  const auto growing = [](double t) { return Eigen::Vector2d(t, 1e-13 * std::exp(t)); };
  CHECK(defects(system_of<Drift>(), plane_settings(), piece_of(20.0, growing, 1.0)) == Defects{Defect::undecided});
}

TEST_CASE("closed forms pass, with their multipliers, down to impacts of low velocity") {
  const RunSettings settings = settings_of({{1, 1, 1}}, {1});
  for (const double v : {5.0, 0.5, 0.01, 1e-4}) {
    CAPTURE(v);
    const auto multipliers = one_impact_multipliers(2.0072, v);
    const OrbitCheck check = check_orbit(linosc(), settings, impacting(v), multipliers, tolerance);
    CHECK(check.segments[0].state_defect < 1e-11);
    CHECK(check.segments[0].time_defect < 1e-11 / v);
    CHECK(defects_of(check, 0, tolerance).empty());
    REQUIRE(check.multiplier_difference);
    CHECK(*check.multiplier_difference < 1e-11 / v);
    CHECK_FALSE(are_multipliers_wrong(check, tolerance));
  }
  const double omega = 2.0;
  const OscillatorOrbit smooth = nonimpacting_orbit(omega, 2.0);
  const OrbitCheck check =
      check_orbit(linosc(), settings_of({{1, 2, 2}}, {1}), orbit(smooth, {smooth.constants.period()}), {}, tolerance);
  CHECK(defects_of(check, 0, tolerance).empty());
  CHECK(mixed_distance(check.multipliers, nonimpacting_multipliers(omega)) < 1e-11);
  CHECK_FALSE(check.multiplier_difference);
}

TEST_CASE("a grazing end passes as contact: h_x f = 0, the multipliers of the smooth return map") {
  RunSettings settings = settings_of({{1, 1, 2}});
  settings.problem_type = 150;
  settings.segments[0].type = 2;
  const double omega = 1.7;
  const OscillatorConstants constants{omega};
  const OscillatorOrbit grazing = nonimpacting_orbit(omega, std::abs(constants.stiffness()));
  Orbit x = orbit(grazing, {constants.period()});
  const auto expected = nonimpacting_multipliers(omega);
  const OrbitCheck check = check_orbit(linosc(), settings, x, expected, tolerance);
  CHECK(check.segments[0].time_defect < 1e-10);
  CHECK(defects_of(check, 0, tolerance).empty());
  CHECK(*check.multiplier_difference < 1e-10);

  // The same from another point of the orbit: it ends short of the wall, and not at the least distance.
  x = sampled_orbit({grazing.piece(0.1, 0.1 + constants.period())}, 4, 10, 4, grazing.par());
  CHECK(defects_of(check_orbit(linosc(), settings, x, {}, tolerance), 0, tolerance) == Defects{Defect::time});
}

TEST_CASE("a stored end or start that is wrong is a defect of the state") {
  const RunSettings settings = settings_of({{1, 1, 1}});
  for (const Eigen::Index column : {Eigen::Index{0}, Eigen::Index{40}}) {
    Orbit x = impacting(0.5);
    x.states(1, column) += 3e-5;
    const OrbitCheck check = check_orbit(linosc(), settings, x, {}, tolerance);
    const Defects defects = defects_of(check, 0, tolerance);
    CHECK(std::find(defects.begin(), defects.end(), Defect::state) != defects.end());
    CHECK(defects_of(check, 0, 1e-2).empty());
  }
}

TEST_CASE("a duration that is wrong: the end is elsewhere and the event comes at another time") {
  Orbit x = impacting(0.5);
  x.duration(0) -= 1e-3;
  const OrbitCheck check = check_orbit(linosc(), settings_of({{1, 1, 1}}), x, {}, tolerance);
  CHECK(check.segments[0].time_defect == Approx(1e-3).epsilon(0.01));
  CHECK(defects_of(check, 0, tolerance) == Defects{Defect::state, Defect::time});
}

TEST_CASE("a parameter that is wrong, and multipliers that are") {
  Orbit x = impacting(0.5);
  x.par(0) += 1e-4;
  CHECK_FALSE(defects_of(check_orbit(linosc(), settings_of({{1, 1, 1}}), x, {}, tolerance), 0, tolerance).empty());

  auto multipliers = one_impact_multipliers(2.0072, 0.5);
  for (const double error : {1e-4, -1e-3}) {
    auto wrong = multipliers;
    wrong[0] += error;
    wrong[1] = std::conj(wrong[0]);
    const OrbitCheck check = check_orbit(linosc(), settings_of({{1, 1, 1}}), impacting(0.5), wrong, tolerance);
    CHECK(*check.multiplier_difference == Approx(std::abs(error)).epsilon(0.01));
    CHECK(are_multipliers_wrong(check, tolerance));
  }
}

TEST_CASE("an event that comes first is named with its time, monitored or by the index jump function") {
  // Larger than the gap: from its maximum, which is behind the wall, back and through the wall at cos(omega t) = 0.8.
  const double omega = 2.0, amplitude = 1.25;
  const OscillatorConstants constants{omega};
  const OscillatorOrbit smooth = nonimpacting_orbit(omega, amplitude * std::abs(constants.stiffness()));
  const double crossing = (2 * pi - std::acos(1.0 / amplitude)) / omega;
  for (const bool is_monitored : {true, false}) {
    const RunSettings settings = settings_of({{1, 2, 2}}, is_monitored ? std::vector<int>{1} : std::vector<int>{});
    const Orbit x = orbit(smooth, {constants.period()});
    const OrbitCheck check = check_orbit(linosc(), settings, x, {}, tolerance);
    CHECK(defects_of(check, 0, tolerance) == Defects{Defect::event});
    REQUIRE(check.segments[0].wrong.size() == 1);
    CHECK(check.segments[0].wrong[0].event == 1);
    // The monitored function is below zero from the start.
    CHECK(check.segments[0].wrong[0].time == Approx(is_monitored ? 0.0 : crossing).margin(1e-9));
  }
}

TEST_CASE("a section that is passed changes nothing, contact by less than the tolerance neither") {
  // Cut at minima, with the maxima passed.
  const double omega = 2.0;
  const OscillatorConstants constants{omega};
  const OscillatorOrbit smooth = nonimpacting_orbit(omega, std::abs(constants.stiffness()) * (1.0 + 1e-8));
  const double half = 0.5 * constants.period();
  const Orbit x = sampled_orbit({smooth.piece(half, half + constants.period())}, 4, 10, 4, smooth.par());
  const OrbitCheck check = check_orbit(linosc(), settings_of({{1, 3, 2}}, {1}), x, {}, tolerance);
  CHECK(defects_of(check, 0, tolerance).empty());
  REQUIRE(check.segments[0].passed.size() == 1);
  CHECK(check.segments[0].passed[0].event == 2);
  CHECK(check.segments[0].passed[0].time == Approx(half).margin(1e-8));
}

TEST_CASE("segments of no duration, of negative duration, and impacts from behind the wall") {
  const OscillatorOrbit grazing = one_impact_orbit(2.0072, 0.0);
  const Orbit empty = orbit(grazing, {grazing.constants.period(), 0.0});
  const OrbitCheck check = check_orbit(linosc(), settings_of({{1, 1, 2}, {1, 1, 1}}), empty, {}, tolerance);
  CHECK(defects_of(check, 0, tolerance).empty());
  CHECK(defects_of(check, 1, tolerance).empty());

  const OscillatorOrbit closed_form = one_impact_orbit(2.0072, 0.5);
  const double period = closed_form.constants.period();
  const Orbit back = orbit(closed_form, {period + 0.1, -0.1});
  const OrbitCheck backwards = check_orbit(linosc(), settings_of({{1, 1, 2}, {1, 1, 1}}), back, {}, tolerance);
  CHECK(backwards.segments[1].state_defect < 1e-10);
  CHECK(defects_of(backwards, 1, tolerance) == Defects{Defect::event});

  const OrbitCheck unphysical = check_orbit(linosc(), settings_of({{1, 1, 1}}), impacting(-0.5), {}, tolerance);
  CHECK(unphysical.segments[0].leaves_surface);
  CHECK(unphysical.segments[0].state_defect < 1e-10);
  CHECK(defects_of(unphysical, 0, tolerance) == Defects{Defect::event});
}
