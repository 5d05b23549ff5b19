// Invariant tori from end to end: born at torus bifurcations of smooth and impacting orbits, from simulation, to
// grazing and along curves of grazing contact, against closed forms and forward integration.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "../../problems/langford/langford.cpp"
#include "motion/orbit_flow.hpp"
#include "orbit/torus_system.hpp"
#include "published/chain.hpp"
#include "published/smooth_motion.hpp"
#include "published/two_walls.hpp"
#include "support/test_system.hpp"

using namespace test_support;

namespace {

constexpr int rho = 60;

std::string command(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat(arguments);
  INFO(arguments << '\n' << outcome.text());
  REQUIRE(outcome.status == 0);
  return outcome.text();
}

/// The curve on the section where returns begin: n x N.
Eigen::MatrixXd curve_of(const SolutionEntry& solution, int n, int segments_per_return) {
  const auto& row = solution.states.front();
  const auto orbits = static_cast<Eigen::Index>(row.size()) / (n * segments_per_return);
  Eigen::MatrixXd curve(n, orbits);
  for (Eigen::Index i = 0; i < orbits; ++i)
    curve.col(i) = Eigen::VectorXd::Map(row.data() + i * n * segments_per_return, n);
  return curve;
}

/// Distance of a point from the trigonometric polynomial through the values: from the nearest of many points of it,
/// near the phase where rotation has brought the point, by Taylor's formula, whose rest is below 1e-11 at this density.
/// Of any point of the curve: the least distance is no larger.
class CurveDistance {
 public:
  explicit CurveDistance(const Eigen::MatrixXd& values) {
    for (int order = 0; order < 4; ++order) {
      derivatives_[order].resize(values.rows(), samples);
      for (int k = 0; k < samples; ++k)
        derivatives_[order].col(k) = values * tchat::interpolation_weights(static_cast<int>(values.cols()),
                                                                           static_cast<double>(k) / samples, order)
                                                  .transpose();
    }
  }
  double operator()(const Eigen::VectorXd& x, double phi) const {
    const auto about = static_cast<int>(std::lround((phi - std::floor(phi)) * samples));
    int k = about % samples;
    for (int j = about - around; j <= about + around; ++j) {
      const int at = (j + samples) % samples;
      if ((derivatives_[0].col(at) - x).squaredNorm() < (derivatives_[0].col(k) - x).squaredNorm()) k = at;
    }
    const auto u = [&](double t) -> Eigen::VectorXd {
      return derivatives_[0].col(k) +
             t * (derivatives_[1].col(k) + t / 2.0 * (derivatives_[2].col(k) + t / 3.0 * derivatives_[3].col(k)));
    };
    double t = 0.0;
    for (int iteration = 0; iteration < 4; ++iteration) {  // Newton on the derivative of the squared distance
      const Eigen::VectorXd d = u(t) - x;
      const Eigen::VectorXd u1 =
          derivatives_[1].col(k) + t * derivatives_[2].col(k) + t * t / 2.0 * derivatives_[3].col(k);
      t -= d.dot(u1) / (u1.squaredNorm() + d.dot(derivatives_[2].col(k)));
    }
    return (u(t) - x).norm();
  }

 private:
  static constexpr int samples = 3000, around = 10;
  std::array<Eigen::MatrixXd, 4> derivatives_;
};

/// The largest distance from the curve of `count` returns that are integrated from its first point.
double largest_distance(const tchat::HybridSystem& system, const tchat::Signature& signature,
                        const SolutionEntry& solution, int parameters, int count) {
  const int n = system.dimension();
  const Eigen::MatrixXd curve = curve_of(solution, n, static_cast<int>(signature.size()));
  const CurveDistance distance(curve);
  Eigen::VectorXd par(parameters);
  for (int k = 0; k < parameters; ++k) par(k) = solution.parameter(k + 1);
  tchat::FlowOptions options;
  options.relative_tolerance = 1e-13;
  options.absolute_tolerance = 1e-14;
  options.variational = false;
  options.surface_tolerance = 1e-7;
  Eigen::VectorXd x = curve.col(0);
  double largest = 0.0;
  for (int k = 0; k < count; ++k) {
    for (const tchat::IndexVector& index : signature) {
      const tchat::SegmentFlow flow = tchat::integrate_segment(system, index, x, par, options);
      REQUIRE(flow.status == tchat::FlowStatus::event_reached);
      system.value(tchat::FunctionKind::jump, index.jump, flow.end_state.data(), par.data(), x.data());
    }
    largest = std::max(largest, distance(x, (k + 1) * solution.parameter(rho)));
  }
  return largest;
}

/// The largest distance from the curve of `count` section points of Langford's system, by a motion of its own.
double largest_langford_distance(const SolutionEntry& solution, int count) {
  const Eigen::MatrixXd curve = curve_of(solution, 3, 1);
  const CurveDistance distance(curve);
  const auto field = [system = Langford(), par = solution.par](const MotionState<3>& x, MotionState<3>& f, double) {
    system.field(1, x.data(), par.data(), f.data());
  };
  const auto section = [](const MotionState<3>& x, double) { return x[1]; };
  REQUIRE(std::abs(curve(1, 0)) < 1e-9);
  // Exactly on the section, so that no rounding makes a fall of the start.
  SmoothMotion<3, decltype(field), decltype(section)> motion(field, section, {curve(0, 0), 0.0, curve(2, 0)}, 0.04);
  double largest = 0.0;
  for (int k = 0; k < count; ++k) {
    const MotionState<3> x = motion.next_fall();
    largest =
        std::max(largest, distance(Eigen::Map<const Eigen::Vector3d>(x.data()), (k + 1) * solution.parameter(rho)));
  }
  return largest;
}

void enter_langford(const Workspace& workspace) {
  namespace fs = std::filesystem;
  fs::copy_file(LANGFORD_LIBRARY, workspace.file("langford.so"));
  for (const char* name : {"gc.langford", "langford.dat"})
    fs::copy_file(std::string(LANGFORD_CONSTANTS "/") + name, workspace.file(name));
}

}  // namespace

TEST_CASE(
    "torus of Langford's system, born at TR: rho in closed form there, 1e5 section points of a simulation on it") {
  const Workspace workspace;
  enter_langford(workspace);
  command(workspace, "run langford PAR(f)=0.03");
  const std::string text =
      command(workspace,
              "run langford -s langford -o tori IRS=TR1 IPS=182 ISW=-1 ICP=[a,rho] DS=0.02 DSMAX=0.1 "
              "NMX=60 UZR={-1:0.76} HARMTOL=1e-10");
  const SolutionEntry bifurcation = only(workspace, "langford", "TR");
  const SolutionEntry torus = only(workspace, "tori", "UZ");
  CHECK(std::abs(torus.parameter(1) - 0.76) < 1e-8);
  // The simulation adds 1e-13 a return and forgets it at the rate of the normal multiplier. It begins on the section:
  // its first fall is a return later.
  CHECK(largest_langford_distance(torus, 100000) < 1e-8);
  CHECK(largest_distance(tchat::test::system_of<Langford>(), {{1, 1, 1}}, torus, 6, 1000) < 1e-8);

  // The first torus, of small amplitude, has about the angle of the pair.
  const auto points = workspace.points("tori").front();
  const double first = points.rows.front().values[points.column("rho")];
  const auto label = with_label(read_diagnostics(workspace.read("d.langford")), bifurcation.label);
  double angle = 0.0;
  for (const auto& mu : label.multipliers)
    if (mu.imag() > 0.1) angle = std::arg(mu) / (2.0 * M_PI);
  CHECK(std::abs(first - angle) < 2e-3);
}

TEST_CASE("torus of Langford's system with the symmetry: the frequency of the rotation, strong resonances told") {
  const Workspace workspace;
  enter_langford(workspace);
  command(workspace, "run langford");
  const std::string text =
      command(workspace,
              "run langford -s langford -o tori IRS=TR1 IPS=182 ISW=-1 ICP=[a,rho] DS=0.05 DSMAX=0.1 "
              "NMX=14 NPR=1");
  CHECK(text.find("the rotation number passes 1/3") != std::string::npos);
  for (const SolutionEntry& solution : workspace.solutions("tori")) {
    const auto orbits = static_cast<int>(solution.states.front().size()) / 3;
    double time = 0.0;
    for (int i = 1; i <= orbits; ++i) time += solution.parameter(60 + i);
    CHECK(time / orbits == Approx(2.0 * M_PI / 3.5).epsilon(1e-9));
  }
  // A restart converges to the same torus, its direction kept.
  const SolutionEntry stored = workspace.solutions("tori").back();
  command(workspace, "run langford -c r.tori -s tori -o again ISW=1 NMX=1 IRS=" + std::to_string(stored.label));
  CHECK(first_iterations(workspace.read("d.again")) <= 1);
  CHECK(difference(stored, workspace.solutions("again").front()) < 2e-9);
}

TEST_CASE("torus of an impacting orbit, born at TR, against forward integration with its impacts") {
  const Workspace workspace;
  std::filesystem::copy_file(TWO_WALLS_LIBRARY, workspace.file("walls.so"));
  command(workspace, "simulate walls -q -o simulated --dat smooth --free a");
  command(workspace, "run walls -q -c smooth -d smooth -o smooth NPR=0");
  command(workspace, "resegment -q -p walls q.smooth GR1 --to impacting -o born NPR=0 NMX=300 DS=0.01");
  command(workspace, "run walls -q -c born -s born -o bifurcations");
  command(workspace,
          "run walls -s bifurcations -c r.bifurcations -o tori IRS=TR2 IPS=182 ISW=-1 ICP=[1,60] DS=0.01 NMX=12 NPR=4");
  for (const SolutionEntry& torus : workspace.solutions("tori")) {
    CAPTURE(torus.label, torus.parameter(1), torus.parameter(rho));
    // The torus may repel: a few returns only, from a point that the solver knows to its tolerances.
    CHECK(largest_distance(tchat::test::system_of<TwoWalls>(), {{1, 2, 2}, {1, 3, 3}}, torus, 6, 20) < 1e-6);
  }
}

TEST_CASE("torus in closed form from simulation, to the wall, and along the curve of tori that touch it") {
  const Workspace workspace;
  std::filesystem::copy_file(TORUS_LIBRARY, workspace.file("torus.so"));
  std::filesystem::copy_file(CONSTANTS "/torus/gc.torus", workspace.file("gc.torus"));
  const auto largest_x = [](double omega) { return 1.0 / (1.0 - 1.0 / std::sqrt(1.0 + omega * omega)); };
  const std::string text = command(workspace, "simulate torus -c torus --torus found NHARM=30");
  CHECK(text.find("The motion is quasi-periodic") != std::string::npos);
  // The curve may be gone round either way.
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  const double found = workspace.solutions("found").front().parameter(rho);
  CHECK(std::min(std::abs(found - golden), std::abs(1.0 - found - golden)) < 1e-9);

  // At the wall harmonics beyond the 30 are 0.414^30.
  command(workspace, "run torus -c torus -s found -o wall ICP=[mu,rho] DS=-0.1 DSMAX=0.5 RL0=1 RL1=10 HARMTOL=0");
  const SolutionEntry touching = only(workspace, "wall", "GR");
  CHECK(std::abs(touching.parameter(3) - largest_x(1.0)) < 1e-8);
  CHECK(touching.internal.at(0) == 2);  // contact
  CHECK(std::abs(touching.internal.at(3) - 0.5) < 1e-7);

  command(
      workspace,
      "resegment q.wall GR1 --to grazing-curve -o curve -p torus ICP=[omega,mu,rho] RL0=0.5 RL1=3 DS=0.1 HARMTOL=0");
  command(workspace, "run torus -c curve -s curve -o touching NMX=8 NPR=1");
  int points = 0;
  for (const SolutionEntry& torus : workspace.solutions("touching")) {
    CHECK(std::abs(torus.parameter(3) - largest_x(torus.parameter(1))) < 1e-7);
    ++points;
  }
  CHECK(points >= 7);
}

TEST_CASE("tori: what a user does wrong gets a sentence") {
  const Workspace workspace;
  enter_langford(workspace);
  std::filesystem::copy_file(TORUS_LIBRARY, workspace.file("torus.so"));
  std::filesystem::copy_file(CONSTANTS "/torus/gc.torus", workspace.file("gc.torus"));
  command(workspace, "run langford");
  const auto refused = [&](const std::string& arguments, const std::string& sentence) {
    const Outcome outcome = workspace.tchat(arguments);
    INFO(arguments << '\n' << outcome.text());
    CHECK(outcome.status != 0);
    CHECK(outcome.text().find(sentence) != std::string::npos);
  };
  refused("run langford -s langford -o x IRS=EP1 IPS=182 ISW=-1 ICP=[a,rho]",
          "begins the torus that is born at a torus");
  refused("run langford -s langford -o x IRS=TR1 IPS=182 ICP=[a,rho]",
          "label 2 (IPS = 180) has 1 segment and is no torus");
  refused("run langford -s langford -o x IRS=TR1 ICP=[rho]", "rho is the rotation number of a torus");
  refused("run langford -s langford -o x IRS=TR1 IPS=182 ISW=-1 ICP=[a]", "ICP");
  refused("simulate langford -c langford --torus x PAR(a)=0.5", "");  // settles on the periodic orbit
  refused("simulate langford -c langford --torus x --dat y", "--dat writes a periodic orbit and --torus a torus");
}
