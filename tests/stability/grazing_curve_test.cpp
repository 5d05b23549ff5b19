// Test functions on grazing curves: xi_n of the linear oscillator in closed form, multipliers of the smooth return map.
#include "stability/grazing_tests.hpp"

#include <catch2/catch.hpp>

#include "impacting_orbits.hpp"
#include "normal_forms.hpp"
#include "recorded_branch.hpp"
#include "stability/bifurcation_tests.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

RecordedBranch continued(const GrazingOrbitSystem& system, const Orbit& start, double ds, double largest_step,
                         int points, Tests tests) {
  const int principal = system.free_parameters().front();
  PathFollower follower(system, start.shape, WeightedNorm::unit(start.shape), tight_newton(), principal);
  PathPoint point = follower.make_point(start);
  REQUIRE(follower.start_at_fixed_parameter(point).converged());
  ContinuationSettings settings = branch_settings(start.shape, principal, ds, largest_step, points);
  settings.location_tolerance = 1e-10;
  settings.max_location = 25;
  settings.adapt_mesh_every = 3;
  return record(follower, system, point, settings, std::move(tests));
}

/// (1 + r) omega^2 exp(-zeta n T) sin(n omega_d T) / omega_d
double exact_xi(int n, double omega) {
  const double damped = std::sqrt(1 - 0.05 * 0.05);
  const double time = n * 2 * pi / omega;
  return 1.8 * omega * omega * std::exp(-0.05 * time) * std::sin(damped * time) / damped;
}

/// {(1,1,2)} from omega on; PAR(2) first, so that omega is the principal parameter.
RecordedBranch grazing_oscillator(double omega, double ds, double largest_step, int points, int most,
                                  int intervals = 50, int collocation = 4) {
  const double alpha = std::abs(OscillatorConstants{omega}.stiffness());
  const OscillatorOrbit orbit = nonimpacting_orbit(omega, alpha);
  const Orbit start = sampled_orbit({orbit.piece(0, orbit.constants.period())}, 4, intervals, collocation, orbit.par());
  const GrazingOrbitSystem system(linosc(), {{1, 1, 2}}, {2, 1}, 0);
  Tests tests;
  for (int n = 1; n <= most; ++n) tests.push_back(std::make_unique<XiTest>(system, 1, n));
  for (const int target : {1, -1}) tests.push_back(std::make_unique<SmoothMultiplierTest>(target));
  return continued(system, start, ds, largest_step, points, std::move(tests));
}

/// A parabola x1 over the wall x1 = 0, reset where it rises with speed 1: x1 -> p + y, x2 -> -1, y -> lambda y + 0.1.
/// The wall is touched when p = 1/2 - y, y = 0.1 / (1 - lambda). Impacts (jump 1) give y their speed: A of rank one,
/// A (0, 0, 1) = (1, 0, lambda), and xi_n = -lambda^(n-1).
struct ResetParabola {
  static constexpr int dimension = 3, parameters = 2, fields = 1, events = 2, jumps = 3;

  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    f[0] = x[1], f[1] = T(1.0), f[2] = T(0.0);
  }
  template <class T>
  T event(int j, const T* x, const T*) const {
    return j == 1 ? x[0] : 1.0 - x[1];
  }
  template <class T>
  void jump(int k, const T* x, const T* p, T* g) const {
    g[0] = x[0], g[1] = x[1], g[2] = x[2];
    if (k == 1) g[1] = -0.5 * x[1], g[2] = x[2] + x[1];
    if (k == 3) g[0] = p[0] + x[2], g[1] = T(-1.0), g[2] = p[1] * x[2] + 0.1;
  }

  static Orbit orbit(double lambda) {
    const double y = 0.1 / (1.0 - lambda);
    const auto from = [y](double speed) {
      return [=](double t) {
        const double v = speed + t;
        return Eigen::VectorXd(Eigen::Vector3d(0.5 * v * v, v, y));
      };
    };
    return sampled_orbit({{1.0, from(-1.0)}, {1.0, from(0.0)}}, 3, 20, 4, test::parameters({0.5 - y, lambda}));
  }
};

/// xi_1 vanishes at 2 omega_d, xi_2 there and at 4 omega_d / 3: found from below and from above.
void check_zeros_of_two(int intervals, int collocation, double tolerance) {
  const double damped = std::sqrt(1 - 0.05 * 0.05);
  for (const double way : {1.0, -1.0}) {
    CAPTURE(intervals, collocation, way);
    const RecordedBranch branch =
        grazing_oscillator(way > 0 ? 1.25 : 2.1, way * 0.05, 0.1, 40, 2, intervals, collocation);
    std::vector<double> found;
    for (const RecordedPoint* p : branch.special())
      if (const double omega = p->orbit.par(1); omega > 1.25 && omega < 2.1) found.push_back(omega);
    REQUIRE(found.size() == 2);
    std::sort(found.begin(), found.end());
    CHECK(std::abs(found[0] - 4 * damped / 3) < tolerance);
    CHECK(std::abs(found[1] - 2 * damped) < tolerance);
  }
}

}  // namespace

TEST_CASE("xi_n that decay with n are not zero, and vanish together where the return map loses its last direction") {
  const GrazingOrbitSystem system(system_of<ResetParabola>(), {{1, 1, 2}, {1, 2, 3}}, {2, 1}, 0);
  constexpr int most = 6;
  Tests tests;
  for (int n = 1; n <= most; ++n) tests.push_back(std::make_unique<XiTest>(system, 1, n));
  const RecordedBranch branch = continued(system, ResetParabola::orbit(-0.02), 0.003, 0.003, 20, std::move(tests));
  for (const RecordedPoint& p : branch.points) {
    if (p.special.type == PointType::user) continue;  // there they are given as zero
    const double lambda = p.orbit.par(1);
    CAPTURE(lambda);
    for (int n = 1; n <= most; ++n)
      CHECK(*p.values[static_cast<std::size_t>(n - 1)] == Approx(-std::pow(lambda, n - 1)).epsilon(1e-6));
  }
  REQUIRE(branch.special().size() == 1);
  const RecordedPoint& zero = *branch.special().front();
  CHECK(std::abs(zero.orbit.par(1)) < 1e-9);
  for (const char* name : {"xi_2 = 0", "xi_4 = 0", "xi_6 = 0"})
    CHECK(zero.special.description.find(name) != std::string::npos);
  CHECK(zero.special.description.find("xi_1") == std::string::npos);
}

TEST_CASE("xi_n: closed form agrees with the published values") {
  CHECK(exact_xi(1, 1.5) == Approx(-2.83954739661).epsilon(1e-11));
  CHECK(exact_xi(1, 3.0) == Approx(12.669656605).epsilon(1e-10));
  CHECK(exact_xi(2, 2.0) == Approx(-0.0413804785294).epsilon(1e-10));
}

TEST_CASE("xi_n of large n: the closed form, and its sign where numbers of its size do not exist") {
  const double omega = 1.5;
  const OscillatorOrbit orbit = nonimpacting_orbit(omega, std::abs(OscillatorConstants{omega}.stiffness()));
  const Orbit start = sampled_orbit({orbit.piece(0, orbit.constants.period())}, 4, 100, 6, orbit.par());
  const GrazingOrbitSystem system(linosc(), {{1, 1, 2}}, {2, 1}, 0);
  Tests tests;
  const int numbers[] = {40, 41, 100, 1000, 3000, 100000};
  for (const int n : numbers) tests.push_back(std::make_unique<XiTest>(system, 1, n));
  const RecordedBranch branch = continued(system, start, 1e-7, 1e-7, 2, std::move(tests));
  const RecordedPoint& p = branch.points.front();
  const double at = p.orbit.par(1);
  const double amplitude = 1.8 * at * at / std::sqrt(1 - 0.05 * 0.05);
  for (std::size_t k = 0; k < std::size(numbers); ++k) {
    CAPTURE(numbers[k]);
    REQUIRE(p.values[k]);
    const double n = numbers[k];
    const double decay = std::exp(-0.05 * n * 2 * pi / at);
    if (n <= 1000) CHECK(*p.values[k] == Approx(exact_xi(numbers[k], at)).margin(1e-9 * n * amplitude * decay));
    if (n <= 1000) continue;
    const double sine = std::sin(std::sqrt(1 - 0.05 * 0.05) * n * 2 * pi / at);
    CHECK(std::abs(sine) > 1e-3);
    CHECK((*p.values[k] > 0) == (sine > 0));
    CHECK(std::abs(*p.values[k]) < 1e-260);
  }
}

TEST_CASE("xi_n and the smooth multipliers of the linear oscillator along the grazing curve") {
  const RecordedBranch branch = grazing_oscillator(2.0, 0.05, 0.1, 15, 5);
  for (const RecordedPoint& p : branch.points) {
    const double omega = p.orbit.par(1);
    CAPTURE(p.number, omega);
    CHECK(p.orbit.par(0) == Approx(std::abs(OscillatorConstants{omega}.stiffness())).epsilon(1e-10));
    for (int n = 1; n <= 5; ++n) {
      CAPTURE(n);
      const auto value = p.values[static_cast<std::size_t>(n - 1)];
      REQUIRE(value);
      CHECK(*value == Approx(exact_xi(n, omega)).margin(1e-8));
    }
    for (const int target : {1, -1}) {
      std::complex<double> product = 1.0;
      for (const auto& mu : nonimpacting_multipliers(omega)) product *= 1.0 - mu / static_cast<double>(target);
      // On h_P = -x2 = 0 at the contact, where x2' = -omega^2 and the phase has the speed omega.
      const double crossing = omega / std::hypot(1.0, omega);
      CHECK(*p.values[target == 1 ? 5 : 6] == Approx(crossing * product.real()).epsilon(1e-7));
    }
  }
}

TEST_CASE("xi_n and the smooth multipliers do not depend on cuts of the orbit, in either order of the segments") {
  constexpr double omega = 1.7;
  const OscillatorOrbit orbit = nonimpacting_orbit(omega, std::abs(OscillatorConstants{omega}.stiffness()));
  const double half = orbit.constants.period() / 2;  // from the contact, the maximum of x1, to its minimum
  const Piece falling = orbit.piece(0, half), rising = orbit.piece(half, 2 * half);
  for (const bool contact_first : {true, false}) {
    CAPTURE(contact_first);
    const Signature signature = contact_first ? Signature{{1, 1, 2}, {1, 3, 2}} : Signature{{1, 3, 2}, {1, 1, 2}};
    const std::vector<Piece> pieces =
        contact_first ? std::vector<Piece>{rising, falling} : std::vector<Piece>{falling, rising};
    const Orbit start = sampled_orbit(pieces, 4, 40, 4, orbit.par());
    const GrazingOrbitSystem system(linosc(), signature, {2, 1}, contact_first ? 0 : 1);
    Tests tests;
    for (int n = 1; n <= 5; ++n) tests.push_back(std::make_unique<XiTest>(system, 1, n));
    const RecordedBranch branch = continued(system, start, 0.03, 0.03, 6, std::move(tests));
    REQUIRE(branch.points.size() == 6);
    for (const RecordedPoint& p : branch.points) {
      const double at = p.orbit.par(1);
      CAPTURE(at);
      for (int n = 1; n <= 5; ++n)
        CHECK(*p.values[static_cast<std::size_t>(n - 1)] == Approx(exact_xi(n, at)).margin(1e-8));
      for (const auto& exact : nonimpacting_multipliers(at)) {
        double nearest = 1.0;
        for (const auto& mu : p.multipliers.values) nearest = std::min(nearest, std::abs(mu - exact));
        CHECK(nearest < 1e-7);
      }
    }
  }
}

TEST_CASE("xi_n vanish at omega = 2 n omega_d / k, every one of them", "[slow]") {
  const double damped = std::sqrt(1 - 0.05 * 0.05);
  constexpr double low = 0.8, high = 2.3;
  constexpr int most = 5;
  for (const double largest_step : {0.02, 0.3}) {
    CAPTURE(largest_step);
    const RecordedBranch branch = grazing_oscillator(low, 0.02, largest_step, 900, most);
    REQUIRE(branch.points.back().orbit.par(1) > high);
    std::vector<double> zeros;
    for (int n = 1; n <= most; ++n)
      for (int k = 1; k <= 40; ++k)
        if (const double omega = 2 * n * damped / k; omega > low && omega < high) zeros.push_back(omega);
    std::sort(zeros.begin(), zeros.end());
    zeros.erase(std::unique(zeros.begin(), zeros.end(), [](double a, double b) { return std::abs(a - b) < 1e-9; }),
                zeros.end());
    std::vector<double> found;
    for (const RecordedPoint* p : branch.special())
      if (p->orbit.par(1) < high) found.push_back(p->orbit.par(1));
    REQUIRE(found.size() == zeros.size());
    for (std::size_t i = 0; i < zeros.size(); ++i) CHECK(found[i] == Approx(zeros[i]).margin(1e-7));
    CHECK(branch.notes.size() ==
          static_cast<std::size_t>(std::count_if(branch.notes.begin(), branch.notes.end(),
                                                 [](const std::string& note) { return note.find("Retrying") == 0; })));
  }
}

TEST_CASE("xi_1 to xi_5 vanish together at 2 omega_d: one label names them all") {
  constexpr int most = 5;
  const RecordedBranch branch = grazing_oscillator(1.98, 0.01, 0.05, 12, most);
  REQUIRE(!branch.special().empty());
  const std::string text = branch.special()[0]->special.description;
  for (int n = 1; n <= most; ++n) CHECK(text.find("xi_" + std::to_string(n)) != std::string::npos);
}

TEST_CASE("xi_1 and xi_2 vanish at the same places on coarse meshes of every order, both ways") {
  check_zeros_of_two(20, 3, 1e-5);
  check_zeros_of_two(50, 5, 1e-7);
  check_zeros_of_two(50, 6, 1e-7);
}

TEST_CASE("xi_1 and xi_2 vanish at the same places on fine meshes, both ways", "[slow]") {
  check_zeros_of_two(100, 4, 1e-7);
  check_zeros_of_two(200, 4, 1e-7);
  check_zeros_of_two(200, 6, 1e-7);
}

TEST_CASE("grazing-fold and grazing-flip of the normal forms") {
  // Wall p = 1 + z touched at theta = 0, followed in (mu, p).
  SECTION("fold: multiplier exp(-4 pi z), not along the principal parameter p = 1 + z") {
    const GrazingOrbitSystem system(system_of<NormalForms>(), {{2, 2, 1}}, {2, 1}, 0);
    const RecordedBranch branch =
        continued(system, NormalForms::orbit(0.0, 0.3, 0.09, 1.3), -0.03, 0.1, 14, one_test<SmoothMultiplierTest>(1));
    REQUIRE(branch.special().size() == 1);
    CHECK(branch.special()[0]->special.kind.kind == UserPointKind::grazing_codimension_two);
    CHECK(branch.special()[0]->special.description.find("grazing-fold") != std::string::npos);
    CHECK(branch.special()[0]->orbit.par(1) == Approx(1.0).margin(1e-8));
    for (const RecordedPoint& p : branch.points) {
      const double z = p.orbit.par(1) - 1;
      // The gradient of h_P at the contact is (2, 1, 2 z), the field (0, 1, 0).
      const double crossing = 1 / std::sqrt(5 + 4 * z * z);
      const double expected = crossing * (1 - std::exp(-4 * pi)) * (1 - std::exp(-4 * pi * z));
      CHECK(*p.values[0] == Approx(expected).epsilon(1e-5).margin(1e-7));
    }
  }
  SECTION("flip: multiplier -exp(2 pi mu)") {
    const GrazingOrbitSystem system(system_of<NormalForms>(), {{1, 2, 2}}, {1, 2}, 0);
    const RecordedBranch branch =
        continued(system, NormalForms::orbit(0.0, 0.0, -0.2, 1.0), 0.03, 0.1, 8, one_test<SmoothMultiplierTest>(-1));
    REQUIRE(branch.special().size() == 1);
    CHECK(branch.special()[0]->special.description.find("grazing-flip") != std::string::npos);
    CHECK(branch.special()[0]->orbit.par(0) == Approx(0.0).margin(1e-8));
  }
  SECTION("symmetry breaking is a branch point, not a grazing-fold") {
    const GrazingOrbitSystem system(system_of<NormalForms>(), {{1, 2, 1}}, {1, 2}, 0);
    Tests tests;
    tests.push_back(std::make_unique<BranchPointTest>(false));
    tests.push_back(std::make_unique<SmoothMultiplierTest>(1));
    const RecordedBranch branch =
        continued(system, NormalForms::orbit(0.0, 0.0, -0.2, 1.0), 0.03, 0.1, 8, std::move(tests));
    REQUIRE(branch.special().size() == 1);
    CHECK(branch.special()[0]->special.type == PointType::branch_point);
    CHECK(branch.special()[0]->orbit.par(0) == Approx(0.0).margin(1e-8));
  }
}
