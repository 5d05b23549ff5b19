// Extrema of a monitor along families of orbits, from one parameter to six, and gradients at labels: against closed
// forms of a forced oscillator and of the linear impact oscillator.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <sstream>

#include "end_to_end/closed_forms.hpp"
#include "published/chain.hpp"
#include "published/newton.hpp"

using namespace test_support;

namespace {

Outcome succeed(const Workspace& workspace, const std::vector<std::string>& words) {
  const Outcome outcome = workspace.tchat(words);
  INFO(fmt::format("{}\n{}", fmt::join(words, " "), outcome.text()));
  REQUIRE(outcome.status == 0);
  return outcome;
}

/// "Gradient of Q: a 1, b -2; a maximum in ..." of a label, by names.
std::map<std::string, double> gradient(const DiagnosticPoint& point) {
  std::map<std::string, double> result;
  for (const std::string& note : point.notes) {
    const std::size_t at = note.find("Gradient of");
    if (at == std::string::npos) continue;
    const std::size_t from = note.find(':', at) + 1;
    std::istringstream in(note.substr(from, note.find(';', from) - from));
    std::string name, value;
    while (in >> name >> value) result[name] = std::stod(value);
  }
  return result;
}

bool has_note(const DiagnosticPoint& point, const std::string& text) {
  return std::any_of(point.notes.begin(), point.notes.end(),
                     [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

/// x'' + 2 zeta x' + k x = cos(omega t): x has the amplitude 1 / |k - omega^2 + 2 i zeta omega|, and the mean of x^2
/// is half of its square. The other factors of the monitor have their maxima at c = 1, d = 2 and e = -0.5.
constexpr const char* oscillator = R"(par omega=0.8, k=1.2, zeta=0.2, c=0.7, d=1.8, e=-0.1
init x=0.5
x' = v
v' = cos(phi) - 2*zeta*v - k*x
phi' = omega
event turn = 2*pi - phi
jump back: phi -> phi - 2*pi
after any: turn -> back
aux power = x^2 * k^3/(1 + k^4) * zeta^3/(1 + 625*zeta^4) * c/(1 + c^2) * exp(-(d - 2)^2) / (1 + (e + 0.5)^2)
)";

double power(const Eigen::VectorXd& p) {
  const double w = p(0), k = p(1), z = p(2), c = p(3), d = p(4), e = p(5);
  const double square = 1.0 / (std::pow(k - w * w, 2) + std::pow(2.0 * z * w, 2));
  return 0.5 * square * std::pow(k, 3) / (1.0 + std::pow(k, 4)) * std::pow(z, 3) / (1.0 + 625.0 * std::pow(z, 4)) * c /
         (1.0 + c * c) * std::exp(-std::pow(d - 2.0, 2)) / (1.0 + std::pow(e + 0.5, 2));
}

/// By central differences of sixth order.
double derivative(const std::function<double(double)>& f, double at) {
  constexpr double h = 2e-3;
  const auto odd = [&](double step) { return f(at + step) - f(at - step); };
  return (45.0 * odd(h) - 9.0 * odd(2 * h) + odd(3 * h)) / (60.0 * h);
}

double derivative_by(const Eigen::VectorXd& p, int k) {
  const auto along = [&](double value) {
    Eigen::VectorXd q = p;
    q(k) = value;
    return power(q);
  };
  return derivative(along, p(k));
}

Eigen::VectorXd parameters_of(const SolutionEntry& solution, int count) {
  Eigen::VectorXd p(count);
  for (int k = 0; k < count; ++k) p(k) = solution.parameter(k + 1);
  return p;
}

/// d log(power) = 0 in the first `count` parameters, where omega^2 = k - 2 zeta^2.
Eigen::VectorXd stationary(Eigen::VectorXd p, int count) {
  const Eigen::VectorXd inner = newton(p.head(count).eval(), 1e-12, [&](const Eigen::VectorXd& z) {
    const double w = z(0);
    const double k = count > 1 ? z(1) : p(1);
    const double zeta = count > 2 ? z(2) : p(2);
    Eigen::VectorXd defect(count);
    defect(0) = w * w - k + 2.0 * zeta * zeta;
    if (count > 1) defect(1) = 3.0 / k - 4.0 * std::pow(k, 3) / (1.0 + std::pow(k, 4)) - 1.0 / (k - zeta * zeta);
    if (count > 2)
      defect(2) =
          1.0 / zeta - 2500.0 * std::pow(zeta, 3) / (1.0 + 625.0 * std::pow(zeta, 4)) + 2.0 * zeta / (k - zeta * zeta);
    const double rest[] = {1.0, 2.0, -0.5};
    for (int i = 3; i < count; ++i) defect(i) = z(i) - rest[i - 3];
    return defect;
  });
  p.head(count) = inner;
  return p;
}

}  // namespace

TEST_CASE("a mean over the orbit is followed from one parameter to six, to the maximum in all of them") {
  const Workspace workspace;
  workspace.write("osc.tch", oscillator);
  succeed(workspace, {"simulate", "osc", "--dat", "start", "-q"});
  const std::vector<std::string> names = {"omega", "k", "zeta", "c", "d", "e"};
  std::string start = "start";
  for (int count = 1; count <= 6; ++count) {
    const std::string name = fmt::format("free{}", count);
    std::vector<std::string> words{"run",     "osc",       "-c",     "start",  "-o",    name,     "--both",
                                   "DS=0.02", "DSMAX=0.1", "NMX=40", "NPR=10", "RL0=0", "RL1=10", "CLSTOP=0"};
    if (count == 1) words.insert(words.end(), {"-d", "start"});
    if (count > 1) words.insert(words.end(), {"-s", start, "IRS=EX1", fmt::format("ISW={}", count)});
    words.push_back("ICP=[mean(power),omega,k,zeta,c,d,e]");
    const Outcome outcome = succeed(workspace, words);
    INFO(outcome.text());
    const std::vector<SolutionEntry> labels = workspace.solutions(name);
    const std::vector<DiagnosticPoint> points = read_diagnostics(workspace.read("d." + name));
    REQUIRE(of_type(points, "EX").size() == 1);
    REQUIRE(labels.size() > 4);
    for (const SolutionEntry& label : labels) {
      const DiagnosticPoint& point = with_label(points, label.label);
      const Eigen::VectorXd p = parameters_of(label, 6);
      const std::map<std::string, double> known = gradient(point);
      INFO("label " << label.label << " of " << name);
      REQUIRE(known.size() == 6);
      for (int k = 0; k < 6; ++k)  // eight digits are written, and the terms of a derivative are larger than their sum
        CHECK(known.at(names[static_cast<std::size_t>(k)]) == Approx(derivative_by(p, k)).epsilon(1e-7).margin(1e-9));
      // Along the curve it is stationary in all parameters that were before.
      if (count > 1) CHECK((stationary(p, count - 1) - p).norm() < 1e-8);
    }
    const SolutionEntry found = only(workspace, name, "EX");
    const Eigen::VectorXd p = parameters_of(found, 6);
    CHECK((stationary(p, count) - p).norm() < 1e-8);
    CHECK(has_note(of_type(points, "EX").front(),
                   "a maximum in " + fmt::format("{}", fmt::join(names.begin(), names.begin() + count, ", "))));
    CHECK(succeed(workspace, {"verify", name, "EX1"}).status == 0);
    start = name;
  }
}

TEST_CASE("a label that is no extremum in the parameters of a curve is refused with the cure") {
  const Workspace workspace;
  workspace.write("osc.tch", oscillator);
  succeed(workspace, {"simulate", "osc", "--dat", "start", "-q"});
  const Outcome first = succeed(workspace, {"run", "osc", "-c", "start", "-d", "start", "-o", "one", "DS=0.02",
                                            "NMX=60", "RL0=0", "RL1=10", "ICP=[mean(power),omega,k]"});
  CHECK(first.text().find("next: tchat run osc -c r.one -s one IRS=2 ISW=2 'ICP=[mean(power),omega,k]' -o one_EX2") !=
        std::string::npos);
  const auto refused = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"run", "osc", "-c", "r.one", "-s", "one", "-o", "two"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = workspace.tchat(words);
    CHECK(outcome.status != 0);
    return outcome.text();
  };
  CHECK(refused({"IRS=EX1", "ISW=2", "ICP=[mean(power),k,omega]"})
            .find("mean(power) is not stationary in the first parameter of ICP at label 2") != std::string::npos);
  CHECK(refused({"IRS=EX1", "ISW=3", "ICP=[mean(power),omega,k,zeta]"})
            .find("mean(power) is not stationary in the first 2 parameters of ICP at label 2") != std::string::npos);
  CHECK(refused({"IRS=EX1", "ISW=2", "ICP=[omega,k]"}).find("extrema of ICP(1), a monitor (EX)") != std::string::npos);
}

TEST_CASE("impact velocity: gradient and extrema in omega as the closed form has them, a held mean too") {
  const Workspace workspace;
  run_impacting(workspace, "20072");
  const std::string start = std::to_string(workspace.solutions("impacting_20072")[1].label);
  const auto alpha = [](double v, double omega) { return ImpactingOrbit(v, omega, zeta, restitution).alpha(); };
  const auto by_velocity = [&](double v, double w) { return derivative([&](double t) { return alpha(t, w); }, v); };
  const auto by_omega = [&](double v, double w) { return derivative([&](double t) { return alpha(v, t); }, w); };
  const auto run = [&](const std::string& name, std::vector<std::string> words) {
    words.insert(words.begin(), {"-c", "impacting_20072", "-o", name, "UZR={}", "GCIPSI=[]", "ILP=1", "DS=0.02",
                                 "DSMAX=0.1", "NPR=5", "RL0=-20", "RL1=20"});
    workspace.run(words);
    return workspace.solutions(name);
  };
  const auto check_gradients = [&](const std::string& name) {
    const std::vector<DiagnosticPoint> points = read_diagnostics(workspace.read("d." + name));
    int checked = 0;
    for (const SolutionEntry& label : workspace.solutions(name)) {
      const double v = label.states.back().at(1), w = label.parameter(2);
      if (v < 0.5) continue;  // the closed form is not known there: dv/dalpha is large
      const std::map<std::string, double> known = gradient(with_label(points, label.label));
      INFO(name << ", label " << label.label << ", v = " << v);
      // velocity(1) = -v; at alpha fixed dv = -(d alpha/d omega) / (d alpha/d v) d omega
      CHECK(known.at("alpha") == Approx(-1.0 / by_velocity(v, w)).epsilon(1e-6));
      CHECK(known.at("omega") == Approx(by_omega(v, w) / by_velocity(v, w)).epsilon(1e-6).margin(1e-6));
      ++checked;
    }
    CHECK(checked > 5);
  };
  run("along_omega", {"-s", "impacting_20072", "IRS=" + start, "ICP=[velocity(1), omega, alpha]", "NMX=120", "--both"});
  check_gradients("along_omega");
  const std::vector<DiagnosticPoint> extrema = of_type(read_diagnostics(workspace.read("d.along_omega")), "EX");
  REQUIRE(!extrema.empty());
  run("curve", {"-s", "along_omega", "IRS=EX1", "ISW=2", "ICP=[velocity(1), omega, alpha]", "NMX=30"});
  const std::vector<SolutionEntry> curve = workspace.solutions("curve");
  REQUIRE(curve.size() > 4);
  for (const SolutionEntry& label : curve)
    CHECK(std::abs(by_omega(label.states.back().at(1), label.parameter(2))) < 1e-6);
  // mean(x1) = -(1 + r) v omega / (2 pi) held, v is as 1/omega: d(-v)/d omega = v/omega, alpha follows.
  run("held",
      {"-s", "impacting_20072", "IRS=" + start, "ICP=[velocity(1), omega, alpha]", "NMX=20", "HOLD=[mean(x1)]"});
  const std::vector<DiagnosticPoint> held = read_diagnostics(workspace.read("d.held"));
  REQUIRE(held.size() > 3);
  for (const SolutionEntry& label : workspace.solutions("held")) {
    const std::map<std::string, double> known = gradient(with_label(held, label.label));
    CHECK(known.size() == 1);
    CHECK(known.at("omega") == Approx(label.states.back().at(1) / label.parameter(2)).epsilon(1e-7));
  }
}

TEST_CASE("orbits without a section: extrema of the period, and none of what depends on the phase") {
  // x + iy = sqrt(mu) e^{i w t} with w = 1 + (mu - a)^2 + (a - 0.3)^2: the period is stationary in mu at a, in both at
  // 0.3
  const Workspace workspace;
  workspace.write("form.tch", R"(par mu=0.3, a=0.1
init x=0.5, y=0
w = 1 + (mu - a)^2 + (a - 0.3)^2
growth = mu - x^2 - y^2
x' = growth*x - w*y
y' = growth*y + w*x
)");
  workspace.write("gc.form",
                  "NDIM=2, IPS=180\nICP=[period, mu, a]\nGCFIND=[1], GCHIND=[0], GCGIND=[0]\n"
                  "NMX=40, DS=0.02, DSMAX=0.1, RL0=0, RL1=20\n");
  std::string data = "# PAR(1) = 0.3\n# PAR(2) = 0.1\n";
  const double frequency = 1.08;
  for (int k = 0; k <= 100; ++k) {
    const double angle = 2.0 * M_PI * k / 100.0;
    data += fmt::format("{} {} {}\n", angle / frequency, std::sqrt(0.3) * std::cos(angle),
                        std::sqrt(0.3) * std::sin(angle));
  }
  workspace.write("form.dat", data);
  succeed(workspace, {"run", "form", "-o", "one"});
  const SolutionEntry one = only(workspace, "one", "EX");
  CHECK(one.parameter(1) == Approx(0.1).epsilon(1e-8));
  succeed(workspace, {"run", "form", "-s", "one", "IRS=EX1", "ISW=2", "-o", "two"});
  const SolutionEntry two = only(workspace, "two", "EX");
  CHECK(two.parameter(1) == Approx(0.3).epsilon(1e-8));
  CHECK(two.parameter(2) == Approx(0.3).epsilon(1e-8));
  CHECK(two.parameter(61) == Approx(2.0 * M_PI).epsilon(1e-9));
  const std::vector<DiagnosticPoint> points = read_diagnostics(workspace.read("d.one"));
  const std::map<std::string, double> known = gradient(points.front());
  CHECK(known.at("mu") == Approx(-2.0 * M_PI / std::pow(frequency, 2) * 0.4).epsilon(1e-7));
  CHECK(known.at("a") == Approx(2.0 * M_PI / std::pow(frequency, 2) * 0.8).epsilon(1e-7));
  const auto start_of = [&](const std::string& state) {
    return succeed(workspace, {"run", "form", "-s", "one", "IRS=1", "-o", "phase", "ICP=[start(" + state + "),mu,a]",
                               "NMX=3", "RL0=-1", "RL1=1"})
        .text();
  };
  CHECK(start_of("y").find("Gradient of start(y): none, for it depends on the phase of the orbit") !=
        std::string::npos);
  // At the largest x that is sqrt(mu), whatever a is: nothing says that it is an extremum in a.
  CHECK(start_of("x").find("mum in a") == std::string::npos);
}
