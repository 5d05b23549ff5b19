// Two walls: a grazing curve of one of them ends where its orbit touches the other one as well, by the closed form of
// the linear response.
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <filesystem>

#include "published/chain.hpp"
#include "published/two_walls.hpp"

using namespace test_support;

namespace {

/// |q1| for a = 1.
double response(double omega) {
  using P = TwoWalls;
  const std::complex<double> coupling(P::k2, P::c2 * omega);
  const std::complex<double> second = coupling - P::m2 * omega * omega;
  const std::complex<double> first =
      P::k1 + std::complex<double>(0.0, P::c1 * omega) + coupling - P::m1 * omega * omega;
  return 1.0 / std::abs(first - coupling * coupling / second);
}

}  // namespace

TEST_CASE("double grazing: the curve of wall A ends at wall B, or runs through") {
  const Workspace workspace;
  std::filesystem::copy_file(TWO_WALLS_LIBRARY, workspace.file("walls.so"));
  const auto command = [&](const std::string& arguments) {
    const Outcome outcome = workspace.tchat(arguments);
    INFO(arguments << '\n' << outcome.text());
    REQUIRE(outcome.status == 0);
  };
  command("simulate walls -q PAR(omega)=2 PAR(a)=0.8 --dat smooth --free a -o simulated");
  command("run walls -q -c smooth -d smooth -o smooth");
  command("resegment -q -p walls q.smooth GR1 --to grazing-curve -o start ICP=[2,1,61,62] RL0=1.3 DS=-0.01");
  command("run walls -q -c start -s start -o curve");
  command("run walls -q -c start -s start -o through GRSTOP=0");

  // |q1| = |q2| = 1 where (k2 - m2 omega^2)^2 = k2^2.
  const double omega = std::sqrt(2.0 * TwoWalls::k2 / TwoWalls::m2);
  for (const char* name : {"curve", "through"}) {
    INFO(name);
    const auto points = read_diagnostics(workspace.read(std::string("d.") + name));
    const auto grazing = of_type(points, "GR");
    REQUIRE_FALSE(grazing.empty());
    CHECK(grazing.front().notes.front().find("grazing: contact with event 2 (wall B)") != std::string::npos);
    const auto solutions = workspace.solutions(name);
    const SolutionEntry& found = with_label(solutions, grazing.front().label);
    CHECK(std::abs(found.parameter(2) - omega) < 1e-8);
    CHECK(std::abs(found.parameter(1) - 1.0 / response(omega)) < 1e-8);
    if (std::string(name) == "curve")
      CHECK(solutions.back().label == found.label);
    else
      CHECK(solutions.back().parameter(2) < omega - 0.2);
    // With GRSTOP=0 there is one more, where the crossing of wall B moves over the cut at wall A.
    if (grazing.size() > 1) CHECK(grazing[1].notes.front().find("two events at once") != std::string::npos);
  }
}
