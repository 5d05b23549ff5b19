// Families of periodic orbits of conservative systems, continued without a free parameter (CONSERVED): an elastic ball,
// chains of masses with an elastic stop, two coupled Duffing oscillators, and the way from a family to damped orbits.
// The references are closed forms and a quadrature. Method: F. J. Munoz-Almaraz, E. Freire, J. Galan, E. Doedel, A.
// Vanderbauwhede, Continuation of periodic orbits in conservative and Hamiltonian systems, Physica D 181 (2003) 1-38.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "published/makefile_run.hpp"

using namespace test_support;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The largest |lambda| of a run as its summary prints it.
double printed_lambda(const Outcome& outcome) {
  const std::string words = "lambda, which should be 0: ";
  const std::size_t at = outcome.out.find(words);
  REQUIRE(at != std::string::npos);
  return std::stod(outcome.out.substr(at + words.size()));
}

// Lambda corrects states of order one: rounding errors of a few hundred operations are below 1e-12.
constexpr double rounding = 1e-12;

/// Values of two columns, row by row.
std::vector<std::pair<double, double>> pairs_of(const Workspace& workspace, const std::string& name,
                                                const std::string& first, const std::string& second) {
  std::vector<std::pair<double, double>> pairs;
  for (const PointSection& section : workspace.points(name))
    for (const PointRow& row : section.rows)
      pairs.emplace_back(row.values[section.column(first)], row.values[section.column(second)]);
  REQUIRE(!pairs.empty());
  return pairs;
}

// ---- the elastic ball -----------------------------------------------------------------------------------------------

constexpr double g = 9.81;

/// `signature`: lines of constants for the segments.
Outcome run_ball(const Workspace& workspace, const std::string& data, const std::string& signature) {
  workspace.write("ball.tch", fmt::format("par g={}, r=1\ninit x=0, v=2\nx' = v\nv' = -g\nevent wall = x\n"
                                          "event top = v\njump bounce: v -> -r*v\naux energy = v^2/2 + g*x\n",
                                          g));
  workspace.write("ball.dat", data);
  workspace.write("gc.ball",
                  "NDIM=2, IPS=180, CONSERVED=energy, ICP=[energy, period]\nNTST=4, NCOL=4, NMX=30\n"
                  "DS=0.1, DSMAX=1\n" +
                      signature);
  return workspace.succeed("run ball");
}

const char* const one_flight = "GCHIND=[1], GCGIND=[1]\n";
const char* const rise_and_fall = "GCNOSEG=2, GCSEGTYP=[0,1], GCFIND=[1,1], GCHIND=[2,1], GCGIND=[2,1]\n";
const char* const flight_data = "0 0 2\n0.4 0 -2\n";
const char* const rise_and_fall_data = "0 0 2\n0.2 0.2 0\n0.2 0.2 0\n0.4 0 -2\n";

// ---- chains of masses with a stop -----------------------------------------------------------------------------------

/// Each mass tied to its neighbours by springs of stiffness 1 and the first one to a wall, elastic stop at u_N = 1. An
/// orbit of period T with one impact is symmetric about T/2, where it is smooth: mode i moves as
/// A_i cos(omega_i (t - T/2)). At the impact its velocity changes by 2 phi_i v, hence A_i omega_i sin(omega_i T / 2) =
/// phi_i v. The condition u_N = 1 at the impact then gives v.
class ChainOfMasses {
 public:
  explicit ChainOfMasses(int masses) : n_(masses) {
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n_, n_);
    K.diagonal().setConstant(2.0);
    K.diagonal(1).setConstant(-1.0);
    K.diagonal(-1).setConstant(-1.0);
    K(n_ - 1, n_ - 1) = 1.0;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(K);
    omega_ = solver.eigenvalues().cwiseSqrt();
    modes_ = solver.eigenvectors();
    phi_ = modes_.row(n_ - 1);
  }

  int masses() const { return n_; }
  /// From the slowest mode, k = 1.
  double omega(int k) const { return omega_(k - 1); }
  /// The energy of the k-th mode at which the last mass touches the stop.
  double touching_energy(int k) const { return 0.5 * std::pow(omega(k) / phi_(k - 1), 2); }

  /// Of the last mass after the impact.
  double velocity(double T) const {
    return 1.0 / (phi_.array().square() / ((0.5 * T * omega_).array().tan() * omega_.array())).sum();
  }
  double energy(double T) const {
    return 0.5 * std::pow(velocity(T), 2) * (phi_.array() / (0.5 * T * omega_).array().sin()).square().sum();
  }
  /// Positions, then velocities.
  Eigen::VectorXd state(double T, double t) const {
    const Eigen::ArrayXd w = omega_.array();
    const Eigen::ArrayXd A = velocity(T) * phi_.array() / (w * (0.5 * T * w).sin());
    Eigen::VectorXd x(2 * n_);
    x << modes_ * (A * (w * (t - 0.5 * T)).cos()).matrix(), modes_ * (-A * w * (w * (t - 0.5 * T)).sin()).matrix();
    return x;
  }

  /// det(M + Id), M the derivative of one turn of period T with the impact: zero where a multiplier is -1.
  double doubling(double T) const {
    const Eigen::ArrayXd w = omega_.array();
    const auto of_modes = [&](const Eigen::ArrayXd& factors) {
      return Eigen::MatrixXd(modes_ * factors.matrix().asDiagonal() * modes_.transpose());
    };
    Eigen::MatrixXd flow(2 * n_, 2 * n_);
    flow << of_modes((w * T).cos()), of_modes((w * T).sin() / w), of_modes(-w * (w * T).sin()), of_modes((w * T).cos());
    const auto field = [&](const Eigen::VectorXd& x) {
      Eigen::VectorXd f(2 * n_);
      f << x.tail(n_), -of_modes(w.square()) * x.head(n_);
      return f;
    };
    const Eigen::VectorXd before = field(state(T, T)), after = field(state(T, 0.0));
    Eigen::MatrixXd jump = Eigen::MatrixXd::Identity(2 * n_, 2 * n_);
    jump(2 * n_ - 1, 2 * n_ - 1) = -1.0;
    jump.col(n_ - 1) += (after - jump * before) / before(n_ - 1);  // h_x f = -u_n'
    return (jump * flow + Eigen::MatrixXd::Identity(2 * n_, 2 * n_)).determinant();
  }

  std::string formulas() const {
    std::string positions, velocities, energy;
    for (int i = 1; i <= n_; ++i) {
      const std::string stretch = i > 1 ? fmt::format("(u{}-u{})", i, i - 1) : "u1";
      const std::string pull = i < n_ ? fmt::format(" + (u{}-u{})", i + 1, i) : "";
      positions += fmt::format("u{0}' = v{0}\n", i);
      velocities += fmt::format("v{0}' = -{1}{2} - d*v{0}\n", i, stretch, pull);
      energy += fmt::format(" + v{}^2/2 + {}^2/2", i, stretch);
    }
    return fmt::format("par d=0\n{0}{1}event stop = 1 - u{2}\njump bounce: v{2} -> -v{2}\naux energy = {3}\n",
                       positions, velocities, n_, energy.substr(3));
  }
  /// The orbit of period T, with the digits that a hand or a measurement would give.
  std::string data(double T) const {
    std::string text;
    for (int k = 0; k <= 8 * n_; ++k) {
      const double t = T * k / (8 * n_);
      text += fmt::format("{:.8g}", t);
      for (const double value : state(T, t)) text += fmt::format(" {:.3g}", value);
      text += "\n";
    }
    return text;
  }

 private:
  int n_;
  Eigen::VectorXd omega_, phi_;
  Eigen::MatrixXd modes_;
};

/// The equilibrium of a chain, q.rest, and its slowest family up to the stop, q.family.
void run_to_touch(const Workspace& workspace, const ChainOfMasses& chain) {
  workspace.write("chain.tch", chain.formulas());
  workspace.write("chain.dat", "0 0 0 0\n");
  workspace.write("gc.chain", "NDIM=4, IPS=1, ICP=[d], NMX=1, GCHGRZIND=[[1]]\n");
  workspace.succeed("run chain -o rest");
  workspace.succeed(
      "run chain -c r.rest -s rest -o family IRS=1 IPS=180 ISW=-1 MODE=1 CONSERVED=energy "
      "ICP=[energy,period] NTST=20 NCOL=5 NMX=50 DS=0.05 DSMAX=0.5");
}

/// From data near the closed form of period T: q.modes. `mesh`: NTST, NCOL and NMX.
Outcome run_chain(const Workspace& workspace, const ChainOfMasses& chain, double T, const std::string& mesh) {
  workspace.write("chain.tch", chain.formulas());
  workspace.write("chain.dat", chain.data(T));
  workspace.write("gc.modes", fmt::format("NDIM={}, IPS=180, CONSERVED=energy, ICP=[period, energy, start(v{})]\n"
                                          "GCHIND=[1], GCGIND=[1], GCHGRZIND=[[1]], GCIPSI=[1]\n"
                                          "DS=-0.02, DSMAX=0.2, EPSL=1e-10, EPSU=1e-10, {}\n",
                                          2 * chain.masses(), chain.masses(), mesh));
  return workspace.succeed("run chain -c modes -d chain -o modes");
}

/// Velocities after the impact at all points of q.modes, to 1e-9 and the last digit of T in the file.
void check_velocities(const Workspace& workspace, const ChainOfMasses& chain) {
  for (const auto& [T, v] : pairs_of(workspace, "modes", "period", fmt::format("start(v{})", chain.masses()))) {
    INFO("T = " << T);
    const double digit = 5e-11 * T;
    const double change = std::abs(chain.velocity(T + digit) - chain.velocity(T - digit));
    check_near(v, chain.velocity(T), 1e-9 + change);
  }
}

// ---- coupled oscillators --------------------------------------------------------------------------------------------

/// x = A cn(Omega t, m) solves x'' + (1 + coupling) x + x^3 = 0: Omega^2 = 1 + coupling + A^2, m = A^2 / (2 Omega^2).
/// The coupling is 2 k for two oscillators out of phase, and 0 in phase.
struct DuffingMotion {
  double coupling = 0.0;
  double stiffness() const { return 1.0 + coupling; }
  /// Of both oscillators together.
  double energy(double square) const { return stiffness() * square + 0.5 * square * square; }
  double square_of_amplitude(double energy) const {
    return std::sqrt(stiffness() * stiffness() + 2.0 * energy) - stiffness();
  }
  double period(double energy) const {
    const double square = square_of_amplitude(energy);
    const double Omega = std::sqrt(stiffness() + square);
    return 4.0 * boost::math::ellint_1(std::sqrt(0.5 * square) / Omega) / Omega;
  }
};

/// q.rest, the equilibrium of the two oscillators, then q.family, the MODE-th family about it.
void run_oscillators(const Workspace& workspace, int mode, const std::vector<std::string>& further) {
  workspace.write("duo.tch",
                  "par k=0.3\nx1' = v1\nx2' = v2\nv1' = -x1 - x1^3 - k*(x1-x2)\nv2' = -x2 - x2^3 - k*(x2-x1)\n"
                  "aux energy = v1^2/2 + v2^2/2 + x1^2/2 + x2^2/2 + x1^4/4 + x2^4/4 + k*(x1-x2)^2/2\n");
  workspace.write("duo.dat", "0 0 0 0\n");
  workspace.write("gc.duo", "NDIM=4, IPS=1, ICP=[k], NMX=1\n");
  workspace.succeed("run duo -o rest");
  std::vector<std::string> words = words_of(
      "run duo -c r.rest -s rest -o family IRS=1 IPS=180 ISW=-1 CONSERVED=energy "
      "ICP=[energy,period] NTST=30 NCOL=5 NMX=30 DS=0.05 DSMAX=0.3 EPSL=1e-10 "
      "EPSU=1e-10");
  words.push_back(fmt::format("MODE={}", mode));
  words.insert(words.end(), further.begin(), further.end());
  CHECK(printed_lambda(workspace.succeed(words)) < rounding);
}

// The mesh of 30 intervals of degree 5 has an error of 1e-8 between its points, and much less at them.
constexpr double mesh_error = 1e-8;

void check_periods(const Workspace& workspace, const DuffingMotion& motion) {
  for (const auto& [energy, period] : pairs_of(workspace, "family", "energy", "period")) {
    INFO("energy = " << energy);
    CHECK(period == Approx(motion.period(energy)).epsilon(mesh_error));
  }
}

// ---- a damped oscillator beside a family ----------------------------------------------------------------------------

/// x'' + x + x^3 = -d x' + f x' (1 - x^2): q.family of d = f = 0, cut at its velocity zero, to energy 1 (UZ1).
void run_family(const Workspace& workspace) {
  workspace.write("osc.tch",
                  "par d=0, f=0\nx' = v\nv' = -x - x^3 - d*v + f*v*(1-x^2)\nevent section = v\n"
                  "aux energy = v^2/2 + x^2/2 + x^4/4\n");
  workspace.write("osc.dat", "0 0\n");
  workspace.write("gc.osc", "NDIM=2, IPS=1, ICP=[d], NMX=1\n");
  workspace.succeed("run osc -o rest");
  workspace.succeed(
      "run osc -c r.rest -s rest -o family IRS=1 IPS=180 ISW=-1 CONSERVED=energy ICP=[energy,period] GCHIND=[1] "
      "GCGIND=[0] NTST=30 NCOL=5 NMX=60 DS=0.05 DSMAX=0.3 EPSL=1e-10 EPSU=1e-10 UZR={energy:1} RL1=2");
}

/// The limit of f / d at d = 0: the work of both forces over the conservative orbit of energy 1 is zero, that is,
/// d times the integral of v^2 dt = v dx equals f times that of (1 - x^2) v dx.
double melnikov_ratio() {
  const double square = std::sqrt(5.0) - 1.0;  // of the amplitude A: A^2 / 2 + A^4 / 4 = 1
  // With x = A sin(s), v dx = A^2 cos(s)^2 sqrt(1 + (A^2 + x^2) / 2) ds is smooth.
  const auto work = [square](auto weight) {
    const auto integrand = [&](double s) {
      const double x2 = square * std::sin(s) * std::sin(s);
      return square * std::cos(s) * std::cos(s) * std::sqrt(1.0 + 0.5 * (square + x2)) * weight(x2);
    };
    return boost::math::quadrature::gauss_kronrod<double, 61>::integrate(integrand, -0.5 * M_PI, 0.5 * M_PI, 5, 1e-14);
  };
  return work([](double) { return 1.0; }) / work([](double x2) { return 1.0 - x2; });
}

/// f / d at d = 0.1 and 0.2 of orbits whose energy is 1 where their velocity is zero.
std::pair<double, double> damped_ratios(const Workspace& workspace) {
  const Outcome outcome = workspace.succeed(
      "run osc -c r.family -s family -o damped IRS=UZ1 CONSERVED= ICP=[d,f,energy] "
      "HOLD=[energy] NMX=12 DS=0.02 UZR={d:[0.1,0.2]}");
  CHECK(contains(outcome.err, "RL1 = 2 of r.family was given for energy and now bounds d"));
  std::vector<double> ratios;
  for (const SolutionEntry& solution : workspace.solutions("damped"))
    if (solution.type == -4) ratios.push_back(solution.parameter(2) / solution.parameter(1));
  REQUIRE(ratios.size() == 2);
  return {ratios[0], ratios[1]};
}

/// `arguments` end with that exit status and one sentence on standard error that contains `part`.
void check_refused(const Workspace& workspace, const std::string& arguments, int status, const std::string& part) {
  const Outcome outcome = workspace.tchat(arguments);
  INFO(arguments << '\n' << outcome.text());
  CHECK(outcome.status == status);
  CHECK(contains(outcome.err, part));
  CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
}

}  // namespace

TEST_CASE("elastic ball: the energy is g^2 T^2 / 8 along the family") {
  const Workspace workspace;
  const bool in_two = GENERATE(false, true);
  const Outcome outcome =
      in_two ? run_ball(workspace, rise_and_fall_data, rise_and_fall) : run_ball(workspace, flight_data, one_flight);
  // Polynomials of degree 4 contain the flight: only rounding of the files' digits is left.
  for (const auto& [energy, period] : pairs_of(workspace, "ball", "energy", "period"))
    CHECK(energy == Approx(g * g * period * period / 8.0).epsilon(1e-10));
  CHECK(printed_lambda(outcome) < rounding);
  CHECK(!contains(outcome.text(), "homoclinic"));
  CHECK(!contains(workspace.read("d.ball"), "homoclinic"));
  CHECK(!contains(workspace.read("d.ball"), "normal form"));
  workspace.succeed("verify ball");
}

TEST_CASE("a chain of two masses: from rest to its first touch, and along the contact modes") {
  const Workspace workspace;
  const ChainOfMasses chain(2);
  run_to_touch(workspace, chain);
  for (const auto& [energy, period] : pairs_of(workspace, "family", "energy", "period"))
    CHECK(period == Approx(2.0 * M_PI / chain.omega(1)).epsilon(1e-9));  // the motion is linear
  CHECK(pairs_of(workspace, "family", "energy", "period").back().first ==
        Approx(chain.touching_energy(1)).epsilon(1e-8));

  CHECK(contains(workspace.succeed("resegment q.family GR1 --to impacting -o contact -p chain").out,
                 "free: energy, period, T1"));
  const Outcome outcome = workspace.succeed({"run", "chain", "-c", "contact", "-s", "contact", "-o", "modes", "NMX=100",
                                             "DS=-0.05", "EPSL=1e-10", "EPSU=1e-10", "UZR={period: [10,9,8]}"});
  CHECK(printed_lambda(outcome) < rounding);
  int located = 0;
  for (const SolutionEntry& solution : workspace.solutions("modes")) {
    const double T = solution.parameter(61);
    INFO("T = " << T);
    check_near(solution.states.front().at(3), chain.velocity(T));
    if (solution.type != -4 || solution.internal.at(0) == 2.0) continue;  // 2: a contact
    ++located;
    if (std::abs(T - 9.0) < 1e-8) check_near(solution.states.front().at(3), -0.33375227686096);
  }
  CHECK(located == 3);
  // The fold is the least energy along the family.
  const SolutionEntry fold = only(workspace, "modes", "LP");
  const auto least = boost::math::tools::brent_find_minima([&](double T) { return chain.energy(T); }, 9.9, 10.16, 40);
  CHECK(chain.energy(fold.parameter(61)) == Approx(least.second).epsilon(1e-9));
  CHECK(fold.parameter(61) == Approx(least.first).epsilon(1e-6));  // the minimum is known to half the digits
  workspace.succeed("verify modes -p chain");
}

TEST_CASE("contact modes of a chain of 10 masses") {
  const Workspace workspace;
  const ChainOfMasses chain(10);
  // 2 pi / omega_1 is 42.04.
  CHECK(printed_lambda(run_chain(workspace, chain, 41.0, "NTST=60, NCOL=5, NMX=60")) < rounding);
  check_velocities(workspace, chain);
  workspace.succeed("verify modes -p chain");
}

TEST_CASE("contact modes that are run twice cross the families of twice the period at BP") {
  const auto [masses, T, mesh] = GENERATE(
      table<int, double, std::string>({{2, 9.98, "NTST=40, NCOL=5, NMX=25"}, {10, 41.0, "NTST=60, NCOL=5, NMX=15"}}));
  const Workspace workspace;
  const ChainOfMasses chain(masses);
  run_chain(workspace, chain, T, mesh);
  workspace.succeed("resegment q.modes EP1 -q -p chain --to double -o two");
  workspace.succeed("run chain -q -c two -s two -o two DSMAX=0.4");
  const auto located = [&](const std::string& name, const std::string& type) {
    std::vector<std::pair<double, double>> found;
    const std::vector<PointSection> sections = workspace.points(name);
    for (const DiagnosticPoint& point : of_type(read_diagnostics(workspace.read("d." + name)), type)) {
      const PointRow& row = with_label(sections, point.label);
      found.emplace_back(row.values[sections.front().column("period")], row.values[sections.front().column("energy")]);
    }
    return found;
  };
  const auto doublings = located("modes", "PD"), crossings = located("two", "BP");
  REQUIRE(doublings.size() >= 2);
  REQUIRE(crossings.size() == doublings.size());
  for (std::size_t k = 0; k < doublings.size(); ++k) {
    const auto [period, energy] = doublings[k];
    CAPTURE(masses, period);
    check_near(crossings[k].first, 2.0 * period, 1e-8 * period);
    check_near(crossings[k].second, energy, 1e-8 * energy);
    std::uintmax_t iterations = 60;
    const auto exact =
        boost::math::tools::toms748_solve([&](double t) { return chain.doubling(t); }, period - 1e-3, period + 1e-3,
                                          boost::math::tools::eps_tolerance<double>(48), iterations);
    check_near(period, exact.first, 1e-8 * period);
    check_near(energy, chain.energy(exact.first), 1e-8 * energy);
    // The same branch is found from both, at the same distance.
    const auto first_energy = [&](const std::string& from, const std::string& label) {
      workspace.succeed(
          fmt::format("run chain -q -c r.{0} -s {0} -o new IRS={1}{2} ISW=-1 DS=0.01 NMX=1", from, label, k + 1));
      workspace.succeed("verify new -p chain");
      const std::vector<double> x = workspace.solutions("new").front().states.front();
      const auto n = static_cast<Eigen::Index>(x.size() / 2);
      const Eigen::Map<const Eigen::VectorXd> turns(x.data(), 2 * n);
      CHECK((turns.head(n) - turns.tail(n)).lpNorm<Eigen::Infinity>() > 1e-4);
      return located("new", "EP").front().second;
    };
    CHECK(first_energy("two", "BP") - energy ==
          Approx(first_energy("modes", "PD") - energy).epsilon(1e-3).margin(1e-9));
  }
}

TEST_CASE("contact modes of a chain of 50 masses") {
  const Workspace workspace;
  const ChainOfMasses chain(50);
  // 2 pi / omega_1 is 202.01. Rounding is larger for 100 states and the 64 oscillations of the fastest mode.
  CHECK(printed_lambda(run_chain(workspace, chain, 201.5, "NTST=200, NCOL=5, NMX=2")) < 100.0 * rounding);
  check_velocities(workspace, chain);
  // `tchat verify` would take half a minute for each label: all states of one label are compared instead.
  const SolutionEntry last = workspace.solutions("modes").back();
  const double T = last.parameter(61);
  double largest = 0.0;
  for (std::size_t k = 0; k < last.t.size(); ++k) {
    const Eigen::Map<const Eigen::VectorXd> found(last.states[k].data(), 2 * chain.masses());
    largest = std::max(largest, (found - chain.state(T, T * last.t[k])).cwiseAbs().maxCoeff());
  }
  CHECK(largest < 1e-6);  // the error between mesh points is 1e-7 of the largest state
}

TEST_CASE("coupled Duffing oscillators out of phase lose stability at a Lame band edge, and one takes the energy") {
  const Workspace workspace;
  constexpr double k = 0.3;
  const DuffingMotion motion{2.0 * k};
  run_oscillators(workspace, 2, {});
  check_periods(workspace, motion);
  const SolutionEntry edge = only(workspace, "family", "BP");
  const double energy = motion.energy(4.0 * k / 3.0);
  REQUIRE(energy == Approx(0.72));
  const PointSection section = workspace.points("family").front();
  const PointRow row = with_label(workspace.points("family"), edge.label);
  CHECK(row.values[section.column("energy")] == Approx(energy).epsilon(mesh_error));
  CHECK(row.values[section.column("period")] == Approx(motion.period(energy)).epsilon(mesh_error));
  for (const PointRow& point : section.rows)
    if (point.label != edge.label) CHECK((point.point < 0) == (point.values[section.column("energy")] < energy));

  workspace.succeed(
      "run duo -c r.family -s family -o local IRS=BP1 ISW=-1 ICP=[energy,max(x1),max(x2)] DS=0.05 "
      "DSMAX=0.3 NMX=12");
  const PointSection local = workspace.points("local").front();
  for (const PointRow& point : local.rows) {
    CHECK(point.point < 0);  // stable
    CHECK(point.values[local.column("energy")] > energy);
  }
  const PointRow& end = local.rows.back();
  CHECK(std::abs(end.values[local.column("max(x1)")] - end.values[local.column("max(x2)")]) > 0.5);
  workspace.succeed("verify local -p duo");
  // At a branch point the first tangent is no more than a mixture: no direction is announced.
  const Outcome held =
      workspace.succeed("run duo -c r.family -s family -o held IRS=BP1 ICP=[k,energy] HOLD=[energy] UZR={} NMX=2");
  CHECK(!contains(held.out, "first (label"));
}

TEST_CASE("coupled Duffing oscillators in phase, and out of phase with the energy held along the coupling") {
  const Workspace workspace;
  run_oscillators(workspace, 1, {});
  check_periods(workspace, DuffingMotion{0.0});
  run_oscillators(workspace, 2, {"UZR={-energy: 0.5}"});
  workspace.succeed(
      "run duo -c r.family -s family -o held IRS=UZ1 ICP=[k,energy,period] HOLD=[energy] UZR={} DS=0.02 "
      "DSMAX=0.3 NMX=20");
  for (const auto& [k, period] : pairs_of(workspace, "held", "k", "period"))
    CHECK(period == Approx(DuffingMotion{2.0 * k}.period(0.5)).epsilon(mesh_error));
  for (const auto& [k, energy] : pairs_of(workspace, "held", "k", "energy")) check_near(energy, 0.5);
  workspace.succeed("verify held -p duo");
}

TEST_CASE("damped orbits start from a conservative family where both forces do no work in sum") {
  const Workspace workspace;
  run_family(workspace);
  const auto [at_one, at_two] = damped_ratios(workspace);
  // Time reversal maps (d, f) to (-d, -f), and keeps orbits that start at velocity zero: f / d is even in d.
  const double limit = melnikov_ratio();
  CHECK(std::abs(at_one - limit) < 0.01 * 0.1 * limit);  // of second order in d = 0.1
  CHECK((at_two - limit) / (at_one - limit) == Approx(4.0).epsilon(0.01));
  // Extrapolation leaves terms of fourth order, which these figures put at 1e-8.
  check_near((4.0 * at_one - at_two) / 3.0, limit, 2e-8);
  workspace.succeed("verify damped -p osc");
}

TEST_CASE("what a conservative family refuses") {
  const Workspace workspace;
  run_family(workspace);
  const std::string from_label = "run osc -c r.family -s family -o new IRS=UZ1 ";
  check_refused(workspace, from_label + "PAR(d)=0.1", 1, "energy changes by -0.");
  check_refused(workspace, from_label + "PAR(d)=0.1", 1, "on segment 1 (field flow)");
  for (const char* const icp : {"", " ICP=[d]"})
    check_refused(workspace, from_label + "CONSERVED=enrgy" + icp, 2, "no function of that name; it has x, v, energy");
  check_refused(workspace, from_label + "ICP=[d,energy]", 2,
                "CONSERVED = energy leaves no parameter of the problem free");
  check_refused(workspace, from_label + "ICP=[energy,d] ISW=2", 2, "IPS = 180, ISW = 2");
  check_refused(workspace, "run osc -c r.rest -s rest -o new IRS=1 IPS=180 ISW=-1 CONSERVED=energy ICP=[energy] MODE=2",
                2, "MODE = 2, but label 1 has 1 oscillation (omega = 1); allowed: 1");
  check_refused(workspace,
                "run osc -c r.rest -s rest -o new IRS=1 IPS=180 ISW=-1 CONSERVED=energy ICP=[energy] PAR(d)=0.1", 2,
                "no eigenvalue of f_x is on the imaginary axis");
}

TEST_CASE("a loss in an impact is found in the segment that ends with it") {
  const Workspace workspace;
  run_ball(workspace, rise_and_fall_data, rise_and_fall);
  check_refused(workspace, "run ball PAR(r)=0.9", 1, "in jump 1 (bounce) at the end of segment 2");
}

TEST_CASE("a run in the damping that keeps CONSERVED ends with the reason") {
  const Workspace workspace;
  run_family(workspace);
  const Outcome outcome = workspace.succeed(
      "run osc -c r.family -s family -o kept IRS=UZ1 ICP=[d,energy] "
      "HOLD=[energy] NMX=12 DS=0.01 UZR={}");
  CHECK(contains(outcome.out, "stopped: CONSERVED = energy is not conserved"));
  CHECK(printed_lambda(outcome) > 1e-4);
}

TEST_CASE("tchat check names the functions that do not conserve what CONSERVED names") {
  const Workspace workspace;
  run_ball(workspace, flight_data, one_flight);
  const Outcome conserved = workspace.succeed("check ball");
  CHECK(contains(conserved.out, "energy: conserved by field 1 (flow)"));
  CHECK(contains(conserved.out, "energy: conserved by jump 1 (bounce)"));
  const Outcome lost = workspace.tchat("check ball PAR(r)=0.9");
  CHECK(lost.status == 1);
  CHECK(contains(lost.out, "energy: conserved by field 1 (flow)"));
  CHECK(contains(lost.out, "energy: NOT conserved by jump 1 (bounce)"));
  // The constants are found beside a problem in another folder too.
  REQUIRE(workspace.shell("mkdir models && mv ball.* gc.ball models").status == 0);
  CHECK(contains(workspace.succeed("check models/ball").out, "energy: conserved by jump 1 (bounce)"));
}

TEST_CASE("tchat grazing refuses the label of a family without a parameter") {
  const Workspace workspace;
  const ChainOfMasses chain(2);
  run_to_touch(workspace, chain);
  check_refused(workspace, "grazing q.family GR1 -p chain", 2, "along which no parameter changes");
}

// ---- a mass with a cubic spring and an elastic wall -----------------------------------------------------------------

namespace {

/// Family `family` from rest to the first touch of the wall at x = 0.7, with a label at the energy 0.2.
void run_to_wall(const Workspace& workspace) {
  workspace.write("walled.tch",
                  "par c=1\nx' = v\nv' = -x - c*x^3\nevent wall = 0.7 - x\njump bounce: v -> -v\n"
                  "aux energy = v^2/2 + x^2/2 + x^4/4\naux product = x*v\n");
  workspace.write("walled.dat", "0 0\n");
  workspace.write("gc.walled", "NDIM=2 IPS=1 ICP=[c] NMX=1 GCHGRZIND=[[1]]\n");
  workspace.succeed("run walled -o rest -q");
  workspace.succeed(
      "run walled -q -c r.rest -s rest -o family IRS=1 IPS=180 ISW=-1 CONSERVED=energy ICP=[energy,period] NMX=60 "
      "UZR={energy:0.2}");
}

}  // namespace

TEST_CASE("with one degree of freedom a family begins to impact at its least energy") {
  const Workspace workspace;
  run_to_wall(workspace);
  const double touching = 0.49 / 2.0 + 0.2401 / 4.0;
  workspace.succeed("resegment q.family GR1 --to impacting -o contact");
  const Outcome outcome = workspace.succeed("run walled -c contact -s contact -o modes NMX=20");
  CHECK(!contains(outcome.out, "inadmissible"));
  // At the touch the energy is stationary, as v^2 / 2: v is known to the square root of a tolerance of 1e-7, E better.
  const auto pairs = pairs_of(workspace, "modes", "energy", "period");
  CHECK(std::abs(pairs.front().first - touching) < 1e-6);
  REQUIRE(pairs.size() == 20);
  CHECK(pairs.back().first > touching + 0.01);
  workspace.succeed("verify modes -p walled");
}

TEST_CASE("a function that changes along the orbits is not conserved, whatever lambda is") {
  const Workspace workspace;
  run_to_wall(workspace);
  check_refused(workspace, "run walled -c r.family -s family -o new IRS=UZ1 CONSERVED=product ICP=[product,period]", 1,
                "CONSERVED = product is not conserved: on segment 1 (field flow) it changes at the rate");
  check_refused(workspace, "run walled -c r.family -s family -o new IRS=UZ1 ICP=[enrgy,period]", 2,
                "enrgy is no parameter of problem Walled (it has PAR(1): c) and no monitor (period, energy, product, "
                "max(x), ...); did you mean energy?");
  check_refused(workspace, "resegment q.family GR1 --to grazing-curve -o curve", 2, "name them with ICP=[..., ...]");
}

TEST_CASE("a family that shrinks to an equilibrium ends at no Hopf bifurcation") {
  const Workspace workspace;
  run_to_wall(workspace);
  const Outcome outcome =
      workspace.succeed("run walled -c r.family -s family -o down IRS=UZ1 ICP=[energy,period] DS=-0.02 NMX=200 UZR={}");
  CHECK(contains(outcome.out, "of periodic orbits ends"));
  CHECK(contains(outcome.out, "(linear oscillation, omega = 1)"));
  CHECK(!contains(outcome.out, "Hopf"));
}

TEST_CASE("motions that keep their energy converge to no equilibrium, and repeat themselves") {
  const Workspace workspace;
  workspace.write("stop.tch", R"(x' = v
field out: v' = -x
field in: v' = -x - 3*(x-0.4)
event touch = 0.4 - x
event leave = x - 0.4
jump none:
after start: out until touch -> identity
after touch: in until leave -> identity
after leave: out until touch -> identity
)");
  CHECK(!contains(workspace.succeed("simulate stop --state 1.3,0").out, "converges"));
  workspace.write("walls.tch", R"(x' = v
v' = -1
event floor = x
event roof = 1 - x
jump bounce: v -> -v
after any: flow until floor -> bounce, roof -> bounce
)");
  const std::string seen = workspace.succeed("simulate walls --state 0.5,2 --events 20").out;
  CHECK(contains(seen, "signature {(1,1,1), (1,2,1)}"));
  CHECK(contains(seen, "neutral, the largest modulus is 1"));
  CHECK(contains(workspace.succeed("simulate walls --state 0.5,2 --refine").out, "Periodic orbit"));
}

TEST_CASE("a multiplier through 1 at fixed parameters is no missing point of a curve that holds the energy") {
  const Workspace workspace;
  workspace.write("pair.tch", R"(par d=0, f=0
u' = p
w' = q
p' = w-2*u-d*p
q' = u-w-d*q+f*q
event stop = 1-w
jump bounce: q -> -q
aux energy = (p^2+q^2+u^2+(w-u)^2)/2
)");
  workspace.write("pair.dat", "0 0 0 0\n");
  workspace.write("gc.pair", "NDIM=4 IPS=1 ICP=[d] NMX=1 GCHGRZIND=[[1]]\n");
  workspace.succeed("run pair -o rest -q");
  workspace.succeed(
      "run pair -q -c r.rest -s rest -o family IRS=1 IPS=180 ISW=-1 CONSERVED=energy ICP=[energy,period] NMX=50");
  workspace.succeed("resegment q.family GR1 --to impacting -o contact");
  workspace.succeed("run pair -q -c contact -s contact -o modes UZR={period:9}");
  const Outcome outcome = workspace.succeed(
      "run pair -c r.modes -s modes -o kept IRS=UZ1 CONSERVED= ICP=[d,f,energy] HOLD=[energy] UZR={} DS=0.01");
  CHECK(!contains(outcome.out, "may be missing"));
  CHECK(contains(workspace.read("d.kept"), "through +1; a curve that holds monitors need have none there"));
  // With damping and drive the grazing orbit is one of a curve.
  workspace.succeed("resegment q.family GR1 --to grazing-curve -o curve ICP=[d,f]");
  workspace.succeed("run pair -q -c curve -s curve -o grazing NMX=10");
  CHECK(pairs_of(workspace, "grazing", "d", "f").size() == 10);
  workspace.succeed("verify grazing -p pair");
}
