// Simulation hands over to continuation: the orbit that tchat simulate recognises is one that tchat run accepts as it
// is, in at most 4 Newton steps, and it is the published one.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "end_to_end/bad_input.hpp"
#include "published/chain.hpp"

using namespace test_support;
namespace fs = std::filesystem;

namespace {

/// What is known of the orbit without this program: by shooting, or from a closed form; NaN is not looked at.
struct Example {
  std::string name, arguments, signature;
  double period;
  std::vector<std::complex<double>> multipliers;
};

constexpr double pi = 3.14159265358979323846;

void simulate_and_run(const Workspace& workspace, const std::string& problem, const Example& example) {
  INFO("tchat simulate " << problem << ' ' << example.arguments);
  const Outcome simulated = workspace.tchat("simulate " + problem + " " + example.arguments + " --dat found");
  INFO(simulated.text());
  REQUIRE(simulated.status == 0);
  CHECK(simulated.err.empty());
  CHECK(simulated.out.find("signature " + example.signature + ",") != std::string::npos);

  const Outcome run = workspace.tchat("run " + problem + " -c found -d found -o onward NMX=3 IID=2");
  INFO(run.text());
  REQUIRE(run.status == 0);
  CHECK(run.err.empty());
  const std::string diagnostics = workspace.read("d.onward");
  CHECK(first_iterations(diagnostics) <= 4);

  const auto points = read_diagnostics(diagnostics);
  REQUIRE_FALSE(points.empty());
  CHECK(points.front().point < 0);  // stable: a simulation has settled on it
  for (const auto& mu : example.multipliers) {
    CAPTURE(mu);
    CHECK(distance_to(points.front().multipliers, mu) < 1e-6);
  }
  const SolutionEntry start = workspace.solutions("onward").front();
  double period = 0.0;
  for (const int k : start.free_parameters) period += k >= 61 ? start.parameter(k) : 0.0;
  CHECK(period == Approx(example.period).epsilon(1e-9));
}

void copy_problem(const Workspace& workspace, const std::string& library) {
  fs::copy_file(library, workspace.file(fs::path(library).filename().string()));
}

}  // namespace

TEST_CASE("simulate and run: linosc, nonimpacting and impacting") {
  const Workspace workspace;
  const std::complex<double> smooth(-0.85462940113096, 0.0033582392967611), impact(0.5896957647, 0.34676174832);
  simulate_and_run(workspace, "linosc",
                   {"nonimpacting", "PAR(alpha)=3 PAR(omega)=2", "{(1,2,2)}", pi, {smooth, std::conj(smooth)}});
  simulate_and_run(workspace, "linosc",
                   {"impacting",
                    "PAR(alpha)=3.04852587939213 PAR(omega)=2.0072",
                    "{(1,1,1)}",
                    2.0 * pi / 2.0072,
                    {impact, std::conj(impact)}});
  simulate_and_run(workspace, "linosc",
                   {"one of two that exist there",
                    "PAR(alpha)=2.16507472824774 PAR(omega)=1.8901 --state 1,-6.4,0.93,-0.36",
                    "{(1,1,1)}",
                    2.0 * pi / 1.8901,
                    {0.86018166947, 0.53360388028}});
}

TEST_CASE("simulate and run: mems, nonimpacting and impacting") {
  const Workspace workspace;
  copy_problem(workspace, MEMS_LIBRARY);
  simulate_and_run(
      workspace, "mems",
      {"impacting", "PAR(V)=0.79013593844 PAR(omega)=0.8", "{(1,1,1), (2,2,2)}", pi / 0.8, {0.595826261, 0.352713557}});
  // The section (1,3,3) is no wall; the end of slip, with the identity jump but into another field, is monitored.
  CHECK(contains(workspace.read("gc.found"), "GCHGRZIND = [[1], [1, 2]] "));
  simulate_and_run(workspace, "mems",
                   {"nonimpacting", "PAR(V)=0.58 PAR(omega)=0.8 --state 0,0.37,0,0,1", "{(1,3,3)}", pi / 0.8, {}});
}

TEST_CASE("simulate and run: the MEMS oscillator in Fortran, whose constants file says its sizes") {
  const Workspace workspace;
  fs::copy_file(PROBLEMS "/mems_fortran/mems.f.1", workspace.file("mems.f"));
  check_refused(workspace.tchat("simulate mems"), {"Fortran", "-c"});
  fs::copy_file(PROBLEMS "/mems_fortran/gc.mems.3", workspace.file("gc.mems"));
  simulate_and_run(workspace, "mems",
                   {"impacting",
                    "PAR(1)=0.79013593844 PAR(2)=0.8 --state 0,0.3,0,0,1",
                    "{(1,1,1), (2,2,2)}",
                    pi / 0.8,
                    {0.595826261, 0.352713557}});
}

TEST_CASE("simulate and run: rand3d at both values of m, nonimpacting and impacting") {
  const Workspace workspace;
  copy_problem(workspace, RAND3D_LIBRARY);
  simulate_and_run(workspace, "rand3d",
                   {"m = 0.28", "PAR(m)=0.28", "{(1,2,2)}", 6.725184221523, {0.539641978337, 0.0239214365814}});
  simulate_and_run(workspace, "rand3d",
                   {"m = 0.39", "PAR(m)=0.39", "{(1,2,2)}", 8.063881592814, {0.191866575221, 0.0239300510589}});
}

TEST_CASE("simulate and run: impacting orbits of rand3d") {
  const Workspace workspace;
  copy_problem(workspace, RAND3D_LIBRARY);
  const auto impacting = [&](const std::string& arguments, double v, std::vector<std::complex<double>> multipliers) {
    INFO(arguments);
    const Outcome simulated = workspace.tchat("simulate rand3d " + arguments + " --dat found");
    INFO(simulated.text());
    REQUIRE(simulated.status == 0);
    const Outcome run = workspace.tchat("run rand3d -c found -d found -o onward NMX=1");
    REQUIRE(run.status == 0);
    CHECK(first_iterations(workspace.read("d.onward")) <= 4);
    const auto sections = workspace.points("onward");
    const PointRow& row = sections.front().rows.front();
    CHECK(row.values[sections.front().column("velocity")] == Approx(v).epsilon(1e-8));
    const auto points = read_diagnostics(workspace.read("d.onward"));
    for (const auto& mu : multipliers) CHECK(distance_to(points.front().multipliers, mu) < 1e-7);
  };
  impacting("PAR(m)=0.28 PAR(mu)=-0.799 --state=-0.799,0.337,0.63 --mode 1,1,1", -0.0740432259,
            {0.7238408760, 0.0124287087});
  impacting("PAR(m)=0.39 PAR(mu)=-0.825", -0.0309474007, {-0.7389207535, -0.0041874659});
}

TEST_CASE("simulate and run: rand4d") {
  const Workspace workspace;
  copy_problem(workspace, RAND4D_LIBRARY);
  const double period = 4.0 * pi / 1.9;
  simulate_and_run(workspace, "rand4d",
                   {"mu = -0.4938", "PAR(mu)=-0.4938", "{(1,1,1)}", period, {-0.28719637, -0.08216043, 0.00267411}});
  simulate_and_run(
      workspace, "rand4d",
      {"mu = -0.55", "PAR(mu)=-0.55 --state=-0.55,-0.17,1.3,0.87,-0.49 --mode 1,1,1", "{(1,1,1)}", period, {}});
}

TEST_CASE("simulate and run: Langford's smooth limit cycle, without a constants file") {
  // In cylindrical coordinates an equilibrium z = b, r^2 = (c + a b - b^3/3) / (1 + e b), of rotation d.
  const Workspace workspace;
  copy_problem(workspace, LANGFORD_LIBRARY);
  const double a = 0.5, b = 0.7, d = 3.5, e = 0.25;
  const double r2 = (0.6 + a * b - b * b * b / 3.0) / (1.0 + e * b);
  const double trace = a - b * b - e * r2;
  const double determinant = 2.0 * r2 * (1.0 + e * b);
  const std::complex<double> rate =
      0.5 * trace + std::sqrt(std::complex<double>(0.25 * trace * trace - determinant, 0.0));
  const std::complex<double> mu = std::exp(rate * 2.0 * pi / d);
  simulate_and_run(workspace, "langford", {"cycle", "--state 1,0,1", "{(1,1,1)}", 2.0 * pi / d, {mu, std::conj(mu)}});
}

TEST_CASE("a sweep ends where Newton's method has left all orbits for states on which the flow is too fast") {
  const Workspace workspace;
  copy_problem(workspace, MEMS_LIBRARY);
  const Outcome sweep = workspace.tchat("sweep mems --over V=0.48:0.651:20 --follow up -o up");
  INFO(sweep.text());
  CHECK(sweep.status == 0);
  CHECK(sweep.text().find("first at V = 0.48") != std::string::npos);
}
