// Orbits of several segments: the one-impact orbit repeated or cut, and what happens when a duration is missing.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

#include "end_to_end/closed_forms.hpp"
#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

/// gc.NAME for m one-impact segments.
std::string repeated_signature(int m) {
  std::string list, monitors, parameters = "1", weights;
  for (int s = 0; s < m; ++s) {
    list += s > 0 ? ", 1" : "1";
    monitors += s > 0 ? ", [1]" : "[1]";
    parameters += fmt::format(", {}", 61 + s);
    weights += fmt::format("{}{}: 0", s > 0 ? ", " : "", 61 + s);
  }
  return fmt::format(
      "NDIM = 4\nIPS = 180\nICP = [{}]\nNTST = 50\nNCOL = 4\nIAD = 3\nNMX = 12\nNPR = 4\nRL0 = 2.5\nRL1 = 3.4\n"
      "EPSL = 1e-10\nEPSU = 1e-10\nDS = 0.02\nDSMAX = 0.5\nTHL = {{{}}}\nGCNOSEG = {}\nGCSEGTYP = [{}]\nGCFIND = [{}]\n"
      "GCHIND = [{}]\nGCGIND = [{}]\nGCHGRZIND = [{}]\n",
      parameters, weights, m, list, list, list, list, monitors);
}

/// The closed form, repeated for every segment; `durations` of them are told.
std::string repeated_data(int m, int durations) {
  const ImpactingOrbit orbit(0.5, 2.0072, 0.05, 0.8);
  std::string text = fmt::format("# PAR(1) = {:.15g}\n# PAR(2) = 2.0072\n", orbit.alpha());
  for (int s = 0; s < durations; ++s) text += fmt::format("# PAR({}) = {:.15g}\n", 61 + s, orbit.period());
  for (int k = 0; k <= 80; ++k) {
    text += fmt::format("{:.15g}", k / 80.0);
    for (int s = 0; s < m; ++s)
      for (const double x : orbit.at(k / 80.0 * orbit.period())) text += fmt::format(" {:.15g}", x);
    text += '\n';
  }
  return text;
}

/// All multipliers of the first point, largest modulus first.
std::vector<std::complex<double>> multipliers_of(const std::string& diagnostics) {
  std::vector<std::complex<double>> values;
  const auto end = diagnostics.find(std::string(47, '='));
  for (auto at = diagnostics.find("   Multiplier"); at < end; at = diagnostics.find("   Multiplier", at + 1)) {
    const auto words = words_of(diagnostics.substr(at, 80));
    values.emplace_back(std::stod(words.at(2)), std::stod(words.at(3)));
  }
  std::sort(values.begin(), values.end(), [](auto a, auto b) {
    return std::abs(a) != std::abs(b) ? std::abs(a) > std::abs(b) : a.imag() > b.imag();
  });
  return values;
}

}  // namespace

TEST_CASE("the one-impact orbit as two and four segments") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o one NMX=2");
  const auto single = multipliers_of(workspace.read("d.one"));
  REQUIRE(single.size() == 4);
  for (const int m : {2, 4}) {
    INFO(m << " segments");
    workspace.write("gc.repeated", repeated_signature(m));
    workspace.write("repeated.dat", repeated_data(m, m));
    workspace.run("-c repeated -d repeated -o repeated");
    const auto sections = workspace.points("repeated");
    CHECK(sections.front().integer("NSEG") == m);
    for (const SolutionEntry& solution : workspace.solutions("repeated")) {
      const ImpactingOrbit orbit(-solution.states.front()[1] / 0.8, 2.0072, 0.05, 0.8);
      CHECK(solution.parameter(1) == Approx(orbit.alpha()).epsilon(1e-9));
      REQUIRE(solution.states.front().size() == static_cast<std::size_t>(4 * m));
      CHECK(solution.free_parameters.size() == static_cast<std::size_t>(1 + m));
      for (int s = 0; s < m; ++s) CHECK(solution.parameter(61 + s) == Approx(orbit.period()).epsilon(1e-10));
      for (std::size_t k = 0; k < solution.t.size(); k += 4)
        for (std::size_t i = 0; i < static_cast<std::size_t>(4 * m); ++i)
          CHECK(std::abs(solution.states[k][i] - orbit.at(solution.t[k] * orbit.period())[i % 4]) < 1e-9);
      const PointRow& row = with_label(sections, solution.label);
      CHECK(row.values.back() == Approx(m * orbit.period()).epsilon(1e-10));
      CHECK(row.values[sections.front().column("MAX x1")] == Approx(1.0).epsilon(1e-9));
    }
    const auto powers = multipliers_of(workspace.read("d.repeated"));
    REQUIRE(powers.size() == 4);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto expected = std::pow(single[k], m);
      const bool found = std::any_of(powers.begin(), powers.end(),
                                     [&](auto mu) { return std::abs(mu - expected) < 1e-6 * std::abs(expected); });
      CHECK(found);
    }
  }
}

TEST_CASE("the duration of every segment must be told when there are several") {
  const Workspace workspace;
  workspace.write("gc.repeated", repeated_signature(2));
  workspace.write("repeated.dat", repeated_data(2, 1));
  const Outcome outcome = workspace.tchat("run linosc -c repeated -d repeated -o branch");
  INFO(outcome.text());
  CHECK(outcome.status == 2);
  CHECK(outcome.err.find("repeated.dat") != std::string::npos);
  CHECK(outcome.err.find("segment 2") != std::string::npos);
  CHECK(outcome.err.find("PAR(62)") != std::string::npos);
  workspace.run(words_of("-c repeated -d repeated -o branch PAR(62)=3.13032348896"));
  CHECK(workspace.points("branch").front().rows.size() == 12);
}

TEST_CASE("the impacting orbit cut at its minimum has the same multipliers") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o one NMX=2");
  const auto single = multipliers_of(workspace.read("d.one"));
  // The minimum of x1: x2 rises through zero.
  const ImpactingOrbit orbit(0.5, 2.0072, 0.05, 0.8);
  double low = 0.2 * orbit.period(), high = 0.8 * orbit.period();
  while (high - low > 1e-12) {
    const double middle = (low + high) / 2;
    (orbit.at(middle)[1] < 0.0 ? low : high) = middle;
  }
  std::string data = fmt::format("# PAR(1) = {:.15g}\n# PAR(2) = 2.0072\n# PAR(61) = {:.15g}\n# PAR(62) = {:.15g}\n",
                                 orbit.alpha(), low, orbit.period() - low);
  for (int k = 0; k <= 60; ++k) {
    const double tau = k / 60.0;
    data += fmt::format("{:.15g}", tau);
    for (const double x : orbit.at(tau * low)) data += fmt::format(" {:.15g}", x);
    for (const double x : orbit.at(low + tau * (orbit.period() - low))) data += fmt::format(" {:.15g}", x);
    data += '\n';
  }
  workspace.write("cut.dat", data);
  workspace.run({"-c", "impacting", "-d", "cut", "-o", "cut", "NMX=2", "ICP=[1,61,62]", "GCNOSEG=2", "GCSEGTYP=[0,1]",
                 "GCFIND=[1,1]", "GCHIND=[3,1]", "GCGIND=[2,1]", "GCHGRZIND=[[],[1]]", "THL={61:0,62:0}"});
  const auto cut = multipliers_of(workspace.read("d.cut"));
  REQUIRE(cut.size() == 4);
  for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(cut[k] - single[k]) < 1e-8);
  CHECK(workspace.points("cut").front().rows.front().values.back() == Approx(orbit.period()).epsilon(1e-9));
}
