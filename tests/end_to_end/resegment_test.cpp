// tchat resegment on the linear oscillator: contacts on and off the section, rotation, doubling, and what it refuses.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

#include "end_to_end/bad_input.hpp"

using namespace test_support;

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double zeta = 0.05;

double grazing_alpha(double omega) { return std::hypot(1.0 - omega * omega, 2.0 * zeta * omega); }

/// The forced response x1 = A cos(omega t - phi) from its minimum on: m segments between minima and maxima.
void write_response(const Workspace& workspace, const std::string& name, double alpha, double omega, int m) {
  const double phi = std::atan2(2.0 * zeta * omega, 1.0 - omega * omega);
  const double amplitude = alpha / grazing_alpha(omega);
  std::string text = fmt::format("# PAR(1) = {:.15g}\n# PAR(2) = {:.15g}\n", alpha, omega);
  for (int s = 0; s < m; ++s) text += fmt::format("# PAR({}) = {:.15g}\n", 61 + s, 2.0 * pi / omega / m);
  for (int k = 0; k <= 60; ++k) {
    text += fmt::format("{:.15g}", k / 60.0);
    for (int s = 0; s < m; ++s) {
      const double angle = phi + pi + 2.0 * pi / m * (s + k / 60.0);  // omega t
      text += fmt::format(" {:.15g} {:.15g} {:.15g} {:.15g}", amplitude * std::cos(angle - phi),
                          -amplitude * omega * std::sin(angle - phi), std::sin(angle), std::cos(angle));
    }
    text += '\n';
  }
  workspace.write(name + ".dat", text);
}

const std::string common =
    "NDIM = 4, IPS = 180, NTST = 40, NCOL = 4, EPSL = 1e-10, EPSU = 1e-10, EPSS = 1e-10, NPR = 0, DS = 0.02, DSMAX = "
    "0.2\n";

/// {(1,3,2)}: cut at the minimum, so that the contact is inside. Ends at GR, alpha = grazing_alpha(2).
void run_to_contact_inside(const Workspace& workspace) {
  write_response(workspace, "inside", 2.9, 2.0, 1);
  workspace.write("gc.inside", common +
                                   "ICP = [1, 61], NMX = 30, RL1 = 3.5\nGCFIND = [1], GCHIND = [3], GCGIND = [2], "
                                   "GCSEGTYP = [0], GCHGRZIND = [[1]], GCIPSI = [1]\n");
  workspace.run("-c inside -d inside -o inside");
}

Outcome resegment(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat("resegment " + arguments + " -p linosc");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  return outcome;
}

using Multipliers = std::vector<std::complex<double>>;

Multipliers first_multipliers(const std::string& diagnostics) {
  Multipliers values;
  const auto end = diagnostics.find(std::string(47, '='));
  for (auto at = diagnostics.find("   Multiplier"); at < end; at = diagnostics.find("   Multiplier", at + 1)) {
    const auto words = words_of(diagnostics.substr(at, 80));
    values.emplace_back(std::stod(words.at(2)), std::stod(words.at(3)));
  }
  return values;
}

double nearest(const Multipliers& values, std::complex<double> wanted) {
  REQUIRE_FALSE(values.empty());
  double distance = 1e9;
  for (const auto& mu : values) distance = std::min(distance, std::abs(mu - wanted));
  return distance;
}

double first_value(const Workspace& workspace, const std::string& name, const std::string& column) {
  const auto sections = workspace.points(name);
  return sections.front().rows.front().values[sections.front().column(column)];
}

int iterations(const Workspace& workspace, const std::string& name) {
  const std::string text = workspace.read("d." + name);
  return std::stoi(text.substr(text.find("Iterations   :") + 14));
}

}  // namespace

TEST_CASE("resegment: a contact inside the segment cuts it in two, both ways on converge") {
  const Workspace workspace;
  run_to_contact_inside(workspace);
  const Outcome outcome = resegment(workspace, "q.inside GR1 --to grazing-curve -o curve");
  CHECK(contains(outcome.out, "{(1,3,2)}"));
  CHECK(contains(outcome.out, "{(1,1,2), (1,3,2)}, IPS = 150"));
  workspace.run("-c curve -s curve -o curve1 NMX=5");
  CHECK(iterations(workspace, "curve1") <= 3);
  CHECK(std::abs(first_value(workspace, "curve1", "alpha") - grazing_alpha(2.0)) < 1e-9);
  CHECK(std::abs(first_value(workspace, "curve1", "PAR(61)") - pi / 2) < 1e-9);
  const auto rows = rows_of(workspace.points("curve1"));
  const auto sections = workspace.points("curve1");
  for (const PointRow& row : rows)
    CHECK(std::abs(row.values[sections.front().column("alpha")] -
                   grazing_alpha(row.values[sections.front().column("omega")])) < 1e-9);

  resegment(workspace, "q.inside GR1 --to impacting -o born NMX=5");
  CHECK(contains(workspace.read("gc.born"), "GCHIND = [1, 3]"));
  workspace.run("-c born -s born -o born1");
  CHECK(iterations(workspace, "born1") <= 3);
  CHECK_FALSE(contains(workspace.read("d.born1"), "Inadmissible"));
  workspace.run("-c born -s born -o born2 DS=-0.02 GRSTOP=0");  // the other side, which the wall forbids
  CHECK(contains(workspace.read("d.born2"), "Inadmissible"));
}

TEST_CASE("resegment: DS leads to the side with impacts, whatever its sign was") {
  const Workspace workspace;
  run_to_contact_inside(workspace);
  for (const std::string extra : {"", " --dat"}) {
    for (const std::string step : {"0.02", "-0.02"}) {
      CAPTURE(extra, step);
      workspace.write("gc.signed", workspace.tchat("constants r.inside DS=" + step).out);
      const Outcome outcome = resegment(workspace, "q.inside GR1 --to impacting -c signed -o born NMX=5" + extra);
      CHECK(contains(outcome.out, "DS = 0.02 leads to the side with the new event"));
      workspace.run(std::string("-c born ") + (extra.empty() ? "-s" : "-d") + " born -o born1");
      CHECK_FALSE(contains(workspace.read("d.born1"), "Inadmissible"));
    }
  }
  const Outcome given = resegment(workspace, "q.inside GR1 --to impacting -o born DS=-0.01");  // the user's own choice
  CHECK(contains(given.out, "DS = -0.01 leads to the side where the orbit is inadmissible"));
  CHECK(contains(workspace.read("gc.born"), "DS = -0.01"));
}

TEST_CASE("resegment: a contact on the section replaces it, from data as well") {
  const Workspace workspace;
  workspace.run("-c to_grazing -d nonimpacting -o grazing");
  const Outcome outcome = resegment(workspace, "q.grazing GR1 --to grazing-curve -o curve");
  CHECK(contains(outcome.out, "-> {(1,1,2)}, IPS = 150"));
  workspace.run("-c curve -s curve -o curve1 NMX=3");
  CHECK(std::abs(first_value(workspace, "curve1", "omega") - 1.998333565522409) < 1e-10);

  resegment(workspace, "q.grazing GR1 --to impacting -o born --dat ICP=[1,61] DS=0.01 NMX=5");
  CHECK(workspace.has("born.dat"));
  CHECK_FALSE(workspace.has("q.born"));
  workspace.run("-c born -d born -o born1");
  CHECK(iterations(workspace, "born1") <= 3);
  CHECK(std::abs(first_value(workspace, "born1", "alpha") - 3.0) < 1e-9);

  // Back from there: the impact's velocity vanishes, and the grazing curve is without it.
  workspace.run("-c born -s born1 -o back IRS=EP2 DS=-0.02 NMX=60");
  resegment(workspace, "q.back GR1 --to grazing-curve -o again");
  CHECK(contains(workspace.read("gc.again"), "IPS = 150"));
  workspace.run("-c again -s again -o again1 NMX=2");
  CHECK(std::abs(first_value(workspace, "again1", "alpha") - 3.0) < 1e-7);
  check_refused(workspace.tchat("resegment q.back GR1 --to impacting -o none -p linosc"), {"its own branch"});
}

TEST_CASE("resegment: a direction goes on only into a problem with the same free parameters") {
  const Workspace workspace;
  workspace.run("-c to_grazing -d nonimpacting -o grazing");
  workspace.run("-c grazing_curve -s grazing -o curve");
  // Tangents of the grazing curve, which two parameters span, are none of the impacting orbits.
  for (const std::string& label : {std::string("XI1"), std::string("UZ1")})
    for (const std::string& free : {std::string("ICP=[1,61]"), std::string("ICP=[2,61]")}) {
      CAPTURE(label, free);
      const Outcome outcome = resegment(workspace, "q.curve " + label + " --to impacting -o born NMX=3 " + free);
      CHECK(workspace.solutions("born").front().parameter_direction.empty());
      CHECK(contains(outcome.out, "leads to the side with the new event"));
      workspace.run("-c born -s born -o born1");
      CHECK_FALSE(contains(workspace.read("d.born1"), "Inadmissible"));
    }
  // Along the curve it stays, whatever the order of the parameters; another pair has none.
  resegment(workspace, "q.curve UZ1 --to rotate -o same");
  CHECK(workspace.solutions("same").front().parameter_direction ==
        with_label(workspace.solutions("curve"), 4).parameter_direction);
  resegment(workspace, "q.curve UZ1 --to rotate -o swapped ICP=[1,2,61]");
  const auto same = workspace.solutions("same").front().parameter_direction;
  const auto swapped = workspace.solutions("swapped").front().parameter_direction;
  CHECK(swapped == std::vector<double>{same[1], same[0], same[2]});
  resegment(workspace, "q.curve UZ1 --to rotate -o other ICP=[1,3,61]");
  CHECK(workspace.solutions("other").front().parameter_direction.empty());
}

TEST_CASE("resegment: rotation keeps multipliers, states and the direction") {
  const Workspace workspace;
  write_response(workspace, "two", 2.0, 2.0, 2);
  workspace.write("gc.two", common +
                                "ICP = [1, 61, 62], NMX = 3\nGCFIND = [1, 1], GCHIND = [2, 3], GCGIND = [2, 2], "
                                "GCSEGTYP = [0, 0], GCHGRZIND = [[1], []], GCIPSI = [1]\n");
  workspace.run("-c two -d two -o two");
  resegment(workspace, "q.two EP1 --to rotate -o rotated");
  const auto before = workspace.solutions("two").front();
  const auto after = workspace.solutions("rotated").front();
  for (std::size_t k = 0; k < before.t.size(); ++k)
    for (std::size_t i = 0; i < 4; ++i) {
      CHECK(after.states[k][i] == before.states[k][4 + i]);
      CHECK(after.states[k][4 + i] == before.states[k][i]);
      CHECK(after.direction[k][i] == before.direction[k][4 + i]);
    }
  workspace.run("-c rotated -s rotated -o rotated1");
  CHECK(iterations(workspace, "rotated1") <= 1);
  const Multipliers original = first_multipliers(workspace.read("d.two"));
  const Multipliers turned = first_multipliers(workspace.read("d.rotated1"));
  REQUIRE(original.size() == 4);
  // The response's own multipliers: exp(-zeta T) turned by omega_d T, and the forcing's exp(-2 T).
  const double T = pi;
  const std::complex<double> mu = std::polar(std::exp(-zeta * T), std::sqrt(1.0 - zeta * zeta) * T);
  for (const Multipliers& found : {original, turned}) {
    CHECK(nearest(found, mu) < 1e-8);
    CHECK(nearest(found, std::exp(-2.0 * T)) < 1e-8);
  }
  resegment(workspace, "q.rotated 1 --to rotate --by -1 -c rotated -o home");
  CHECK(workspace.solutions("home").front().states == before.states);
}

TEST_CASE("resegment: the orbit twice over, and the doubled one at a period doubling") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o once NMX=2");
  resegment(workspace, "q.once EP1 --to double -o twice NMX=2");
  workspace.run("-c twice -s twice -o twice1");
  const Multipliers once = first_multipliers(workspace.read("d.once"));
  const Multipliers twice = first_multipliers(workspace.read("d.twice1"));
  for (const auto& mu : once) CHECK(nearest(twice, mu * mu) < 1e-7);
  CHECK(std::abs(first_value(workspace, "twice1", "PERIOD") - 4.0 * pi / 2.0072) < 1e-8);

  workspace.run("-c to_grazing -d nonimpacting -o grazing");
  workspace.run("-c grazing_curve -s grazing -o grazing_curve --both");
  workspace.run("-c impacting_20072 -s grazing_curve -o impacting_20072");
  const Outcome outcome = resegment(workspace, "q.impacting_20072 PD1 --to double -o doubled NMX=5 DS=0.01");
  CHECK(contains(outcome.out, "ISW = -1"));
  workspace.run("-c doubled -s doubled -o doubled1");
  const auto last = workspace.solutions("doubled1").back();
  CHECK(last.parameter(1) < 3.03619);                                     // the doubled orbit lives below the doubling
  CHECK(std::abs(last.states.back()[1] - last.states.back()[5]) > 1e-3);  // two different impacts

  // Every label of a curve of period doublings is one.
  workspace.run("-c period_doubling_curve -s impacting_20072 -o curve NMX=4");
  resegment(workspace, "q.curve EP1 --to double -o from_curve ICP=[1,61,62] NMX=3 DS=0.01");
  CHECK(contains(workspace.read("gc.from_curve"), "ISW = -1"));
  workspace.run("-c from_curve -s from_curve -o doubled2");
  const auto other = workspace.solutions("doubled2").back();
  CHECK(std::abs(other.states.back()[1] - other.states.back()[5]) > 1e-4);
}

TEST_CASE("resegment: equal calls write equal files, old ones are kept") {
  const Workspace workspace;
  run_to_contact_inside(workspace);
  resegment(workspace, "q.inside GR1 --to grazing-curve -o a");
  resegment(workspace, "q.inside GR1 --to grazing-curve -o b");
  CHECK(workspace.read("q.a") == workspace.read("q.b"));
  CHECK(workspace.read("gc.a") == workspace.read("gc.b"));
  resegment(workspace, "q.inside GR1 --to rotate -o a -q");
  CHECK(workspace.read("q.a~") == workspace.read("q.b"));
  CHECK(workspace.read("gc.a~") == workspace.read("gc.b"));
}

TEST_CASE("a contact that falls on a user value has both names") {
  const Workspace workspace;
  write_response(workspace, "inside", 2.9, 2.0, 1);
  run_to_contact_inside(workspace);
  const std::string value = fmt::format("UZR={{1: [{:.15g}]}}", grazing_alpha(2.0));
  const auto run_to = [&](const std::string& stop) {
    std::vector<std::string> words = words_of("-c inside -d inside -o both GRSTOP=0 STOP=[" + stop + "]");
    words.push_back(value);
    return workspace.run(words);
  };
  const Outcome run = run_to("GR1");
  CHECK(run.out.find("GR UZ label") != std::string::npos);
  CHECK(run.out.find("user value alpha") != std::string::npos);
  CHECK(rows_of(workspace.points("both")).back().values.front() == Approx(grazing_alpha(2.0)).epsilon(1e-9));
  const std::string table = workspace.tchat("labels q.both").out;
  CHECK(table.find("inside segment 1") != std::string::npos);
  CHECK(table.find("user value alpha") != std::string::npos);
  for (const std::string name : {"GR1", "UZ1"}) {
    CAPTURE(name);
    workspace.run("-c inside -s both -o again NMX=2 GRSTOP=0 IRS=" + name);
    const std::string made =
        resegment(workspace, "q.both " + name + " --to grazing-curve -o curve ICP=[1,2,61,62]").out;
    CHECK(made.find("contact inside segment 1") != std::string::npos);
    CHECK(workspace.tchat("labels q.curve").out.find("those of ICP") != std::string::npos);
  }
  // Either name ends the branch there.
  run_to("UZ1");
  CHECK(rows_of(workspace.points("both")).back().values.front() == Approx(grazing_alpha(2.0)).epsilon(1e-9));
}

TEST_CASE("resegment refuses what makes no sense") {
  const Workspace workspace;
  run_to_contact_inside(workspace);
  workspace.write("gc.other", "NDIM = 4, IPS = 150, ICP = [1, 2, 61]\nGCFIND = [1], GCHIND = [1], GCGIND = [2]\n");
  const std::string end = " -p linosc -o none ";
  struct Case {
    std::string arguments;
    std::vector<std::string> expected;
  };
  const std::vector<Case> table{
      {"q.inside EP1 --to impacting" + end, {"q.inside", "label 1", "no grazing point", "EP", "GR"}},
      {"q.inside 99 --to rotate" + end, {"q.inside", "no label 99", "GR"}},
      {"q.inside PD1 --to double" + end, {"q.inside", "PD1"}},
      {"q.inside %% --to rotate" + end, {"'%%'", "no label", "GR1"}},
      {"q.inside GR1 --to elsewhere" + end, {"'elsewhere'", "grazing-curve", "impacting", "rotate", "double"}},
      {"q.inside GR1" + end, {"--to"}},
      {"q.inside GR1 --to rotate -p linosc", {"--output"}},
      {"q.nowhere GR1 --to rotate" + end, {"nowhere"}},
      {"q.inside GR1 --to rotate -c nowhere" + end, {"nowhere"}},
      {"q.inside GR1 --to rotate -c other" + end, {"IPS = 180", "IPS = 150", "-c"}},
      {"q.inside GR1 --to grazing-curve --signature 1,1,2" + end, {"1 index vectors", "2 segments"}},
      {"q.inside GR1 --to grazing-curve --signature 1,1,2;1,3,2;1,1,1" + end, {"3 index vectors", "2 segments"}},
      {"q.inside GR1 --to impacting --signature 1,1,9;1,3,2" + end, {"GCGIND", "9", "1..2"}},
      {"q.inside GR1 --to impacting --signature 1,2,1;1,3,2" + end, {"event 2", "contact with event 1"}},
      {"q.inside GR1 --to impacting --signature 2,1,1;1,3,2" + end, {"field 2", "field 1"}},
      {"q.inside GR1 --to impacting --signature 1,1,1;1,1,2" + end, {"does not fit", "segment 2", "wall"}},
      {"q.inside GR1 --to impacting --signature 1,1" + end, {"--signature", "2 numbers"}},
      {"q.inside GR1 --to grazing-curve --jump 9" + end, {"--jump", "9", "1..2"}},
      {"q.inside GR1 --to impacting GRJUMP=0" + end, {"GRJUMP"}},
      {"q.inside GR1 --to impacting DS=0" + end, {"DS"}},
      {"q.inside GR1 --to impacting PAR(2)=3" + end, {"PAR"}},
      {"q.inside GR1 --to rotate -p linosc -o inside", {"q.inside", "-o"}},
      {"q.inside GR1 --to rotate -p nothing -o none", {"nothing"}},
  };
  for (const Case& c : table) {
    INFO(c.arguments);
    check_refused(workspace.tchat("resegment " + c.arguments), c.expected);
    CHECK_FALSE(workspace.has("q.none"));
    CHECK_FALSE(workspace.has("gc.none"));
  }
}
