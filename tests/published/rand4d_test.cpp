// The forced oscillator (5.76)-(5.78) by the real executable, as problems/rand4d/Makefile runs it: published state,
// multipliers and fold of the orbit with one impact every two forcing periods, and where its branch ends, by shooting.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "published/chain.hpp"
#include "simulation/orbit_flow.hpp"
#include "support/test_system.hpp"

using namespace test_support;

namespace {

constexpr double omega = 1.9;

/// A folder with rand4d's plugin and constants.
class Pipeline {
 public:
  Pipeline() {
    namespace fs = std::filesystem;
    fs::copy_file(RAND4D_LIBRARY, workspace.file("rand4d.so"));
    for (const auto& entry : fs::directory_iterator(CONSTANTS "/rand4d"))
      fs::copy_file(entry.path(), workspace.file(entry.path().filename().string()),
                    fs::copy_options::overwrite_existing);
  }
  void run(const std::string& arguments) const {
    const Outcome outcome = workspace.tchat("run rand4d " + arguments);
    INFO(outcome.text());
    REQUIRE(outcome.status == 0);
  }
  std::vector<DiagnosticPoint> diagnostics(const std::string& name) const {
    return read_diagnostics(workspace.read("d." + name));
  }

  Workspace workspace;
};

/// x1' at the end of the orbit.
double impact_velocity(const SolutionEntry& solution) {
  const auto& x = solution.states.back();
  return (solution.parameter(4) - x[2]) * x[0] - x[1];
}

/// (4.7) without the wall: (x1, x2, x3) and an angle x4, whose jump 2 takes off 2 pi. PAR: A.
struct ForcedOscillator {
  static constexpr int dimension = 4, parameters = 1, fields = 1, events = 1, jumps = 2;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = 0.28 * x[0] - x[1] - x[0] * x[2];
    f[1] = 0.28 * x[1] + x[0] + p[0] * cos(x[3]);
    f[2] = -x[2] + x[1] * x[1] + x[0] * x[0] * x[2];
    f[3] = T(omega);
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[1] + x[0] * x[2] - 0.28 * x[0];
  }
  template <class T>
  void jump(int k, const T* x, const T*, T* g) const {
    for (int i = 0; i < 4; ++i) g[i] = x[i];
    if (k == 2) g[3] = x[3] - 2.0 * M_PI;
  }
};

/// The smooth orbit of one forcing period, from its minimum of x1.
tchat::PeriodicOrbit smooth_orbit(const std::vector<double>& x, double amplitude) {
  const Eigen::Vector4d guess(x[0], x[1], x[2], std::atan2(x[3], x[4]));
  const auto orbit = tchat::shoot(tchat::test::system_of<ForcedOscillator>(), {{1, 1, 2}}, guess,
                                  Eigen::VectorXd::Constant(1, amplitude));
  INFO(orbit.message);
  REQUIRE(orbit.converged);
  return orbit;
}

}  // namespace

TEST_CASE("rand4d: one impact every two forcing periods, state, multipliers and fold (Fig. 5.18)") {
  const Pipeline pipeline;
  pipeline.run("-c impacting -d impacting -o impacting");
  const auto points = pipeline.diagnostics("impacting");
  const auto solutions = pipeline.workspace.solutions("impacting");

  const SolutionEntry& first = with_label(solutions, 1);
  CHECK(first.parameter(1) == -0.4938);
  CHECK(std::abs(first.parameter(61) - 4.0 * M_PI / omega) < 1e-9);
  const auto& x = first.states.back();
  const double expected[] = {-0.4938, 1.35553833, 1.30754970, std::sin(2.08040371), std::cos(2.08040371)};
  for (std::size_t k = 0; k < 5; ++k) CHECK(std::abs(x[k] - expected[k]) < 1e-8);
  CHECK(points.front().point < 0);
  for (const double mu : {-0.28719637, -0.08216043, 0.00267411})
    CHECK(distance_to(points.front().multipliers, mu) < 2e-8);

  const SolutionEntry fold = only(pipeline.workspace, "impacting", "LP");
  CHECK(std::abs(fold.parameter(1) + 0.62259796203) < 1e-9);
  CHECK(std::abs(impact_velocity(fold) + 0.2154701) < 1e-6);
  CHECK(std::abs(fold.parameter(61) - 4.0 * M_PI / omega) < 1e-9);
  for (const double mu : {1.0, 0.67853149, 0.00225252})
    CHECK(distance_to(with_label(points, fold.label).multipliers, mu) < 1e-6);
  // Stable before the fold, unstable after it.
  for (const PointSection& section : pipeline.workspace.points("impacting"))
    for (const PointRow& row : section.rows) {
      const double v = row.values[section.column("velocity")];
      if (std::abs(v + 0.2154701) > 1e-4) CHECK((row.point < 0) == (v < -0.2154701));
    }
}

TEST_CASE("rand4d: the branch ends where the smooth orbit of one forcing period grazes, run through twice") {
  const Pipeline pipeline;
  pipeline.run("-c torus -d nonimpacting -o torus");
  pipeline.run("-c to_grazing -s torus -o grazing");
  pipeline.run("-c impacting -d impacting -o impacting");
  const SolutionEntry contact = only(pipeline.workspace, "grazing", "GR");
  const auto smooth = smooth_orbit(contact.states.front(), 1.25);
  CHECK(std::abs(smooth.map.period - 2.0 * M_PI / omega) < 1e-12);
  CHECK(std::abs(contact.parameter(1) - smooth.start(0)) < 1e-9);

  // Its impact velocity vanishes there, and its other minimum, one forcing period later, touches the wall too.
  const SolutionEntry end = only(pipeline.workspace, "impacting", "GR");
  CHECK(std::abs(end.parameter(1) - smooth.start(0)) < 1e-7);
  CHECK(std::abs(impact_velocity(end)) < 1e-6);
  const auto points = pipeline.diagnostics("impacting");
  const std::string note = with_label(points, end.label).notes.back();
  CHECK(note.find("tau = 0.5") != std::string::npos);
  CHECK(note.find("h_x f = 0 at the end of segment 1") != std::string::npos);
  // Not at mu = -0.4940, where the torus grazes.
  for (const PointRow& row : rows_of(pipeline.workspace.points("impacting")))
    CHECK((row.type != -4 || std::abs(row.values[0] + 0.4940) > 0.01));

  // The torus is born from that orbit at A = 1.252862, where a pair of its multipliers is on the unit circle.
  const SolutionEntry birth = only(pipeline.workspace, "torus", "TR");
  const auto modulus = [&](double amplitude) {
    return std::abs(smooth_orbit(birth.states.front(), amplitude).map.multipliers(0)) - 1.0;
  };
  const double a = birth.parameter(2);
  const double slope = (modulus(a + 1e-4) - modulus(a - 1e-4)) / 2e-4;
  CHECK(slope != 0.0);
  CHECK(std::abs(modulus(a) / slope) < 1e-7);
  CHECK(a == Approx(1.2529).margin(1e-4));
}

TEST_CASE("rand4d: the doubled orbit and the fold curve") {
  const Pipeline pipeline;
  pipeline.run("-c impacting -d impacting -o impacting --both");
  const SolutionEntry doubling = only(pipeline.workspace, "impacting", "PD");
  CHECK(distance_to(with_label(pipeline.diagnostics("impacting"), doubling.label).multipliers, -1.0) < 1e-6);
  pipeline.run("-c doubled -s impacting -o doubled");
  const auto doubled = pipeline.workspace.points("doubled").front();
  CHECK(doubled.rows.front().values[0] == Approx(doubling.parameter(1)).margin(1e-4));
  for (const PointRow& row : doubled.rows)
    CHECK(row.values[doubled.column("PERIOD")] == Approx(8.0 * M_PI / omega).epsilon(1e-9));
  pipeline.run("-c fold_curve -s impacting -o fold_curve --both");
  double least = 10.0, largest = 0.0;
  for (const PointSection& section : pipeline.workspace.points("fold_curve"))
    for (const PointRow& row : section.rows) {
      least = std::min(least, row.values[section.column("A")]);
      largest = std::max(largest, row.values[section.column("A")]);
    }
  CHECK(least < 1.0);
  CHECK(largest > 1.6);
  for (const DiagnosticPoint& point : pipeline.diagnostics("fold_curve"))
    CHECK(distance_to(point.multipliers, 1.0) < 1e-6);
}
