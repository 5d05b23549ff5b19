// Equilibria in closed form: folds, branch points, Hopf bifurcations, contact with event surfaces, and their curves in
// two parameters with the points of codimension two.
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "orbit/equilibrium_system.hpp"
#include "run/branch_setup.hpp"
#include "settings/problem_type.hpp"
#include "settings/run_settings.hpp"
#include "stability/equilibrium_normal_form.hpp"
#include "stability/equilibrium_tests.hpp"
#include "support/branch_fixture.hpp"
#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

/// Newton's method ends below 1e-11, special points are located to 1e-10 of arclength.
constexpr double accuracy = 1e-9;

/// x' = p1 + p2 x - x^3: folds on 27 p1^2 = 4 p2^3, a cusp at 0, a pitchfork for p1 = 0.
struct Cusp {
  static constexpr int dimension = 1, parameters = 2, fields = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = p[0] + p[1] * x[0] - x[0] * x[0] * x[0];
  }
};

/// A pitchfork beside another equation, whose size is p2.
struct Decoupled {
  static constexpr int dimension = 2, parameters = 2, fields = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = p[0] * x[0] - x[0] * x[0] * x[0];
    f[1] = p[1] * (T(0.5) - x[1]);
  }
};

/// Equilibrium (A, B / A), Hopf bifurcations on B = 1 + A^2 with omega = A.
struct Brusselator {
  static constexpr int dimension = 2, parameters = 2, fields = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    const T square = x[0] * x[0] * x[1];
    f[0] = p[0] - (p[1] + T(1.0)) * x[0] + square;
    f[1] = p[1] * x[0] - square;
  }
};

/// x'' = p1 + p2 x + x^2 - x x': folds on 4 p1 = p2^2, Hopf bifurcations on p1 = 0, p2 < 0 with omega^2 = -p2.
struct Bogdanov {
  static constexpr int dimension = 2, parameters = 2, fields = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = x[1];
    f[1] = p[0] + p[1] * x[0] + x[0] * x[0] - x[0] * x[1];
  }
};

/// A fold at p1 = 0 beside an oscillation that grows with p2 + x: the curves x = 0 and x = -p2, p1 = p2^2 meet at 0.
struct FoldAndOscillation {
  static constexpr int dimension = 3, parameters = 2, fields = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = p[0] - x[0] * x[0];
    f[1] = (p[1] + x[0]) * x[1] - T(2.0) * x[2];
    f[2] = T(2.0) * x[1] + (p[1] + x[0]) * x[2];
  }
};

/// z' = (p1 + 3 i) z + p2 z |z|^2 - z |z|^4: Hopf at p1 = 0, the orbits' direction changes at p2 = 0.
struct Bautin {
  static constexpr int dimension = 2, parameters = 2, fields = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    const T square = x[0] * x[0] + x[1] * x[1];
    const T growth = p[0] + p[1] * square - square * square;
    f[0] = growth * x[0] - T(3.0) * x[1];
    f[1] = T(3.0) * x[0] + growth * x[1];
  }
};

/// Two real eigenvalues p1 and -1 whose sum is zero at p1 = 1, and the fold-free line of equilibria x = 0.
struct Saddle {
  static constexpr int dimension = 2, parameters = 1, fields = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = (p[0] + T(0.5)) * x[0] + x[1] * x[1];
    f[1] = -x[1];
  }
};

/// The equilibrium x = p1, y = p1^2 meets h1 = 2 - x from above and h2 = x + 1 from below.
struct Walls {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 2;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = p[0] - x[0];
    f[1] = x[0] * x[0] - x[1];
  }
  template <class T>
  T event(int j, const T* x, const T*) const {
    return j == 1 ? T(2.0) - x[0] : x[0] + T(1.0);
  }
};

/// omega = 2 and terms of every kind, for the formula of the plane.
struct PlanarHopf {
  static constexpr int dimension = 2, parameters = 1, fields = 1;
  template <class T>
  void field(int, const T* u, const T*, T* out) const {
    const T x = u[0], y = u[1];
    out[0] = T(-2.0) * y + T(0.3) * x * x + T(0.7) * x * y - T(0.2) * y * y + T(1.1) * x * x * x - T(0.4) * x * y * y;
    out[1] = T(2.0) * x + T(0.5) * x * x - T(0.4) * x * y + T(0.9) * y * y + T(0.6) * x * x * y - T(2.0) * y * y * y;
  }
};

enum class Curve { none, fold, hopf };

/// A branch from a state near an equilibrium, with the tests of its problem type.
struct Branch {
  KeepingSink sink;
  BranchSummary summary;

  std::vector<KeptPoint> special(PointType type) const {
    std::vector<KeptPoint> found;
    for (const KeptPoint& p : sink.points)
      if (p.special.type == type) found.push_back(p);
    return found;
  }
};

RunSettings settings_of(const HybridSystem& system, const std::vector<int>& free, Curve curve,
                        const std::vector<int>& monitor) {
  RunSettings settings;
  settings.dimension = system.dimension();
  settings.problem_type = equilibrium.number;
  settings.branch_mode = curve == Curve::none ? 1 : 2;
  settings.free_parameters = free;
  settings.segments = {{0, {1, no_function, no_function}, monitor}};
  settings.max_newton = tight_newton().max_iterations;
  settings.full_newton = tight_newton().full_iterations;
  settings.tolerance_parameters = tight_newton().tolerance_parameters;
  settings.tolerance_states = tight_newton().tolerance_states;
  return settings;
}

const ProblemType& type_of(Curve curve) {
  if (curve == Curve::none) return problem_type(equilibrium.number, 1);
  const PointType followed = curve == Curve::fold ? PointType::equilibrium_fold : PointType::hopf;
  for (const ProblemType* type : problem_types_of(equilibrium.number, 2))
    if (type->begins_at(static_cast<int>(followed))) return *type;
  throw std::logic_error("no such curve");
}

template <class Problem>
Branch follow(const Eigen::VectorXd& state, const ParameterVector& par, const std::vector<int>& free, Curve curve,
              double ds, double largest, int points, const std::vector<int>& monitor = {}) {
  const HybridSystem& system = system_of<Problem>();
  const RunSettings run_settings = settings_of(system, free, curve, monitor);
  const ProblemType& type = type_of(curve);
  const OrbitShape shape = OrbitShape::point(system.dimension());
  SelectedStart selected;
  selected.start.orbit = {shape, uniform_mesh(1), state.replicate(1, 2), par};
  const BranchSetup setup = type.prepare(system, run_settings, selected);
  PathFollower& follower = *setup.follower;
  PathPoint start = follower.make_point(selected.start.orbit);
  REQUIRE(follower.start_at_fixed_parameter(start).converged());
  ContinuationSettings settings = branch_settings(shape, free.front(), ds, largest, points);
  settings.location_tolerance = 1e-10;
  settings.max_location = 20;
  settings.monitored = {monitor};
  Branch branch;
  ContinuationRun run(follower, *setup.defining, settings, setup.make_tests(), branch.sink);
  branch.summary = run.run(start);
  return branch;
}

ParameterVector values(std::initializer_list<double> list) {
  ParameterVector par{ParameterLayout()};
  std::copy(list.begin(), list.end(), par.begin());
  return par;
}

Eigen::VectorXd state(std::initializer_list<double> list) {
  Eigen::VectorXd x(static_cast<Eigen::Index>(list.size()));
  std::copy(list.begin(), list.end(), x.begin());
  return x;
}

double x_of(const KeptPoint& p, int k = 0) { return p.orbit.states(k, 0); }

Orbit equilibrium_at(const Eigen::VectorXd& x, const ParameterVector& par) {
  const OrbitShape shape = OrbitShape::point(static_cast<int>(x.size()));
  return {shape, uniform_mesh(1), x.replicate(1, 2), par};
}

}  // namespace

TEST_CASE("folds of equilibria are located, and stability changes there") {
  const Branch branch = follow<Cusp>(state({-1.3}), values({-1.0, 1.0}), {1}, Curve::none, 0.05, 0.1, 80);
  const auto folds = branch.special(PointType::equilibrium_fold);
  REQUIRE(folds.size() == 2);
  const double at = 2.0 / (3.0 * std::sqrt(3.0));
  CHECK(std::abs(folds[0].orbit.par(0) - at) < accuracy);
  CHECK(std::abs(x_of(folds[0]) + 1.0 / std::sqrt(3.0)) < 1e-8);
  CHECK(std::abs(folds[1].orbit.par(0) + at) < accuracy);
  CHECK(branch.special(PointType::equilibrium_branch_point).empty());
  CHECK(branch.sink.points.front().multipliers.stable());
  for (const KeptPoint& p : branch.sink.points)
    if (std::abs(std::abs(x_of(p)) - 1.0 / std::sqrt(3.0)) > 1e-3) {
      CHECK(p.multipliers.stable() == (std::abs(x_of(p)) > 1.0 / std::sqrt(3.0)));
      CHECK(std::abs(p.multipliers.values.front() - (1.0 - 3.0 * x_of(p) * x_of(p))) < accuracy);
    }
}

TEST_CASE("a pitchfork is a branch point of the symmetric branch") {
  const Branch branch = follow<Cusp>(state({0.0}), values({0.0, -1.0}), {2}, Curve::none, 0.05, 0.2, 20);
  const auto crossings = branch.special(PointType::equilibrium_branch_point);
  REQUIRE(crossings.size() == 1);
  CHECK(std::abs(crossings[0].orbit.par(1)) < accuracy);
  CHECK(branch.special(PointType::equilibrium_fold).empty());
}

TEST_CASE("a branch point in one row of the equations, of whatever size, is located") {
  const double size = GENERATE(1e-6, 1.0, 1e6);
  ParameterVector par = values({-0.77, size});
  const Branch branch = follow<Decoupled>(state({0.0, 0.5}), par, {1}, Curve::none, 0.05, 0.2, 20);
  const auto crossings = branch.special(PointType::equilibrium_branch_point);
  REQUIRE(crossings.size() == 1);
  CHECK(std::abs(crossings[0].orbit.par(0)) < accuracy);
  CHECK(branch.summary.lost.empty());
}

TEST_CASE("a Hopf bifurcation is located, with its frequency") {
  const double a = GENERATE(0.4, 1.0, 3.0);
  const Branch branch = follow<Brusselator>(state({a, 0.5 / a}), values({a, 0.5}), {2}, Curve::none, 0.05, 0.5, 60);
  const auto hopf = branch.special(PointType::hopf);
  REQUIRE(hopf.size() == 1);
  CHECK(std::abs(hopf[0].orbit.par(1) - 1.0 - a * a) < accuracy * (1.0 + a * a));
  CHECK(std::abs(std::abs(hopf[0].multipliers.values[0].imag()) - a) < accuracy * (1.0 + a));
  CHECK(branch.sink.points.front().multipliers.stable());
  CHECK_FALSE(branch.sink.points.back().multipliers.stable());
}

TEST_CASE("a neutral saddle is no Hopf bifurcation, and nothing is missed there") {
  const Branch branch = follow<Saddle>(state({0.0, 0.0}), values({0.1}), {1}, Curve::none, 0.1, 0.2, 12);
  CHECK(branch.special(PointType::hopf).empty());
  CHECK(branch.summary.lost.empty());
  CHECK(branch.sink.points.back().orbit.par(0) > 1.0);
}

TEST_CASE("contact with an event surface is a boundary equilibrium, beyond which it is inadmissible") {
  const Branch branch = follow<Walls>(state({0.0, 0.0}), values({0.0}), {1}, Curve::none, 0.1, 0.3, 60, {1, 2});
  const auto contacts = branch.special(PointType::user);
  REQUIRE(contacts.size() == 1);
  CHECK(contacts[0].special.kind.kind == UserPointKind::boundary_equilibrium);
  CHECK(contacts[0].special.kind.index == 1);
  CHECK(std::abs(contacts[0].orbit.par(0) - 2.0) < accuracy);
  CHECK(contacts[0].violations.empty());
  CHECK(branch.summary.reason == EndReason::special_point);  // h falls below zero there, and GRSTOP = 1

  const Branch back = follow<Walls>(state({-1.5, 2.25}), values({-1.5}), {1}, Curve::none, 0.1, 0.3, 15, {1, 2});
  const auto entry = back.special(PointType::user);
  REQUIRE(entry.size() == 1);
  CHECK(entry[0].special.kind.index == 2);
  CHECK(std::abs(entry[0].orbit.par(0) + 1.0) < accuracy);
  CHECK(back.sink.points.front().violations.size() == 1);  // h2 < 0
  CHECK(back.sink.points.back().violations.empty());
  CHECK(back.summary.reason == EndReason::max_points);
}

TEST_CASE("the curve of folds is Neil's parabola, with its cusp") {
  const double at = 2.0 / (3.0 * std::sqrt(3.0));
  const Branch branch =
      follow<Cusp>(state({-1.0 / std::sqrt(3.0)}), values({at, 1.0}), {1, 2}, Curve::fold, -0.02, 0.1, 60);
  int beyond = 0;
  for (const KeptPoint& p : branch.sink.points) {
    const double p1 = p.orbit.par(0);
    const double p2 = p.orbit.par(1);
    CHECK(std::abs(27.0 * p1 * p1 - 4.0 * p2 * p2 * p2) < accuracy * (1.0 + p2 * p2 * p2));
    CHECK(std::abs(p2 - 3.0 * x_of(p) * x_of(p)) < accuracy * (1.0 + p2));
    beyond += p1 < -0.1;
  }
  CHECK(beyond > 3);
  const auto cusps = branch.special(PointType::cusp);
  REQUIRE(cusps.size() == 1);
  CHECK(std::abs(cusps[0].orbit.par(0)) < accuracy);
  CHECK(std::abs(cusps[0].orbit.par(1)) < accuracy);
  CHECK(branch.summary.lost.empty());
}

TEST_CASE("the curve of Hopf bifurcations is B = 1 + A^2") {
  const Branch branch = follow<Brusselator>(state({1.0, 2.0}), values({1.0, 2.0}), {1, 2}, Curve::hopf, 0.05, 0.5, 40);
  CHECK(branch.sink.points.back().orbit.par(0) > 2.0);
  for (const KeptPoint& p : branch.sink.points) {
    const double a = p.orbit.par(0);
    CHECK(std::abs(p.orbit.par(1) - 1.0 - a * a) < accuracy * (1.0 + a * a));
    CHECK(std::abs(x_of(p) - a) < accuracy * (1.0 + a));
    CHECK(std::abs(p.multipliers.values[0].real()) < accuracy * (1.0 + a));
    CHECK(std::abs(std::abs(p.multipliers.values[0].imag()) - a) < accuracy * (1.0 + a));
  }
}

TEST_CASE("at a Bogdanov-Takens point a curve of folds goes on and one of Hopf bifurcations ends") {
  const Branch folds = follow<Bogdanov>(state({0.5, 0.0}), values({0.25, -1.0}), {2, 1}, Curve::fold, 0.05, 0.1, 40);
  const auto of_folds = folds.special(PointType::bogdanov_takens);
  REQUIRE(of_folds.size() == 1);
  CHECK(std::abs(of_folds[0].orbit.par(0)) < accuracy);
  CHECK(std::abs(of_folds[0].orbit.par(1)) < accuracy);
  CHECK(folds.sink.points.back().orbit.par(1) > 0.1);
  CHECK(folds.special(PointType::cusp).empty());

  const Branch hopf = follow<Bogdanov>(state({0.0, 0.0}), values({0.0, -1.0}), {2, 1}, Curve::hopf, 0.05, 0.1, 60);
  const auto end = hopf.special(PointType::bogdanov_takens);
  REQUIRE(end.size() == 1);
  CHECK(std::abs(end[0].orbit.par(0)) < accuracy);
  CHECK(std::abs(end[0].orbit.par(1)) < accuracy);
  CHECK(hopf.summary.reason == EndReason::special_point);
  for (const KeptPoint& p : hopf.sink.points) CHECK(std::abs(p.orbit.par(0)) < accuracy);
}

TEST_CASE("a zero-Hopf point lies on the curve of folds and on that of Hopf bifurcations") {
  const Branch folds =
      follow<FoldAndOscillation>(state({0.0, 0.0, 0.0}), values({0.0, -0.33}), {2, 1}, Curve::fold, 0.05, 0.1, 12);
  const auto of_folds = folds.special(PointType::zero_hopf);
  REQUIRE(of_folds.size() == 1);
  CHECK(std::abs(of_folds[0].orbit.par(1)) < accuracy);

  const Branch hopf =
      follow<FoldAndOscillation>(state({0.5, 0.0, 0.0}), values({0.25, -0.5}), {2, 1}, Curve::hopf, 0.05, 0.1, 20);
  const auto of_hopf = hopf.special(PointType::zero_hopf);
  REQUIRE(of_hopf.size() == 1);
  CHECK(std::abs(of_hopf[0].orbit.par(1)) < accuracy);
  for (const KeptPoint& p : hopf.sink.points)
    CHECK(std::abs(p.orbit.par(0) - p.orbit.par(1) * p.orbit.par(1)) < accuracy);
}

TEST_CASE("where the first Lyapunov coefficient changes sign a generalised Hopf point is located") {
  const Branch branch = follow<Bautin>(state({0.0, 0.0}), values({0.0, -0.53}), {2, 1}, Curve::hopf, 0.05, 0.2, 12);
  const auto found = branch.special(PointType::generalized_hopf);
  REQUIRE(found.size() == 1);
  CHECK(std::abs(found[0].orbit.par(1)) < accuracy);
  CHECK(branch.special(PointType::bogdanov_takens).empty());
}

TEST_CASE("the first Lyapunov coefficient is that of the formula of the plane") {
  // r' = a r^3 with 16 a = f_xxx + f_xyy + g_xxy + g_yyy + (f_xy (f_xx + f_yy) - g_xy (g_xx + g_yy) - f_xx g_xx +
  // f_yy g_yy) / omega, and l_1 = 2 a / omega for |q| = 1 (|z|^2 = r^2 / 2).
  const double omega = 2.0;
  const double third = 6.6 - 0.8 + 1.2 - 12.0;
  const double second = 0.7 * (0.6 - 0.4) + 0.4 * (1.0 + 1.8) - 0.6 * 1.0 - 0.4 * 1.8;
  const double a = (third + second / omega) / 16.0;
  const EquilibriumSystem system(system_of<PlanarHopf>(), {{1, no_function, no_function}}, {1});
  const Orbit x = equilibrium_at(state({0.0, 0.0}), values({0.0}));
  const Coefficient found = first_lyapunov_coefficient(system, x, omega);
  CHECK(std::abs(found.value - 2.0 * a / omega) < 1e-13);
  CHECK(found.uncertainty < 1e-12);
}

TEST_CASE("pairs of eigenvalues: the nearest to a sum of zero, and the sign of all sums") {
  using List = std::vector<std::complex<double>>;
  CHECK(hopf_pairs(List{-1.0}).sign == 1);
  CHECK(hopf_pairs(List{-1.0, -3.0}).sign == -1);
  const HopfPairs oscillation = hopf_pairs(List{{0.1, 2.0}, {0.1, -2.0}, -1.0});
  CHECK(oscillation.nearest.is_oscillation());
  CHECK(oscillation.sign == 1);
  CHECK(oscillation.nearest.distance == Approx(0.2 / (2.0 * std::hypot(0.1, 2.0))));
  const HopfPairs saddle = hopf_pairs(List{1.001, -1.0, {-3.0, 1.0}, {-3.0, -1.0}});
  CHECK_FALSE(saddle.nearest.is_oscillation());
  CHECK(hopf_pairs(List{0.0, 0.0}).nearest.distance == 0.0);
}
