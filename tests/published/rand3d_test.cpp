// The three-dimensional oscillator (5.73)-(5.75) by the real executable, as problems/rand3d/Makefile runs it: published
// states, multipliers and bifurcations, and the branch point and codimension-two points of its grazing curves against
// shooting.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "motion/orbit_flow.hpp"
#include "published/makefile_run.hpp"
#include "support/test_system.hpp"

using namespace test_support;

namespace {

/// Reference values, by shooting; v is x1' before the impact.
struct Grazing {
  const char* m;
  double mu, x2, x3, period, acceleration;
  std::complex<double> larger, smaller;
  double xi_1, xi_2;
  std::array<double, 3> coefficient;  ///< B of the discontinuity map's B sqrt(-h_D)
};
const Grazing at_028{"028",
                     -0.798146332928,
                     0.274740619469,
                     0.624223368742,
                     6.725184221523,
                     0.600629246036,
                     0.539641978337,
                     0.0239214365814,
                     -0.0230671242,
                     -0.0129997873,
                     {0.0, 0.3960905933, 0.4962631248}};
const Grazing at_039{"039",
                     -0.827105485379,
                     -0.0722726568477,
                     0.302619782935,
                     8.063881592814,
                     0.780543653594,
                     0.191866575221,
                     0.0239300510589,
                     0.0274746760,
                     0.0059289424,
                     {0.0, 0.2153721072, 0.2603925509}};

struct Impacting {
  double mu, v;
  std::complex<double> larger, smaller;
};

/// x1' at the end of the orbit.
double impact_velocity(const SolutionEntry& solution) {
  const auto& x = solution.states.back();
  return (solution.parameter(2) - x[2]) * x[0] - x[1];
}

void check_multipliers(const DiagnosticPoint& point, std::complex<double> larger, std::complex<double> smaller,
                       double tolerance) {
  REQUIRE(point.multipliers.size() == 3);
  CHECK(distance_to(point.multipliers, larger) < tolerance);
  CHECK(distance_to(point.multipliers, smaller) < tolerance);
  CHECK(distance_to(point.multipliers, 0.0) < tolerance);
}

void check_contact(const SolutionEntry& solution, const Grazing& expected) {
  CHECK(std::abs(solution.parameter(1) - expected.mu) < 1e-9);
  CHECK(std::abs(solution.parameter(61) - expected.period) < 1e-9);
  for (const auto& x : {solution.states.front(), solution.states.back()}) {
    CHECK(std::abs(x[0] - expected.mu) < 1e-9);
    CHECK(std::abs(x[1] - expected.x2) < 1e-9);
    CHECK(std::abs(x[2] - expected.x3) < 1e-9);
  }
}

/// B = -sqrt(2 / a*) beta, beta = (Id - f h_Px / a*) g_Dx f, in the contact state found.
void check_coefficient(const SolutionEntry& solution, const Grazing& expected) {
  const auto& x = solution.states.front();
  const double m = solution.parameter(2), r = solution.parameter(3), velocity = (m - x[2]) * x[0] - x[1];
  const std::array<double, 3> f{velocity, m * x[1] + x[0], -x[2] + x[1] * x[1] + x[0] * x[0] * x[2]};
  const std::array<double, 3> section{m - x[2], -1.0, -x[0]};  // h_Px
  const auto along = [&](const std::array<double, 3>& v) {
    return section[0] * v[0] + section[1] * v[1] + section[2] * v[2];
  };
  std::array<double, 3> beta{f[0], f[1] + (1.0 + r) * along(f), f[2]};  // g_Dx f
  const double a = along(f), share = along(beta) / a;
  for (std::size_t i = 0; i < 3; ++i)
    check_near(-std::sqrt(2.0 / a) * (beta[i] - share * f[i]), expected.coefficient[i]);
}

void check_unfolding(const DiagnosticPoint& point, const Grazing& expected) {
  CHECK(std::abs(point.tests.at("a*") - expected.acceleration) < 1e-9);
  CHECK(std::abs(point.tests.at("xi_1") - expected.xi_1) < 1e-9);
  CHECK(std::abs(point.tests.at("xi_2") - expected.xi_2) < 1e-9);
  check_multipliers(point, expected.larger, expected.smaller, 1e-9);
}

/// The labelled point of that type near mu, v.
void check_impacting(const MakefileRun& chain, const std::string& name, const std::string& type,
                     const Impacting& expected) {
  INFO(type << " at mu = " << expected.mu << ", v = " << expected.v);
  const auto solutions = chain.solutions(name);
  int found = 0;
  for (const DiagnosticPoint& point : of_type(chain.diagnostics(name), type)) {
    const SolutionEntry& solution = with_label(solutions, point.label);
    if (std::abs(impact_velocity(solution) - expected.v) > 1e-3) continue;
    ++found;
    CHECK(std::abs(solution.parameter(1) - expected.mu) < 1e-9);
    CHECK(std::abs(impact_velocity(solution) - expected.v) < 1e-9);
    check_multipliers(point, expected.larger, expected.smaller, 1e-9);
  }
  CHECK(found == 1);
}

/// (5.73), (5.74) once more, with half of a symmetric orbit: to the maximum of x1 (event 3), then mirrored (jump 3).
/// PAR: mu, m, r.
struct MirroredOscillator {
  static constexpr int dimension = 3, parameters = 3, fields = 1, events = 3, jumps = 3;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = p[1] * x[0] - x[1] - x[0] * x[2];
    f[1] = p[1] * x[1] + x[0];
    f[2] = -x[2] + x[1] * x[1] + x[0] * x[0] * x[2];
  }
  template <class T>
  T event(int j, const T* x, const T* p) const {
    const T velocity = p[1] * x[0] - x[1] - x[0] * x[2];
    if (j == 1) return x[0] - p[0];
    return j == 2 ? -velocity : velocity;
  }
  template <class T>
  void jump(int k, const T* x, const T* p, T* g) const {
    const double sign = k == 3 ? -1.0 : 1.0;
    g[0] = sign * x[0], g[1] = sign * x[1], g[2] = x[2];
    if (k == 1) g[1] = (p[1] - x[2]) * x[0] - p[2] * (x[1] - x[0] * (p[1] - x[2]));
  }
};

/// From the start of a solution, put on the section x1' = 0.
tchat::PeriodicOrbit shoot_from(const SolutionEntry& solution, const tchat::IndexVector& index, double m) {
  const auto& x = solution.states.front();
  tchat::ShootingOptions options;
  options.flow.relative_tolerance = 1e-13;
  options.flow.absolute_tolerance = 1e-14;
  const tchat::PeriodicOrbit orbit =
      tchat::shoot(tchat::test::system_of<MirroredOscillator>(), {index},
                   Eigen::Vector3d(x[0], (m - x[2]) * x[0], x[2]), Eigen::Vector3d(-2.0, m, 0.8), options);
  CAPTURE(m);
  INFO(orbit.message);
  REQUIRE(orbit.converged);
  return orbit;
}

/// xi_1 of the smooth orbit cut at its minimum: -(first row of M) beta, beta = (Id - f h_Px / a*) g_Dx f.
double xi_1(const tchat::PeriodicOrbit& orbit, double m) {
  const tchat::HybridSystem& system = tchat::test::system_of<MirroredOscillator>();
  const Eigen::VectorXd par = tchat::full_parameters(system, Eigen::Vector3d(-2.0, m, 0.8));
  Eigen::Vector3d f, g;
  Eigen::RowVector3d section;
  Eigen::Matrix3d impact;
  double h = 0.0;
  using tchat::FunctionKind;
  system.value(FunctionKind::field, 1, orbit.start.data(), par.data(), f.data());
  system.first(FunctionKind::event, 2, orbit.start.data(), par.data(), {}, &h, section.data(), nullptr);
  system.first(FunctionKind::jump, 1, orbit.start.data(), par.data(), {}, g.data(), impact.data(), nullptr);
  Eigen::Vector3d beta = impact * f;
  beta -= f * (section.dot(beta) / section.dot(f));
  return -orbit.map.derivative.row(0).dot(beta);
}

/// Zero of a smooth function near `guess`, by secants.
template <class Function>
double root(const Function& function, double guess) {
  double a = guess - 1e-4, b = guess + 1e-4, fa = function(a), fb = function(b);
  for (int i = 0; i < 12 && std::abs(b - a) > 1e-13; ++i) {
    const double c = b - fb * (b - a) / (fb - fa);
    a = b, fa = fb, b = c, fb = function(c);
  }
  return b;
}

const tchat::IndexVector nonimpacting{1, 2, 2}, half_orbit{1, 3, 3};

/// The labels of that curve where xi_1 vanishes.
std::vector<SolutionEntry> zeros_of_xi_1(const MakefileRun& chain, const std::string& name) {
  std::vector<SolutionEntry> zeros;
  const auto solutions = chain.solutions(name);
  for (const DiagnosticPoint& point : of_type(chain.diagnostics(name), "XI"))
    if (std::any_of(point.notes.begin(), point.notes.end(),
                    [](const std::string& note) { return note.find("xi_1 = 0") != std::string::npos; }))
      zeros.push_back(with_label(solutions, point.label));
  return zeros;
}

/// Both nonimpacting orbits graze at the published states.
void check_nonimpacting(const MakefileRun& chain) {
  for (const Grazing& expected : {at_028, at_039}) {
    INFO("m = " << expected.m);
    const std::string name = std::string("grazing_") + expected.m;
    const SolutionEntry contact = chain.only(name, "GR");
    CHECK(first_iterations(chain.read("d." + name)) <= 4);  // of the start that simulation found
    check_contact(contact, expected);
    check_coefficient(contact, expected);
    // The grazing curve's first point tells a*, xi_n and the smooth multipliers.
    chain.run("-c " + chain.constants("grazing_curve") + " -s " + name + " -o curve NMX=1");
    check_unfolding(chain.diagnostics("curve").front(), expected);
  }
}

/// The grazing curve changes branch where its symmetry breaks and leads to m = 0.39.
void check_grazing_curves(const MakefileRun& chain) {
  // The multiplier +1 of the symmetric orbit is a branch point and nothing else.
  const auto symmetric = chain.diagnostics("grazing_curve");
  CHECK(of_type(symmetric, "GC").empty());
  CHECK(of_type(symmetric, "LP").empty());
  const SolutionEntry branch_point = chain.only("grazing_curve", "BP");
  // There the half map, mirrored, has the multiplier -1.
  const double m_branch = root(
      [&](double m) {
        const auto orbit = shoot_from(branch_point, half_orbit, m);
        double nearest = 10.0;
        for (const auto& mu : orbit.map.multipliers)
          if (std::abs(mu + 1.0) < std::abs(nearest)) nearest = mu.real() + 1.0;
        return nearest;
      },
      branch_point.parameter(2));
  CHECK(m_branch == Approx(0.31503).margin(1e-5));
  CHECK(std::abs(branch_point.parameter(2) - m_branch) < 1e-7);

  // mu rises at first on the side that DS > 0 picks and falls on the other one; both leave the symmetric curve.
  const auto column = [&](const std::string& name, const std::string& of) {
    std::vector<double> values;
    for (const PointSection& section : chain.points(name))
      for (const PointRow& row : section.rows) values.push_back(row.values[section.column(of)]);
    return values;
  };
  const auto rising = column("asymmetric_grazing_curve", "mu");
  const auto falling = column("mirrored_grazing_curve", "mu");
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(rising[i] > (i > 0 ? rising[i - 1] : branch_point.parameter(1)));
    CHECK(falling[i] < (i > 0 ? falling[i - 1] : branch_point.parameter(1)));
  }
  for (const std::string name : {"asymmetric_grazing_curve", "mirrored_grazing_curve"}) {
    CHECK(column(name, "m").front() < m_branch + 1e-3);
    CHECK(column(name, "m").back() > 0.39);
    for (const DiagnosticPoint& point : chain.diagnostics(name))
      CHECK(distance_to(point.multipliers, 1.0) > 1e-6);  // no way back to the branch point
  }

  // m = 0.39 is the published orbit.
  const auto solutions = chain.solutions("asymmetric_grazing_curve");
  const auto user_values = of_type(chain.diagnostics("asymmetric_grazing_curve"), "UZ");
  REQUIRE(user_values.size() == 2);
  const SolutionEntry& at_end = with_label(solutions, user_values[1].label);
  CHECK(std::abs(at_end.parameter(2) - 0.39) < 1e-9);
  check_contact(at_end, at_039);
  check_unfolding(user_values[1], at_039);

  // One point between where all xi_n vanish: there beta's image is in the wall's tangent plane.
  const auto zeros = zeros_of_xi_1(chain, "asymmetric_grazing_curve");
  REQUIRE(zeros.size() == 1);
  const double m_zero = root([&](double m) { return xi_1(shoot_from(zeros[0], nonimpacting, m), m); }, 0.3805);
  const auto orbit = shoot_from(zeros[0], nonimpacting, m_zero);
  CHECK(std::abs(zeros[0].parameter(2) - m_zero) < 1e-9);
  CHECK(std::abs(zeros[0].parameter(1) - orbit.start(0)) < 1e-9);
  CHECK(std::abs(zeros[0].parameter(61) - orbit.map.period) < 1e-9);
  CHECK_FALSE(zeros_of_xi_1(chain, "mirrored_grazing_curve").empty());
  CHECK_FALSE(zeros_of_xi_1(chain, "grazing_curve").empty());
  const auto labelled = of_type(chain.diagnostics("asymmetric_grazing_curve"), "XI");
  const auto all = std::find_if(labelled.begin(), labelled.end(),
                                [&](const DiagnosticPoint& p) { return p.label == zeros[0].label; });
  for (int n = 1; n <= 5; ++n) CHECK(std::abs(all->tests.at("xi_" + std::to_string(n))) < 1e-9);
}

/// Impacting orbits from grazing, their fold and period doubling (Fig. 5.17).
void check_impacting_orbits(const MakefileRun& chain) {
  check_impacting(chain, "impacting_028", "LP", {-0.7999350433, -0.0423746328, 1.0, 0.0086577939});
  check_impacting(chain, "impacting_028", "UZ", {-0.799, -0.0116208376, 2.4782211189, 0.0033750689});
  check_impacting(chain, "impacting_028", "UZ", {-0.799, -0.0740432259, 0.7238408760, 0.0124287087});
  check_impacting(chain, "impacting_039", "PD", {-0.8255929488, -0.0240827939, -1.0, -0.0030555370});
  check_impacting(chain, "impacting_039", "UZ", {-0.825, -0.0309474007, -0.7389207535, -0.0041874659});
  for (const std::string name : {"impacting_028", "impacting_039"}) {
    INFO(name);
    // Unstable from grazing to the bifurcation, stable after it; the user value in the p-file is the impact velocity.
    const bool fold = name == "impacting_028";
    const double bifurcation = fold ? -0.0423746328 : -0.0240827939;
    for (const PointSection& section : chain.points(name))
      for (const PointRow& row : section.rows) {
        const double v = row.values[section.column("velocity")];
        CHECK(v < 1e-9);
        if (std::abs(v - bifurcation) > 1e-6) CHECK((row.point < 0) == (v < bifurcation));
      }
  }
}

/// Fold and period-doubling curves end where the grazing curves have xi_n = 0.
void check_two_parameter_curves(const MakefileRun& chain) {
  const auto ends_at = [&](const std::string& name, const SolutionEntry& zero) {
    INFO(name);
    const SolutionEntry end = chain.only(name, "GR");
    CHECK(std::abs(end.parameter(2) - zero.parameter(2)) < 1e-7);
    CHECK(std::abs(end.parameter(1) - zero.parameter(1)) < 1e-7);
    CHECK(std::abs(impact_velocity(end)) < 1e-8);
    // Of the multipliers, which are 0/0 there, only what continues those of the point before is printed.
    const std::vector<DiagnosticPoint> points = chain.diagnostics(name);
    const auto at =
        std::find_if(points.begin(), points.end(), [&](const DiagnosticPoint& p) { return p.label == end.label; });
    REQUIRE(at != points.begin());
    CHECK(at->multipliers.size() < 3);
    for (const auto& mu : at->multipliers) CHECK(distance_to((at - 1)->multipliers, mu) < 1e-2);
  };
  const auto zero = zeros_of_xi_1(chain, "asymmetric_grazing_curve").at(0);
  ends_at("fold_curve_037", zero);
  ends_at("period_doubling_curve", zero);
  // The folds from m = 0.28 lead to the curve of the other orbit of the pair.
  const auto mirrored = zeros_of_xi_1(chain, "mirrored_grazing_curve").at(0);
  const double m = root([&](double at) { return xi_1(shoot_from(mirrored, nonimpacting, at), at); }, 0.3243);
  CHECK(std::abs(mirrored.parameter(2) - m) < 1e-9);
  ends_at("fold_curve_028", mirrored);
}

/// A place on one of the two sides (branch) of a curve; a change of sign lies between two of them.
struct Place {
  int branch;
  double from, to;
};

/// Where xi_n changes sign from one point of a run to the next, in m.
std::vector<Place> sign_changes(const MakefileRun& chain, const std::string& name, int n) {
  std::vector<PointRow> rows;
  std::size_t m = 0;
  for (const PointSection& section : chain.points(name)) {
    rows.insert(rows.end(), section.rows.begin(), section.rows.end());
    m = section.column("m");
  }
  const std::vector<DiagnosticPoint> points = chain.diagnostics(name);
  REQUIRE(points.size() == rows.size());
  std::vector<Place> changes;
  std::size_t before = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto value = [&](std::size_t at) { return points[at].tests.at("xi_" + std::to_string(n)); };
    if (value(i) == 0.0) continue;  // at its label
    const bool same_side = points[before].branch == points[i].branch;
    if (i > 0 && same_side && value(before) * value(i) < 0.0)
      changes.push_back({points[i].branch, rows[before].values[m], rows[i].values[m]});
    before = i;
  }
  return changes;
}

/// The labels of xi_n = 0.
std::vector<Place> labelled_zeros(const MakefileRun& chain, const std::string& name, int n) {
  std::vector<Place> zeros;
  const std::vector<SolutionEntry> solutions = chain.solutions(name);
  for (const DiagnosticPoint& point : chain.diagnostics(name))
    for (const std::string& note : point.notes)
      if (note.find("xi_" + std::to_string(n) + " = 0") != std::string::npos) {
        const double m = with_label(solutions, point.label).parameter(2);
        zeros.push_back({point.branch, m, m});
      }
  return zeros;
}

/// No zero of xi_1 .. xi_10 on the asymmetric curves is lost on steps that pass several: as many, at the same places,
/// as a walk in small steps sees changes of sign.
void check_every_zero(const MakefileRun& chain) {
  constexpr int most = 10;
  constexpr double digits = 2e-5;  // of the p-file
  const std::string curve = "-c " + chain.constants("asymmetric_grazing_curve") +
                            " -s grazing_curve --both GCIPSI=[1,2,3,4,5,6,7,8,9,10] -o ";
  chain.run(curve + "fine DS=0.001 DSMAX=0.001 NMX=5000");
  for (const char* step : {"0.02", "0.1"}) {
    INFO("DSMAX = " << step);
    chain.run(curve + "coarse DSMAX=" + step);
    std::size_t all = 0;
    for (int n = 1; n <= most; ++n) {
      INFO("xi_" << n);
      const std::vector<Place> changes = sign_changes(chain, "fine", n);
      const std::vector<Place> zeros = labelled_zeros(chain, "coarse", n);
      REQUIRE(zeros.size() == changes.size());
      for (std::size_t i = 0; i < zeros.size(); ++i) {
        CHECK(zeros[i].branch == changes[i].branch);
        CHECK(zeros[i].from > std::min(changes[i].from, changes[i].to) - digits);
        CHECK(zeros[i].from < std::max(changes[i].from, changes[i].to) + digits);
      }
      all += zeros.size();
    }
    CHECK(all == 78);
  }
}

}  // namespace

TEST_CASE("make -j2 in problems/rand3d: every published value") {
  const MakefileRun chain("rand3d");
  chain.check_verified();
  chain.check_repeatable(MakefileRun::Chain::is_long);
  check_nonimpacting(chain);
  check_grazing_curves(chain);
  check_impacting_orbits(chain);
  check_two_parameter_curves(chain);
  check_every_zero(chain);
}
