// The chain of problems/mems as a user runs it, against values computed by shooting (SPEC section 13.2).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "published/chain.hpp"

using namespace test_support;
namespace fs = std::filesystem;

namespace {

/// Files of the chain.
class MemsChain {
 public:
  MemsChain() {
    fs::create_directories(folder_.file("problems"));
    fs::create_directories(folder_.file("constants"));
    fs::copy(PROBLEMS "/mems", folder_.file("problems/mems"), fs::copy_options::recursive);
    fs::copy(CONSTANTS "/mems", folder_.file("constants/mems"));
  }

  void make() const {
    const std::string tchat = TCHAT_EXECUTABLE;
    const Outcome outcome = Process({"/usr/bin/env", "make", "-j2", "-C", folder_.file("problems/mems"),
                                     "TCHAT=" + tchat, "OUT=" + folder_.file("out")},
                                    folder_.file(""), logs_.file("make"))
                                .wait(std::chrono::seconds(250));
    INFO(outcome.text());
    REQUIRE(outcome.status == 0);
  }

  Outcome tchat(std::vector<std::string> words) const {
    words.insert(words.begin(), TCHAT_EXECUTABLE);
    return Process(words, folder_.file(""), logs_.file("tchat")).wait(std::chrono::seconds(60));
  }

  std::string plugin() const { return folder_.file("problems/mems/mems"); }
  void write(const std::string& name, const std::string& text) const { folder_.write(name, text); }
  std::string read(const std::string& name) const { return folder_.read("out/" + name); }
  std::vector<SolutionEntry> solutions(const std::string& name) const { return read_solutions(read("q." + name)); }
  std::vector<DiagnosticPoint> points(const std::string& name) const { return read_diagnostics(read("d." + name)); }
  std::vector<PointSection> branch(const std::string& name) const { return read_points(read("p." + name)); }

 private:
  TemporaryFolder folder_, logs_;
};

constexpr double pi = 3.14159265358979323846;

void check_relative(double found, double expected, double tolerance = 1e-9) {
  CAPTURE(found, expected);
  CHECK(std::abs(found - expected) <= tolerance * std::max(1.0, std::abs(expected)));
}

/// The n-th solution (from 1) of a type in the d-file's terms.
SolutionEntry entry(const MemsChain& chain, const std::string& name, const std::string& type, std::size_t n = 1) {
  const auto found = of_type(chain.points(name), type);
  INFO(type << n << " in d." << name);
  REQUIRE(found.size() >= n);
  return with_label(chain.solutions(name), found[n - 1].label);
}

DiagnosticPoint diagnostics(const MemsChain& chain, const std::string& name, int label) {
  const auto points = chain.points(name);
  return with_label(points, label);
}

/// The solution where PAR(k) has a user value, nearest to PAR(1) = voltage.
SolutionEntry at_value(const MemsChain& chain, const std::string& name, int k, double value, double voltage) {
  const auto solutions = chain.solutions(name);
  const SolutionEntry* best = nullptr;
  for (const SolutionEntry& s : solutions)
    if (std::abs(s.parameter(k) - value) < 1e-8)
      if (best == nullptr || std::abs(s.parameter(1) - voltage) < std::abs(best->parameter(1) - voltage)) best = &s;
  INFO(name << " at PAR(" << k << ") = " << value);
  REQUIRE(best != nullptr);
  return *best;
}

void check_nonimpacting(const MemsChain& chain) {
  const SolutionEntry orbit = at_value(chain, "nonimpacting", 1, 0.5641, 0.5641);
  const double expected[] = {0.0, 0.368732189736, 0.0, -0.027574562403, 0.999619749459};
  for (std::size_t i = 0; i < 5; ++i) check_relative(orbit.states.front()[i], expected[i], 2e-11);
  check_relative(orbit.parameter(61), 3.926990816987, 1e-11);
  const auto multipliers = diagnostics(chain, "nonimpacting", orbit.label).multipliers;
  CHECK(distance_to(multipliers, -1.00266478) < 1e-8);
  CHECK(distance_to(multipliers, -0.85236464) < 1e-8);
  CHECK(distance_to(multipliers, 0.0003882032) < 1e-9);
  check_relative(entry(chain, "nonimpacting", "PD", 1).parameter(1), 0.56413613108);
  check_relative(entry(chain, "nonimpacting", "PD", 2).parameter(1), 0.44181687354);

  const SolutionEntry grazing = entry(chain, "nonimpacting", "GR");
  check_relative(grazing.parameter(1), 0.597984349382, 2e-11);
  const double contact[] = {0.0, 0.5, 0.0, -0.0225309885, 0.9997461451};
  for (std::size_t i = 0; i < 5; ++i) check_relative(grazing.states.front()[i], contact[i], 2e-10);
}

void check_grazing_curve(const MemsChain& chain) {
  const double values[][2] = {{0.56, 0.532126908360},
                              {0.60, 0.573896440745},
                              {0.64, 0.591556762123},
                              {0.70, 0.600363015628},
                              {0.90, 0.589417329276}};
  for (const auto& [omega, voltage] : values)
    check_relative(at_value(chain, "grazing_curve", 2, omega, voltage).parameter(1), voltage, 2e-11);

  const auto points = chain.points("grazing_curve");
  const double xi[] = {4.22197257, -0.0425047323, -3.60782183, 0.0726478407, 3.08264303};
  for (int n = 1; n <= 5; ++n)
    check_relative(points.front().tests.at("xi_" + std::to_string(n)), xi[n - 1],
                   std::abs(xi[n - 1]) < 1 ? 2e-10 : 2e-9);

  const auto zeros = of_type(points, "XI");
  const auto first = std::find_if(zeros.begin(), zeros.end(), [](const DiagnosticPoint& p) {
    return std::any_of(p.notes.begin(), p.notes.end(),
                       [](const std::string& note) { return note.find("xi_1 = 0") != std::string::npos; });
  });
  REQUIRE(first != zeros.end());
  const SolutionEntry codimension_two = with_label(chain.solutions("grazing_curve"), first->label);
  check_relative(codimension_two.parameter(2), 0.613649461804);
  check_relative(codimension_two.parameter(1), 0.581634329907);
}

struct Impacting {
  const char* type;
  std::size_t n;
  double voltage, v, t1, t2, mu1, mu2;
};

void check_impacting(const MemsChain& chain) {
  const Impacting table[] = {
      {"UZ", 1, 0.61785728526, 0.05, 3.92211913811, 0.004871678877, -0.00344065196, -58.4767711},
      {"PD", 1, 0.72439826618, 0.3807932645, 3.89004920679, 0.036941610201, -1.0, -0.202810271},
      {"UZ", 2, 0.79013593844, 0.75, 3.85554413574, 0.071446681246, 0.595826261, 0.352713557},
      {"LP", 1, 0.84723210893, 1.0508443893, 3.83407602121, 0.092914795779, 1.0, 0.237334536},
      {"GR", 1, 0.74694282418, 0.7502222884, 3.86156916382, 0.065421653169, 8.48146425, 0.0285534434},
  };
  for (const Impacting& row : table) {
    INFO(row.type << row.n);
    const SolutionEntry orbit = entry(chain, "impacting", row.type, row.n);
    check_relative(orbit.parameter(1), row.voltage);
    check_relative(orbit.states.back()[2], row.v);
    check_relative(orbit.parameter(61), row.t1);
    check_relative(orbit.parameter(62), row.t2);
    check_relative(orbit.parameter(61) + orbit.parameter(62), pi / 0.8);
    const auto multipliers = diagnostics(chain, "impacting", orbit.label).multipliers;
    CHECK(distance_to(multipliers, row.mu1) < 1e-8 * std::max(1.0, std::abs(row.mu1)));
    CHECK(distance_to(multipliers, row.mu2) < 1e-8 * std::max(1.0, std::abs(row.mu2)));
    // Flow and frame velocity: a Jordan block of zeros, known to about the square root of rounding.
    CHECK(std::count_if(multipliers.begin(), multipliers.end(), [](const auto& mu) { return std::abs(mu) < 1e-7; }) ==
          2);
  }
  const auto doublings = of_type(chain.points("doubled"), "PD");
  REQUIRE_FALSE(doublings.empty());
  const double again = with_label(chain.solutions("doubled"), doublings.front().label).parameter(1);
  CHECK(again < 0.72);
  CHECK(again > 0.715);
}

void check_secondary_grazing(const MemsChain& chain) {
  const auto start = chain.solutions("from_secondary_grazing_curve").front();
  REQUIRE(start.states.front().size() == 15);
  const double durations[] = {1.255483328181, 2.606085835637, 0.065421653169};
  const double contact[] = {0.0, 0.5, 0.0, -0.272879502144, 0.962048219846};
  for (int s = 0; s < 3; ++s) check_relative(start.parameter(61 + s), durations[s]);
  for (std::size_t i = 0; i < 5; ++i) {
    check_relative(start.states.back()[i], contact[i]);
    check_relative(start.states.front()[5 + i], contact[i]);
  }
  // The corrected first point of the curve.
  const auto sections = chain.branch("secondary_grazing_curve");
  const PointSection& section = sections.front();
  check_relative(section.rows.front().values[section.column("V")], 0.74694282418);
  for (int s = 0; s < 3; ++s)
    check_relative(section.rows.front().values[section.column("PAR(" + std::to_string(61 + s) + ")")], durations[s],
                   1e-10);
}

void check_two_parameter_curves(const MemsChain& chain) {
  const double doublings[][2] = {{0.63469930968, 0.70}, {0.59549562734, 0.64}, {0.81286898983, 0.88}};
  for (const auto& [voltage, omega] : doublings)
    check_relative(at_value(chain, "period_doubling_curve", 2, omega, voltage).parameter(1), voltage);
  const double folds[][2] = {{0.79193072891, 0.72}, {0.92376437612, 0.86}};
  for (const auto& [voltage, omega] : folds)
    check_relative(at_value(chain, "fold_curve", 2, omega, voltage).parameter(1), voltage);

  // At omega = 0.7 a branch from grazing meets PD, SN, SN, SN in turn.
  std::string met;
  for (const DiagnosticPoint& p : chain.points("impacting_070"))
    if (p.type == "PD" || p.type == "LP") met += p.type + " ";
  CHECK(met == "PD LP LP LP ");

  // The period doublings and the first folds leave from xi_1 = 0, tangent to the grazing curve.
  for (const char* name : {"period_doubling_curve", "first_fold_curve"}) {
    INFO(name);
    const SolutionEntry end = entry(chain, name, "GR");
    check_relative(end.parameter(2), 0.613649461804, 2e-9);
    check_relative(end.parameter(1), 0.581634329907, 2e-9);
    CHECK(end.internal.front() == 4);  // impact velocity zero
  }
}

void check_newton_steps(const MemsChain& chain) {
  for (const char* name : {"grazing_curve", "impacting", "impacting_070", "two_impacts", "secondary_grazing_curve"}) {
    INFO(name);
    CHECK(first_iterations(chain.read(std::string("d.") + name)) <= 4);
  }
}

}  // namespace

TEST_CASE("make -j2 in problems/mems: every published value") {
  const MemsChain chain;
  chain.make();
  check_nonimpacting(chain);
  check_grazing_curve(chain);
  check_impacting(chain);
  check_secondary_grazing(chain);
  check_two_parameter_curves(chain);
  check_newton_steps(chain);
}

TEST_CASE("the orbit in stick with the identity jump is refused: nothing determines the frame velocity") {
  const MemsChain chain;
  std::string constants = "NDIM = 5, ICP = [1, 61], GCFIND = [1], GCHIND = [3], GCGIND = [2], GCSEGTYP = [0]\n";
  chain.write("gc.singular", constants);
  const Outcome outcome = chain.tchat(
      {"run", "mems", "-p", chain.plugin(), "-c", "singular", "-d", "constants/mems/nonimpacting", "-o", "singular"});
  CHECK(outcome.status == 1);
  CHECK(outcome.text().find("singular") != std::string::npos);
  CHECK(outcome.text().find("it leaves frame velocity on segment 1 undetermined") != std::string::npos);
}
