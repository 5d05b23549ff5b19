// tchat resegment --to signature: two events at once change places, segments of no duration appear and vanish.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/bad_input.hpp"

using namespace test_support;

namespace {

/// x rises towards 1 until phi = 1, then decays until phi = 2, where phi starts anew: a square-wave drive. Event 2 is a
/// section at phi = p, wherever that lies; event 4 a surface that x may touch while it rises.
const std::string square_wave = R"(#include <array>
#include <vector>
#include <tchat/problem.hpp>
struct SquareWave {
  static constexpr int dimension = 2, parameters = 2, fields = 2, events = 4, jumps = 2;
  static constexpr const char* state_names[] = {"x", "phi"};
  static constexpr const char* parameter_names[] = {"p", "r"};
  static constexpr const char* event_names[] = {"drive off", "section", "drive on", "surface"};
  static constexpr double initial_parameters[] = {0.6, 1.0};
  template <class T> void field(int i, const T* x, const T*, T* f) const {
    f[0] = i == 1 ? 1.0 - x[0] : T(-x[0]);
    f[1] = T(1.0);
  }
  template <class T> T event(int j, const T* x, const T* p) const {
    if (j == 1) return 1.0 - x[1];
    if (j == 2) return p[0] - x[1];
    if (j == 3) return 2.0 - x[1];
    return p[1] - x[0] + 4.0 * (x[1] - 0.5) * (x[1] - 0.5);
  }
  template <class T> void jump(int k, const T* x, const T*, T* g) const {
    g[0] = x[0], g[1] = k == 1 ? x[1] : x[1] - 2.0;
  }
  std::vector<std::array<int, 3>> successors(std::array<int, 3> from) const {
    const bool decays = from == std::array{1, 1, 1} || from == std::array{2, 2, 1};
    if (decays) return {{2, 2, 1}, {2, 3, 2}};
    return {{1, 1, 1}, {1, 2, 1}, {1, 4, 1}};
  }
};
TCHAT_PROBLEM(SquareWave)
)";

const double start_x = 1.0 / (std::exp(1.0) + 1.0);  // x = (1 - 1/e) / (e - 1/e) where phi = 0

double x_at(double phi) {
  return phi <= 1.0 ? 1.0 - (1.0 - start_x) * std::exp(-phi) : x_at(1.0) * std::exp(1.0 - phi);
}

/// The orbit cut at these values of phi, from 0 on; the last one is 2.
void write_orbit(const Workspace& workspace, const std::string& name, double p, double r,
                 const std::vector<double>& cuts) {
  std::string text = fmt::format("# PAR(p) = {:.16g}\n# PAR(r) = {:.16g}\n", p, r);
  double begin = 0.0;
  for (std::size_t s = 0; s < cuts.size(); begin = cuts[s++])
    text += fmt::format("# PAR({}) = {:.16g}\n", 61 + s, cuts[s] - begin);
  for (int k = 0; k <= 40; ++k) {
    text += fmt::format("{}", k / 40.0);
    begin = 0.0;
    for (const double cut : cuts) {
      const double phi = begin + (cut - begin) * k / 40.0;
      text += fmt::format(" {:.16g} {:.16g}", x_at(phi), phi);
      begin = cut;
    }
    text += '\n';
  }
  workspace.write(name + ".dat", text);
}

const std::string common =
    "NDIM = 2, NTST = 20, NCOL = 4, EPSL = 1e-11, EPSU = 1e-11, EPSS = 1e-10, NPR = 0, NMX = 40, DSMAX = 0.1\n";

/// The orbit at p and r, continued up to where the section comes when the drive is switched off: two events at once.
Outcome run_to_two_events(const Workspace& workspace, double p, double r, const std::vector<double>& cuts,
                          const std::string& constants) {
  workspace.write("wave.cpp", square_wave);
  write_orbit(workspace, "wave", p, r, cuts);
  workspace.write("gc.wave", common + constants);
  Outcome outcome = workspace.tchat("run wave -o first");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  CHECK(contains(outcome.out, "two events at once"));
  return outcome;
}

void run_to_two_events(const Workspace& workspace) {
  const Outcome outcome =
      run_to_two_events(workspace, 0.6, 1.0, {0.6, 1.0, 2.0},
                        "IPS = 180, ICP = [p, 61, 62, 63], RL1 = 1.6, DS = 0.05\n"
                        "GCFIND = [1, 1, 2], GCHIND = [2, 1, 3], GCGIND = [1, 1, 2], GCSEGTYP = [0, 0, 1]\n"
                        "GCHGRZIND = [[1], [], []], GCIPSI = [1]\n");
  CHECK(contains(outcome.out, "GR label 2 at p = 1: two events at once"));
}

Outcome resegment(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat("resegment " + arguments + " -p wave");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  return outcome;
}

void run(const Workspace& workspace, const std::string& name) {
  const Outcome outcome = workspace.tchat(fmt::format("run wave -c {0} -s {0} -o {0}1", name));
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  CHECK_FALSE(contains(workspace.read("d." + name + "1"), "nadmissible"));
}

/// Values of a column on all points of a run.
std::vector<double> column(const Workspace& workspace, const std::string& name, const std::string& heading) {
  const auto sections = workspace.points(name);
  std::vector<double> values;
  for (const auto& row : sections.front().rows) values.push_back(row.values[sections.front().column(heading)]);
  return values;
}

}  // namespace

TEST_CASE("resegment --to signature: two events change places, DS leads on") {
  const Workspace workspace;
  run_to_two_events(workspace);
  const Outcome outcome = resegment(workspace, "q.first GR1 --to signature --signature 1,1,1;2,2,1;2,3,2 -o on");
  CHECK(contains(outcome.out, "{(1,2,1), (1,1,1), (2,3,2)}"));
  CHECK(contains(outcome.out, "-> {(1,1,1), (2,2,1), (2,3,2)}, IPS = 180"));
  CHECK(contains(outcome.out, "DS = 0.05 leads to the side with the new segment"));
  CHECK(contains(workspace.read("gc.on"), "GCHGRZIND = [[1], [3], []] "));  // what may end the new segment, no section
  run(workspace, "on");
  const std::vector<double> p = column(workspace, "on1", "p"), first = column(workspace, "on1", "PAR(61)"),
                            second = column(workspace, "on1", "PAR(62)"), most = column(workspace, "on1", "MAX x");
  REQUIRE(p.size() > 5);
  CHECK(p.back() > 1.6);
  for (std::size_t k = 0; k < p.size(); ++k) {
    CHECK(std::abs(first[k] - 1.0) < 1e-9);
    CHECK(std::abs(second[k] - (p[k] - 1.0)) < 1e-9);
    CHECK(std::abs(most[k] - x_at(1.0)) < 1e-9);
  }
  const Outcome given =
      resegment(workspace, "q.first GR1 --to signature --signature 1,1,1;2,2,1;2,3,2 -o back DS=-0.05");
  CHECK(contains(given.out, "DS = -0.05 leads to the side where the orbit is inadmissible"));
  resegment(workspace,
            "q.first GR1 --to signature --signature 2,3,2;1,1,1;2,2,1 -o turned --dat");  // the same, rotated
  CHECK(workspace.tchat("run wave -c turned -d turned -o turned1 NMX=3").status == 0);
  CHECK(std::abs(column(workspace, "turned1", "PAR(62)").front() - 1.0) < 1e-9);
}

TEST_CASE("resegment --to signature: segments of no duration vanish") {
  const Workspace workspace;
  run_to_two_events(workspace);
  const Outcome outcome = resegment(workspace, "q.first GR1 --to signature --signature 1,1,1;2,3,2 -o fewer");
  CHECK(contains(outcome.out, "-> {(1,1,1), (2,3,2)}"));
  run(workspace, "fewer");
  for (const double duration : column(workspace, "fewer1", "PAR(62)")) CHECK(std::abs(duration - 1.0) < 1e-9);
}

TEST_CASE("resegment --to signature: along a grazing curve") {
  double low = 0.5, high = 1.0;  // where the surface is touched: 8 (phi - 1/2) = x'
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (8.0 * (middle - 0.5) < 1.0 - x_at(middle) ? low : high) = middle;
  }
  const double r = x_at(low) - 4.0 * (low - 0.5) * (low - 0.5);
  const Workspace workspace;
  run_to_two_events(workspace, 0.9, r, {low, 0.9, 1.0, 2.0},
                    "IPS = 150, ICP = [p, r, 61, 62, 63, 64], RL1 = 1.6, DS = 0.02, GRJUMP = 1\n"
                    "GCFIND = [1, 1, 1, 2], GCHIND = [4, 2, 1, 3], GCGIND = [1, 1, 1, 2]\n"
                    "GCSEGTYP = [2, 0, 0, 1], GCHGRZIND = [[], [1], [], []], GCIPSI = []\n");
  const Outcome outcome = resegment(workspace, "q.first GR1 --to signature --signature 1,4,1;1,1,1;2,2,1;2,3,2 -o on");
  CHECK(contains(outcome.out, "surface (grazing)"));
  CHECK(contains(outcome.out, "IPS = 150"));
  run(workspace, "on");
  const std::vector<double> p = column(workspace, "on1", "p");
  CHECK(p.back() > 1.6);
  for (const double value : column(workspace, "on1", "r")) CHECK(std::abs(value - r) < 1e-9);
  check_refused(workspace.tchat("resegment q.first GR1 --to signature --signature 1,1,1;1,2,1;2,3,2 -o bad -p wave"),
                {"does not fit", "event 1 (drive off)"});
  check_refused(workspace.tchat("resegment q.first GR1 --to grazing-curve -o bad -p wave"), {"--to signature"});
}

TEST_CASE("resegment --to signature refuses what does not fit") {
  const Workspace workspace;
  run_to_two_events(workspace);
  struct Bad {
    std::string signature;
    std::vector<std::string> expected;
  };
  for (const Bad& bad :
       {Bad{"1,1,1", {"1 index vectors", "2 of the orbit's 3 segments"}}, Bad{"2,2,1;2,3,2", {"fields 1, 2"}},
        Bad{"1,1,1;2,1,2", {"drive off", "at the end of segment 2"}}, Bad{"1,1,1;2,3,1", {"jump 1", "phi = 2"}},
        Bad{"1,1,1;2,2,1;2,2,1;2,2,1;2,2,1;2,2,1;2,3,2", {"at most 4"}}, Bad{"1,1,9;2,3,2", {"jump"}}}) {
    INFO(bad.signature);
    check_refused(workspace.tchat("resegment q.first GR1 --to signature -o bad -p wave --signature " + bad.signature),
                  bad.expected);
  }
  check_refused(workspace.tchat("resegment q.first GR1 --to signature -o bad -p wave"), {"--signature"});
  check_refused(workspace.tchat("resegment q.first GR1 --to impacting -o bad -p wave"),
                {"{(2,2,1), (2,3,2)}", "--to signature"});
}
