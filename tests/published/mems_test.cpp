// The chain of problems/mems as a user runs it, against values computed by shooting.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <tuple>

#include "published/makefile_run.hpp"

using namespace test_support;

namespace {

constexpr double pi = 3.14159265358979323846;

/// The solution where PAR(k) has a user value, nearest to PAR(1) = voltage.
SolutionEntry at_value(const MakefileRun& chain, const std::string& name, int k, double value, double voltage) {
  const auto solutions = chain.solutions(name);
  const SolutionEntry* best = nullptr;
  for (const SolutionEntry& s : solutions)
    if (std::abs(s.parameter(k) - value) < 1e-8)
      if (best == nullptr || std::abs(s.parameter(1) - voltage) < std::abs(best->parameter(1) - voltage)) best = &s;
  INFO(name << " at PAR(" << k << ") = " << value);
  REQUIRE(best != nullptr);
  return *best;
}

void check_nonimpacting(const MakefileRun& chain) {
  const SolutionEntry orbit = at_value(chain, "nonimpacting", 1, 0.5641, 0.5641);
  const double expected[] = {0.0, 0.368732189736, 0.0, -0.027574562403, 0.999619749459};
  for (std::size_t i = 0; i < 5; ++i) check_near(orbit.states.front()[i], expected[i], 2e-11);
  check_near(orbit.parameter(61), 3.926990816987, 1e-10);
  const auto multipliers = chain.point("nonimpacting", "UZ").multipliers;
  CHECK(distance_to(multipliers, -1.00266478) < 5e-9);
  CHECK(distance_to(multipliers, -0.85236464) < 5e-9);
  CHECK(distance_to(multipliers, 0.0003882032) < 5e-11);
  CHECK(std::count_if(multipliers.begin(), multipliers.end(), [](const auto& mu) { return std::abs(mu) < 1e-9; }) == 2);
  check_near(chain.solution("nonimpacting", "PD", 1).parameter(1), 0.44181687354);
  check_near(chain.solution("nonimpacting", "PD", 2).parameter(1), 0.56413613108);

  const SolutionEntry grazing = chain.solution("nonimpacting", "GR");
  check_near(grazing.parameter(1), 0.597984349382, 2e-11);
  const double contact[] = {0.0, 0.5, 0.0, -0.0225309885, 0.9997461451};
  for (std::size_t i = 0; i < 5; ++i) check_near(grazing.states.front()[i], contact[i], 2e-10);
}

void check_grazing_curve(const MakefileRun& chain) {
  const double values[][2] = {{0.56, 0.532126908360},
                              {0.60, 0.573896440745},
                              {0.64, 0.591556762123},
                              {0.70, 0.600363015628},
                              {0.90, 0.589417329276}};
  for (const auto& [omega, voltage] : values)
    check_near(at_value(chain, "grazing_curve", 2, omega, voltage).parameter(1), voltage, 2e-11);

  const auto points = chain.diagnostics("grazing_curve");
  const double xi[] = {4.22197257, -0.0425047323, -3.60782183, 0.0726478407, 3.08264303};
  for (int n = 1; n <= 5; ++n)
    check_near(points.front().tests.at("xi_" + std::to_string(n)), xi[n - 1], std::abs(xi[n - 1]) < 1 ? 2e-10 : 2e-9);

  const auto zeros = of_type(points, "XI");
  const auto first = std::find_if(zeros.begin(), zeros.end(), [](const DiagnosticPoint& p) {
    return std::any_of(p.notes.begin(), p.notes.end(),
                       [](const std::string& note) { return note.find("xi_1 = 0") != std::string::npos; });
  });
  REQUIRE(first != zeros.end());
  const SolutionEntry codimension_two = with_label(chain.solutions("grazing_curve"), first->label);
  check_near(codimension_two.parameter(2), 0.613649461804);
  check_near(codimension_two.parameter(1), 0.581634329907);
}

struct Impacting {
  const char* type;
  std::size_t n;
  double voltage, v, t1, t2, mu1, mu2;
};

void check_impacting(const MakefileRun& chain) {
  const Impacting table[] = {
      {"UZ", 1, 0.61785728526, 0.05, 3.92211913811, 0.004871678877, -0.00344065196, -58.4767711},
      {"PD", 1, 0.72439826618, 0.3807932645, 3.89004920679, 0.036941610201, -1.0, -0.202810271},
      {"UZ", 2, 0.79013593844, 0.75, 3.85554413574, 0.071446681246, 0.595826261, 0.352713557},
      {"LP", 1, 0.84723210893, 1.0508443893, 3.83407602121, 0.092914795779, 1.0, 0.237334536},
      {"GR", 1, 0.74694282418, 0.7502222884, 3.86156916382, 0.065421653169, 8.48146425, 0.0285534434},
  };
  for (const Impacting& row : table) {
    INFO(row.type << row.n);
    const SolutionEntry orbit = chain.solution("impacting", row.type, row.n);
    check_near(orbit.parameter(1), row.voltage);
    check_near(orbit.states.back()[2], row.v);
    check_near(orbit.parameter(61), row.t1);
    check_near(orbit.parameter(62), row.t2);
    check_near(orbit.parameter(61) + orbit.parameter(62), pi / 0.8);
    const auto multipliers = chain.point("impacting", row.type, row.n).multipliers;
    CHECK(distance_to(multipliers, row.mu1) < 1e-9 * std::max(1.0, std::abs(row.mu1)));
    CHECK(distance_to(multipliers, row.mu2) < 1e-9 * std::max(1.0, std::abs(row.mu2)));
    // Flow and frame velocity: a Jordan block of zeros, known to about the square root of rounding.
    CHECK(std::count_if(multipliers.begin(), multipliers.end(), [](const auto& mu) { return std::abs(mu) < 1e-7; }) ==
          2);
  }
  // v is not monotone: it takes its value at the fold twice.
  chain.run("-c from_impacting -s from_impacting -o every_point NPR=1");
  int crossings = 0;
  bool above = false;
  for (const SolutionEntry& orbit : chain.solutions("every_point")) {
    const bool now = orbit.states.back()[2] > 1.0508443893;
    crossings += now != above ? 1 : 0;
    above = now;
  }
  CHECK(crossings == 2);
}

/// {J1,J7,J1,J7} exists below the period doubling and doubles again.
void check_doubled(const MakefileRun& chain) {
  const PointSection section = chain.points("doubled").front();
  CHECK(section.rows.front().values[0] < 0.72439826618);
  check_near(section.rows.front().values[section.column("PERIOD")], 2.0 * pi / 0.8);
  const double again = chain.solution("doubled", "PD").parameter(1);
  CHECK(again < 0.72);
  CHECK(again > 0.715);
}

void check_secondary_grazing(const MakefileRun& chain) {
  const auto start = chain.solutions("from_secondary_grazing_curve").front();
  REQUIRE(start.states.front().size() == 15);
  const double durations[] = {1.255483328181, 2.606085835637, 0.065421653169};
  const double contact[] = {0.0, 0.5, 0.0, -0.272879502144, 0.962048219846};
  for (int s = 0; s < 3; ++s) check_near(start.parameter(61 + s), durations[s]);
  for (std::size_t i = 0; i < 5; ++i) {
    check_near(start.states.back()[i], contact[i]);
    check_near(start.states.front()[5 + i], contact[i]);
  }
  // The corrected first point of the curve.
  const auto sections = chain.points("secondary_grazing_curve");
  const PointSection& section = sections.front();
  check_near(section.rows.front().values[section.column("V")], 0.74694282418);
  for (int s = 0; s < 3; ++s)
    check_near(section.rows.front().values[section.column("PAR(" + std::to_string(61 + s) + ")")], durations[s], 1e-10);
  // Zeros of xi_5 on steps that are cut at those of other xi_n.
  std::vector<double> zeros;
  for (const DiagnosticPoint& point : chain.diagnostics("secondary_grazing_curve"))
    for (const std::string& note : point.notes)
      if (note.find("xi_5 = 0") != std::string::npos)
        zeros.push_back(with_label(chain.solutions("secondary_grazing_curve"), point.label).parameter(2));
  for (const double omega : {0.5884250, 0.5787374, 0.5667654})
    CHECK(std::any_of(zeros.begin(), zeros.end(), [=](double zero) { return std::abs(zero - omega) < 1e-7; }));
}

/// Both curves leave xi_1 = 0 towards larger omega, tangent to the grazing curve: their distance from it grows with the
/// square of the distance in omega.
void check_tangency(const MakefileRun& chain) {
  const double start = 0.613649461804, near = 0.616, far = 0.62;
  const std::string values = " UZR={2:[0.616,0.62]}";
  chain.run("-c from_grazing_curve -s from_grazing_curve -o beside DS=-0.02 RL0=0.6" + values);
  chain.run("-c " + chain.constants("period_doubling_curve") + " -s impacting -o doublings --both" + values);
  chain.run("-c " + chain.constants("fold_curve") + " -s impacting_070 -o folds --both" + values);
  for (const char* name : {"doublings", "folds"}) {
    INFO(name);
    const auto distance = [&](double omega) {
      const double grazing = at_value(chain, "beside", 2, omega, 0.58).parameter(1);
      return std::abs(at_value(chain, name, 2, omega, grazing).parameter(1) - grazing);
    };
    CHECK(distance(near) > 0.0);
    CHECK(distance(near) / distance(far) < 1.4 * std::pow((near - start) / (far - start), 2));
  }
  for (const char* name : {"period_doubling_curve", "first_fold_curve"}) {
    INFO(name);
    const SolutionEntry end = chain.solution(name, "GR");
    check_near(end.parameter(2), start);
    check_near(end.parameter(1), 0.581634329907);
    CHECK(end.internal.front() == 4);  // impact velocity zero
    // The contact segment has no duration where the impact grazes: that is one event, and named once.
    for (const DiagnosticPoint& point : of_type(chain.diagnostics(name), "GR"))
      for (const std::string& note : point.notes) CHECK(note.find("contact with") == std::string::npos);
    // The other way along the curve of folds comes back below this omega, far from here.
    for (const PointSection& section : chain.points(name))
      for (const PointRow& row : section.rows)
        if (std::abs(row.values[section.column("V")] - 0.581634329907) < 0.02) CHECK(row.values[0] > start - 1e-9);
  }
}

void check_two_parameter_curves(const MakefileRun& chain) {
  const double doublings[][2] = {{0.63469930968, 0.70}, {0.59549562734, 0.64}, {0.81286898983, 0.88}};
  for (const auto& [voltage, omega] : doublings)
    check_near(at_value(chain, "period_doubling_curve", 2, omega, voltage).parameter(1), voltage);
  const double folds[][2] = {{0.79193072891, 0.72}, {0.92376437612, 0.86}};
  for (const auto& [voltage, omega] : folds)
    check_near(at_value(chain, "fold_curve", 2, omega, voltage).parameter(1), voltage);

  // At omega = 0.7 a branch from grazing meets PD, SN, SN, SN in turn.
  std::string met;
  for (const DiagnosticPoint& p : chain.diagnostics("impacting_070"))
    if (p.type == "PD" || p.type == "LP") met += p.type + " ";
  CHECK(met == "PD LP LP LP ");
}

/// What simulation and tchat resegment hand over converges at once.
void check_newton_steps(const MakefileRun& chain) {
  for (const char* name :
       {"nonimpacting", "grazing_curve", "impacting", "impacting_070", "two_impacts", "secondary_grazing_curve"}) {
    INFO(name);
    CHECK(first_iterations(chain.read(std::string("d.") + name)) <= 4);
  }
}

/// {J11} and {J12} with the identity jump: nothing determines the frame velocity.
void check_refusals(const MakefileRun& chain) {
  const std::string monitored = "GCFIND = [1], GCGIND = [2], GCHGRZIND = [[]]\n";
  chain.write("gc.J11", "NDIM = 5, IPS = 180, ICP = [1, 61], GCHIND = [3], GCSEGTYP = [0]\n" + monitored);
  chain.write("gc.J12", "NDIM = 5, IPS = 150, IRS = GR1, ICP = [2, 1, 61], GCHIND = [1], GCSEGTYP = [2]\n" + monitored);
  for (const auto& [name, from, start] :
       {std::tuple{"J11", "-d", "nonimpacting"}, std::tuple{"J12", "-s", "nonimpacting"}}) {
    INFO(name);
    const Outcome outcome =
        chain.tchat({"run", "mems", "-p", chain.plugin(), "-c", name, from, start, "-o", "singular"});
    CHECK(outcome.status == 1);
    CHECK(outcome.text().find("singular") != std::string::npos);
    CHECK(outcome.text().find("it leaves frame velocity on segment 1 undetermined") != std::string::npos);
    CHECK_FALSE(chain.has("q.singular"));
  }
}

}  // namespace

TEST_CASE("make -j2 in problems/mems: every published value") {
  const MakefileRun chain("mems");
  chain.check_repeatable(MakefileRun::Chain::is_long);
  chain.check_verified();
  check_nonimpacting(chain);
  check_grazing_curve(chain);
  check_impacting(chain);
  check_doubled(chain);
  check_secondary_grazing(chain);
  check_two_parameter_curves(chain);
  check_tangency(chain);
  check_newton_steps(chain);
  check_refusals(chain);
}
