// What else is done with labels of tori: composite maps beside those of simulated points and beside simulation, angles
// that wind, verification, exponents, pictures, and what a user does wrong.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <regex>
#include <sstream>

#include "end_to_end/bad_input.hpp"
#include "published/chain.hpp"
#include "simulate/sweep_file.hpp"

using namespace test_support;

namespace {

constexpr int rho = 60;
constexpr const char* angles_of_forcing =
    "NDIM = 3, IPS = 182, IRS = 1\n"
    "ICP = [mu, rho]\n"
    "NTST = 20, NCOL = 5, IAD = 0, NMX = 40, RL0 = 2.3, RL1 = 6\n"
    "EPSL = 1e-10, EPSU = 1e-10, EPSS = 1e-9, DS = -0.02, DSMAX = 0.2\n";
constexpr const char* one_segment = "GCFIND = [1], GCSEGTYP = [0], GCHGRZIND = [[1]], GCIPSI = [1]\n";

std::string done(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat(arguments);
  INFO(arguments << '\n' << outcome.text());
  REQUIRE(outcome.status == 0);
  return outcome.text();
}

/// fvdp on the section where its forcing ends a revolution (event 4, which takes 2 pi off), or where x1 is at a maximum
/// (event 2: the angle winds).
void enter_fvdp(const Workspace& workspace) {
  std::filesystem::copy_file(FVDP_LIBRARY, workspace.file("fvdp.so"));
  workspace.write("gc.revolution", std::string(angles_of_forcing) + one_segment + "GCHIND = [4], GCGIND = [3]\n");
  workspace.write("gc.maximum", std::string(angles_of_forcing) + one_segment + "GCHIND = [2], GCGIND = [2]\n");
}

void enter_torus(const Workspace& workspace) {
  std::filesystem::copy_file(TORUS_LIBRARY, workspace.file("torus.so"));
  std::filesystem::copy_file(CONSTANTS "/torus/gc.torus", workspace.file("gc.torus"));
}

void enter_langford(const Workspace& workspace) {
  std::filesystem::copy_file(LANGFORD_LIBRARY, workspace.file("langford.so"));
  for (const char* name : {"gc.langford", "langford.dat"})
    std::filesystem::copy_file(std::string(LANGFORD_CONSTANTS "/") + name, workspace.file(name));
}

std::string run_to_contact(const Workspace& workspace) {
  done(workspace, "simulate fvdp -c revolution --follow-signature --torus found");
  return done(workspace, "run fvdp -c revolution -s found -o contact HARMTOL=1e-9");
}

double mean_return_time(const SolutionEntry& solution, int segments_per_return, int dimension) {
  const auto orbits = static_cast<int>(solution.states.front().size()) / (segments_per_return * dimension);
  double time = 0.0;
  for (int k = 1; k <= orbits * segments_per_return; ++k) time += solution.parameter(60 + k);
  return time / orbits;
}

/// A column where the swept value is the index-th.
std::vector<double> of_value(const tchat::SweepTable& table, double index, const char* column) {
  std::vector<double> values;
  for (std::size_t i = 0; i < table.rows(); ++i)
    if ((*table.column("index"))[i] == index) values.push_back((*table.column(column))[i]);
  return values;
}

}  // namespace

TEST_CASE("map of a torus's label: mu*, rho, and what follows behind grazing, beside simulated points and the flow") {
  const Workspace workspace;
  enter_fvdp(workspace);
  run_to_contact(workspace);
  const SolutionEntry contact = only(workspace, "contact", "GR");
  CHECK(std::abs(contact.parameter(1) - 2.405381704) < 1e-9);

  const std::string over = " --over mu=2.4052:2.4048:3";
  const std::string text =
      done(workspace, "sweep fvdp --map q.contact:GR1 --order exact --smooth-order 2" + over + " -o label");
  CHECK(text.find("Invariant curve of label") != std::string::npos);
  CHECK(text.find("The torus touches wall at mu = 2.405381704") != std::string::npos);
  done(workspace, "simulate fvdp -q PAR(mu)=5 --transient-time 300 --events 5000 --tolerance 1e-12 --rows 0 -o points");
  done(workspace, "sweep fvdp -q --map points.events PAR(mu)=5 --order exact --smooth-order 2" + over + " -o points");
  done(workspace,
       "sweep fvdp -q --penetration wall --transient-events 3000 --events 60 --section 2" + over + " -o flow");
  const tchat::SweepTable label = tchat::read_sweep_file(workspace.file("label.sweep"));
  const tchat::SweepTable points = tchat::read_sweep_file(workspace.file("points.sweep"));
  const tchat::SweepTable flow = tchat::read_sweep_file(workspace.file("flow.sweep"));
  for (const double index : {0.0, 1.0, 2.0}) {
    CAPTURE(index);
    const auto deepest = [index](const tchat::SweepTable& table) {
      const std::vector<double> values = of_value(table, index, "penetration");
      return *std::max_element(values.begin(), values.end());
    };
    const auto time = [index](const tchat::SweepTable& table) { return of_value(table, index, "time").front(); };
    // One impact in two returns. The maps differ by what the points and HARMTOL leave open; the flow from both by what
    // a map of second order leaves out at 3e-4 behind the wall, its time by that of the curve beside the orbit.
    REQUIRE(of_value(label, index, "impacts").front() == 1.0);
    CHECK(deepest(label) > 3e-4);
    CHECK(std::abs(deepest(label) - deepest(points)) < 1e-10);
    CHECK(std::abs(time(label) - time(points)) < 1e-8);
    CHECK(deepest(label) == Approx(deepest(flow)).epsilon(3e-4));
    CHECK(time(label) == Approx(time(flow)).epsilon(3e-3));
  }

  const std::string reduced =
      done(workspace, "sweep fvdp --map q.contact:GR1 --reduced ellipse --over mu=2.4054:2.4054:1 -o reduced");
  CHECK(reduced.find("quasi-periodic, 1 times") != std::string::npos);
  check_refused(workspace.tchat("sweep fvdp --map q.contact:GR1 --section 3" + over + " -o no"),
                {"--section 3", "no segment of the return", "leave --section out for P"});
  check_refused(workspace.tchat("sweep fvdp --map q.contact:GR1 --section 4" + over + " -o no"),
                {"--section 4", "jump 3 (less 2 pi)", "where nothing happens"});
  check_refused(workspace.tchat("sweep fvdp --map q.contact:GR1 --over A=0.7:0.8:3 -o no"), {"does not depend on A"});
}

TEST_CASE("torus of a forced oscillator on a section where its angle winds: the same torus, rho by the frequencies") {
  const Workspace workspace;
  enter_fvdp(workspace);
  done(workspace, "simulate fvdp -c maximum --follow-signature --torus found");
  done(workspace, "run fvdp -c maximum -s found -o torus NHARM=45 HARMTOL=0 NMX=1 PAR(mu)=2.45");
  const SolutionEntry torus = workspace.solutions("torus").front();
  // The phase of the forcing is the angle of the torus: it goes omega T further in a return, whole turns aside.
  const double turns = 1.505 * mean_return_time(torus, 1, 3) / (2.0 * M_PI);
  CHECK(std::abs(std::remainder(torus.parameter(rho) - turns, 1.0)) < 1e-8);
  CHECK(std::abs(torus.parameter(rho) - 0.5052579495) < 1e-9);  // of the weighted means of 1e5 points
  CHECK(done(workspace, "verify q.torus -p fvdp --tolerance 1e-5").find("agrees with forward") != std::string::npos);
}

TEST_CASE("simulate --torus with a signature in place of constants: its constants watch what may come next") {
  const Workspace workspace;
  enter_fvdp(workspace);
  const std::string plain = done(workspace, "simulate fvdp --events 2000");
  CHECK(plain.find("quasi-periodic (--torus)") != std::string::npos);
  done(workspace, "simulate fvdp --torus found --signature 1,2,2");
  CHECK(workspace.read("gc.found").find("GCHGRZIND = [[1]]") != std::string::npos);
  const std::string text = done(workspace, "run fvdp -c found -s found -o torus ICP=[mu,rho] RL0=2.3 DS=-0.02");
  CHECK(text.find("warning") == std::string::npos);
  // mu* of simulation and of other sections (tori_at_walls_test.cpp).
  const SolutionEntry contact = workspace.solutions("torus").back();
  CHECK(text.find("GR label 2") != std::string::npos);
  CHECK(std::abs(contact.parameter(1) - 2.405381704) < 1e-6);
}

TEST_CASE("verify: returns from a torus's label land on its curve, and not with too few harmonics") {
  const Workspace workspace;
  enter_torus(workspace);
  done(workspace, "simulate torus -c torus --torus found");
  done(workspace, "run torus -q -c torus -s found -o right NMX=1 HARMTOL=1e-9");
  const std::string text = done(workspace, "verify q.right -p torus");
  CHECK(text.find("half way between") != std::string::npos);
  // Another second digit of the first multiplier across the torus, 0.02 or so: by 1e-4 or more.
  std::string diagnostics = workspace.read("d.right");
  const std::size_t line = diagnostics.find("   Multiplier   2");
  REQUIRE(line != std::string::npos);
  char& digit = diagnostics.at(diagnostics.find('.', line) + 2);
  digit = digit == '5' ? '4' : '5';
  workspace.write("d.right", diagnostics);
  const Outcome changed = workspace.tchat("verify q.right -p torus");
  CHECK(changed.status == 1);
  CHECK(changed.text().find("<< multipliers") != std::string::npos);
  // 0.414^6: the N orbits solve their equations all the same.
  done(workspace, "run torus -q -c torus -s found -o rough NMX=1 NHARM=6 HARMTOL=0");
  const Outcome rough = workspace.tchat("verify q.rough -p torus");
  CHECK(rough.status == 1);
  CHECK(rough.text().find("<< state") != std::string::npos);
}

TEST_CASE("normal multipliers of an attracting torus are the Lyapunov exponents of a simulation on it") {
  const Workspace workspace;
  enter_langford(workspace);
  done(workspace, "simulate langford -c langford --state 1,0,0.7 PAR(a)=0.76 PAR(f)=0.03 --torus found");
  done(workspace, "run langford -c found -s found -o torus NMX=1");
  const SolutionEntry torus = workspace.solutions("torus").front();
  const double time = mean_return_time(torus, 1, 3);
  double least = 1.0;
  for (const auto& mu : with_label(read_diagnostics(workspace.read("d.torus")), torus.label).multipliers)
    if (std::abs(mu) > 1e-12) least = std::min(least, std::abs(mu));
  const std::string text = done(workspace,
                                "simulate langford --state 1,0,0.7 PAR(a)=0.76 PAR(f)=0.03 --lyapunov "
                                "--transient-time 500 --time 20000 --rows 0 -o exponents");
  INFO(text);
  double exponent = 0.0, bar = 0.0;
  int number = 0;
  std::istringstream lines(text);
  for (std::string line; number != 3 && std::getline(lines, line);)
    if (std::sscanf(line.c_str(), " %d %lf +- %lf", &number, &exponent, &bar) != 3) number = 0;
  REQUIRE(number == 3);
  CHECK(bar < 1e-3);
  CHECK(std::abs(exponent - std::log(least) / time) < std::max(3.0 * bar, 1e-5));
}

TEST_CASE("pictures of tori: the bundle by its angle, the curve on the section with the wall, rho") {
  const Workspace workspace;
  enter_fvdp(workspace);
  workspace.write("gc.phase", std::string(angles_of_forcing) +
                                  "GCFIND = [1, 1], GCHIND = [4, 3], GCGIND = [3, 2], GCSEGTYP = [0, 0]\n"
                                  "GCHGRZIND = [[1], [1]], GCIPSI = [1, 2]\n");
  done(workspace, "simulate fvdp -c phase --follow-signature --torus found PAR(phase)=2.9236850974");
  done(workspace, "run fvdp -q -c phase -s found -o torus HARMTOL=1e-7 PAR(phase)=2.9236850974");
  done(workspace, "plot q.torus GR1 --section -p fvdp -o section.svg --script section.gp");
  const std::string section = workspace.read("section.gp");
  CHECK(section.find("computed points on the section") != std::string::npos);
  CHECK(section.find("wall") != std::string::npos);
  CHECK(section.find("PAR(60)") == std::string::npos);
  done(workspace, "plot q.torus GR1 -x x1 -y x2 -o bundle.svg");
  done(workspace, "plot q.torus GR1 -x x1 -y x2 -z x3 -o space.svg");
  done(workspace, "plot p.torus -y rho -o rho.svg");
  for (const char* name : {"section.svg", "bundle.svg", "space.svg", "rho.svg"}) CHECK(workspace.has(name));
  check_refused(workspace.tchat("plot p.torus --section -o no.svg"), {"--section", "q-file and labels"});
  check_refused(workspace.tchat("plot q.torus GR1 --section --time -o no.svg"), {"--section", "--time"});
}

TEST_CASE("tori that are not there, labels that are none: a sentence with the cure") {
  const Workspace workspace;
  enter_torus(workspace);
  enter_langford(workspace);
  const auto refused = [&](const std::string& arguments, const std::vector<std::string>& parts) {
    INFO(arguments);
    check_refused(workspace.tchat(arguments), parts);
  };
  // A periodic orbit, of one return; nearly reached, and reached.
  refused("simulate langford -c langford --state 1,0,0.7 PAR(a)=0.5 --torus no",
          {"periodic orbit", "every point", "--dat"});
  done(workspace, "simulate torus -c torus --torus found");
  done(workspace, "run torus -q -c torus -s found -o torus NMX=2");
  refused("run torus -c torus -s torus -o no IRS=EP1 GCHIND=[2]",
          {"the signature is another one than that of label", "event 2 (wall)", "-c r.NAME"});
  refused("run torus -c torus -s torus -o no IRS=EP1 IPS=180 ICP=[omega]", {"is a torus (IPS = 182)", "IPS = 152"});
  refused("run torus -c torus -s torus -o no IRS=EP1 ICP=[omega]", {"at least 2", "rho, the rotation number"});
  refused("grazing q.torus EP1 -p torus", {"is a torus (IPS = 182)", "sweep --map"});
  refused("run langford -c langford -d langford IPS=182 ICP=[a,rho] -o no", {"does not start from data", "--torus"});
  refused("sweep torus --map q.torus:EP1 --over mu=1:2:3 -o no", {"is the identity"});
  done(workspace, "run langford -q");
  refused("plot q.langford 1 --section -o no.png", {"is no torus", "leave --section out"});
}

TEST_CASE("a torus on its way into a tongue: as many harmonics as there may be, the fraction is named") {
  const Workspace workspace;
  enter_langford(workspace);
  done(workspace, "run langford -q");
  // Where the lines of the sentence end depends on its numbers.
  const std::string text = std::regex_replace(
      done(workspace,
           "run langford -s langford -o tori IRS=TR1 IPS=182 ISW=-1 ICP=[a,rho] DS=0.05 DSMAX=0.1 NMX=40 PAR(f)=0.03"),
      std::regex("\\s+"), " ");
  INFO(text);
  CHECK(text.find("it is about to lose its smoothness, or locks to a periodic") != std::string::npos);
  CHECK(text.find("near 1/3") != std::string::npos);
  CHECK(text.find("mesh is too coarse") == std::string::npos);
}
