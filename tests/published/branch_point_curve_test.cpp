// Curves of branch points: pitchforks and transcritical points in closed form, the symmetry breaking of an impact
// oscillator against its closed form; and what is refused, with its cure.
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "published/chain.hpp"
#include "published/newton.hpp"

using namespace test_support;

namespace {

const char* const circle_constants = R"(# The circle in p1.
NDIM = 3, IPS = 180, IRS = 0
ICP = [p1, 61], THL = {61: 0}
NTST = 15, NCOL = 5, IAD = 3, ISP = 2
NMX = 200, NPR = 0, RL0 = -1, RL1 = 1
EPSL = 1e-10, EPSU = 1e-10, EPSS = 1e-9
DS = 0.03, DSMAX = 0.1
GCHIND = [1], GCGIND = [1], GCSEGTYP = [0]
GCHGRZIND = [[]]
)";

void run(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat("run " + arguments);
  INFO(arguments << '\n' << outcome.text());
  REQUIRE(outcome.status == 0);
}

/// The message has all these words.
void check_refused(const Workspace& workspace, const std::string& arguments, const std::vector<std::string>& words) {
  const Outcome outcome = workspace.tchat("run " + arguments);
  INFO(arguments << '\n' << outcome.text());
  CHECK(outcome.status != 0);
  for (const std::string& word : words) {
    INFO(word);
    CHECK(outcome.text().find(word) != std::string::npos);
  }
}

/// The orbits of z = 0 in p1 from `p1` on, to their branch point: files `known`.
void enter_crossings(const Workspace& workspace, int field, double p1, double p2, double p3) {
  std::filesystem::copy_file(CROSSINGS_LIBRARY, workspace.file("crossings.so"));
  workspace.write("gc.crossings", std::string(circle_constants) + "GCFIND = [" + std::to_string(field) + "]\n");
  std::string data = "# PAR(1) = " + std::to_string(p1) + "\n# PAR(2) = " + std::to_string(p2) +
                     "\n# PAR(3) = " + std::to_string(p3) + "\n";
  for (int k = 0; k <= 64; ++k) {
    const double t = 2.0 * M_PI * k / 64;
    char row[120];
    std::snprintf(row, sizeof row, "%.15f %.15f %.15f 0.5\n", t, -std::cos(t), -std::sin(t));
    data += row;
  }
  workspace.write("crossings.dat", data);
  run(workspace, "crossings -o known");
}

std::vector<double> column(const Workspace& workspace, const std::string& file, const std::string& name) {
  std::vector<double> values;
  for (const PointSection& section : workspace.points(file))
    for (const PointRow& row : section.rows) values.push_back(row.values[section.column(name)]);
  return values;
}

/// Symmetric orbits of two_sided.cpp with one impact at either wall, at their loss of symmetry. From the wall at -1
/// with velocity w at time s it goes to the other wall at s + pi / omega with velocity v, w = r v; the map H from (s,
/// w) to (time, r v) at the other wall, turned round, has the orbit as its fixed point, and the map over a whole period
/// is H twice. Symmetry is lost where H has the multiplier -1.
struct SymmetricImpacts {
  double zeta, r;

  /// z = (s, w, F, omega). Zero where q = 1 and w = r v half a period later, and det(H' + Id) = 0.
  Eigen::Vector3d defect(const Eigen::VectorXd& z) const {
    const double s = z(0), w = z(1), force = z(2), omega = z(3);
    // The stationary motion Re(a e^(i omega t)).
    const std::complex<double> a = force / std::complex<double>(1.0 - omega * omega, 2.0 * zeta * omega);
    const auto stationary = [&](double t, int order) {
      return (a * std::pow(std::complex<double>(0.0, omega), order) * std::polar(1.0, omega * t)).real();
    };
    // The deviation from it goes with the free flow E(t) from (dq, dv).
    const Eigen::Vector2d deviation(-1.0 - stationary(s, 0), w - stationary(s, 1));
    const double time = M_PI / omega, end = s + time;
    const Eigen::Matrix2d flow = free(time);
    const Eigen::Vector2d moved = flow * deviation;
    const double q = stationary(end, 0) + moved(0), v = stationary(end, 1) + moved(1);
    const double acceleration = stationary(end, 2) - moved(0) - 2.0 * zeta * moved(1);
    // Changes of q, v at the fixed time `end` by s and w, then of the time of the impact and of the velocity there.
    const Eigen::Vector2d rate(deviation(1), -deviation(0) - 2.0 * zeta * deviation(1));
    const Eigen::Vector2d by_start = flow * (Eigen::Vector2d(-stationary(s, 1), -stationary(s, 2)) - rate);
    const Eigen::Vector2d by_velocity = flow.col(1);
    Eigen::Matrix2d derivative;
    derivative.row(0) << -by_start(0) / v, -by_velocity(0) / v;
    derivative.row(1) << r * (by_start(1) + acceleration * derivative(0, 0)),
        r * (by_velocity(1) + acceleration * derivative(0, 1));
    return Eigen::Vector3d(q - 1.0, w - r * v, (derivative + Eigen::Matrix2d::Identity()).determinant());
  }

  Eigen::Matrix2d free(double time) const {
    const double frequency = std::sqrt(1.0 - zeta * zeta);
    const double c = std::cos(frequency * time), k = std::sin(frequency * time) / frequency;
    Eigen::Matrix2d flow;
    flow << c + zeta * k, k, -k, c - zeta * k;
    return std::exp(-zeta * time) * flow;
  }
};

}  // namespace

TEST_CASE("pitchforks of a symmetric system: a circle of branch points, turning in either parameter, once round") {
  const Workspace workspace;
  enter_crossings(workspace, 1, 0.1, 0.2, 0.0);
  CHECK(std::abs(only(workspace, "known", "BP").parameter(1) - std::sqrt(0.21)) < 1e-7);
  for (const char* step : {"0.01", "0.05", "-0.05"}) {
    INFO("DSMAX = " << step);
    run(workspace,
        std::string("crossings -s known -o curve IRS=BP1 ISW=2 ICP=[p1,p2] NMX=900 NPR=10 --both DS=") + step);
    const auto sections = workspace.points("curve");
    CHECK(sections.size() == 1);  // closed: the other direction is the same
    const auto p1 = column(workspace, "curve", "p1"), p2 = column(workspace, "curve", "p2");
    for (std::size_t k = 0; k < p1.size(); ++k) CHECK(std::hypot(p1[k], p2[k]) == Approx(0.5).epsilon(1e-9));
    CHECK(*std::min_element(p1.begin(), p1.end()) < -0.49);
    CHECK(*std::min_element(p2.begin(), p2.end()) < -0.49);
    CHECK(*std::max_element(p2.begin(), p2.end()) > 0.49);
    CHECK(p1.back() == Approx(p1.front()).epsilon(1e-9));
    CHECK(sections.front().rows.back().type == 69);
  }
}

TEST_CASE("transcritical points that persist: their parabola") {
  const Workspace workspace;
  enter_crossings(workspace, 3, -0.2, 0.3, 0.0);
  run(workspace, "crossings -s known -o curve IRS=BP1 ISW=2 ICP=[p1,p2] NMX=40 --both");
  const auto p1 = column(workspace, "curve", "p1"), p2 = column(workspace, "curve", "p2");
  CHECK(p1.size() > 30);
  for (std::size_t k = 0; k < p1.size(); ++k) CHECK(p1[k] == Approx(p2[k] * p2[k]).margin(1e-9));
  CHECK(*std::min_element(p2.begin(), p2.end()) < -0.3);  // through p2 = 0, where p1 turns
}

TEST_CASE("generic branch points in three parameters in closed form, and what has no such curve") {
  const Workspace workspace;
  enter_crossings(workspace, 2, -0.2, 0.3, 0.3);
  run(workspace, "crossings -s known -o curve IRS=BP1 ISW=3 ICP=[p1,p2,p3] NMX=40 NPR=10 --both");
  const auto p1 = column(workspace, "curve", "p1"), p2 = column(workspace, "curve", "p2"),
             p3 = column(workspace, "curve", "p3");
  CHECK(p1.size() > 30);
  for (std::size_t k = 0; k < p1.size(); ++k) {
    CHECK(p1[k] == Approx(p2[k] * p2[k]).margin(1e-9));
    CHECK(p3[k] == Approx(p2[k]).margin(1e-9));
  }
  CHECK(*std::min_element(p2.begin(), p2.end()) < -0.3);

  check_refused(workspace, "crossings -s known -o refused IRS=BP1 ISW=2 ICP=[p1,p2]",
                {"label 2 is one at this value of p2 alone", "ISW = 3 and ICP = [p1, p2, ...]"});
  check_refused(workspace, "crossings -s known -o refused IRS=BP1 ISW=3 ICP=[p1,p2]",
                {"ICP", "found 2 parameters that are not durations", "at least 3 with IPS = 180, ISW = 3"});
  check_refused(workspace, "crossings -s known -o refused IRS=EP1 ISW=3 ICP=[p1,p2,p3]",
                {"ISW = 3 follows the curve of a label", "generic branch points in three parameters (BP)",
                 "a label of type EP", "IRS=TR1"});
  check_refused(workspace, "crossings -s known -o refused IRS=EP1 ISW=2 ICP=[p1,p2]",
                {"ISW = 2 follows the curve of a label", "(BP)", "a label of type EP", "IRS=LP1"});
}

TEST_CASE("ISW = 3 is refused where branch points persist") {
  const Workspace workspace;
  enter_crossings(workspace, 1, 0.1, 0.2, 0.0);
  check_refused(workspace, "crossings -s known -o refused IRS=BP1 ISW=3 ICP=[p1,p2,p3]",
                {"persists when p2 or p3 changes", "use ISW = 2 with ICP = [p1, p2]"});
}

TEST_CASE("two walls: the loss of symmetry in two parameters against its closed form, and restarts from every label") {
  const Workspace workspace;
  std::filesystem::copy_file(TWO_SIDED_LIBRARY, workspace.file("two_sided.so"));
  REQUIRE(workspace.tchat("simulate two_sided --dat two_sided").status == 0);
  const std::string accuracy = " NTST=30 NCOL=5 EPSL=1e-10 EPSU=1e-10 EPSS=1e-9";
  run(workspace, "two_sided -d two_sided -o symmetric ICP=[F] DS=0.02 RL1=3.6" + accuracy);
  run(workspace,
      "two_sided -c r.symmetric -s symmetric -o curve IRS=BP1 ISW=2 ICP=[F,omega] --both RL0=1 RL1=9 DS=0.05 DSMAX=0.3 "
      "NMX=60 NPR=15");
  int seen = 0;
  for (const PointSection& section : workspace.points("curve")) {
    const std::size_t force_column = section.column("F"), omega_column = section.column("omega");
    for (std::size_t k = 0; k < section.rows.size(); ++k) {
      const auto& row = section.rows[k].values;
      const auto& other = section.rows[k == 0 ? 1 : k - 1].values;
      const double omega = row[omega_column], force = row[force_column];
      INFO("omega = " << omega << ", F = " << force);
      // Phase and velocity of the orbit by the closed form itself.
      Eigen::Vector4d start;
      double best = 1e300;
      for (int phase = 0; phase < 200; ++phase)
        for (double w = 0.3; w < 5.0; w += 0.1) {
          const Eigen::Vector4d z(2.0 * M_PI / omega * phase / 200, w, force, omega);
          if (const double size = SymmetricImpacts{0.05, 0.8}.defect(z).norm(); size < best) best = size, start = z;
        }
      // The point of the exact curve across its direction.
      const Eigen::Vector2d along(row[force_column] - other[force_column], omega - other[omega_column]);
      const Eigen::VectorXd exact = newton(start, 1e-10, [&](const Eigen::VectorXd& z) -> Eigen::VectorXd {
        Eigen::Vector4d defect;
        defect << SymmetricImpacts{0.05, 0.8}.defect(z), along.normalized().dot(z.tail<2>() - start.tail<2>());
        return defect;
      });
      CHECK((exact - start).tail<2>().norm() < 1e-9 * force);
      CHECK(row[section.column("PERIOD")] == Approx(2.0 * M_PI / omega).epsilon(1e-9));
      ++seen;
    }
  }
  CHECK(seen > 60);
  for (const DiagnosticPoint& point : read_diagnostics(workspace.read("d.curve")))
    CHECK(distance_to(point.multipliers, 1.0) < 1e-7);
  for (const SolutionEntry& stored : workspace.solutions("curve")) {
    INFO("label " << stored.label);
    run(workspace, "two_sided -c r.curve -s curve -o again NMX=1 IRS=" + std::to_string(stored.label));
    CHECK(first_iterations(workspace.read("d.again")) <= 1);
    CHECK(difference(stored, workspace.solutions("again").front()) < 2e-10);
  }
}
