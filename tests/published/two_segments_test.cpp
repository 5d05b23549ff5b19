// One orbit entered as two equal segments: its period doubling is a branch point of the doubled problem.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>

#include "published/chain.hpp"

using namespace test_support;

TEST_CASE("the same orbit twice as two segments: its period doubling is a branch point, nothing else is new") {
  const Workspace workspace;
  run_impacting(workspace, "20072");
  // q.start to data for two segments.
  const SolutionEntry start = workspace.solutions("impacting_20072").at(1);
  std::string data;
  char text[400];
  for (int k : {1, 2, 3, 4}) data += "# PAR(" + std::to_string(k) + ") = " + std::to_string(start.parameter(k)) + "\n";
  for (int k : {61, 62}) {
    std::snprintf(text, sizeof text, "# PAR(%d) = %.12f\n", k, start.parameter(61));
    data += text;
  }
  for (std::size_t k = 0; k < start.t.size(); ++k) {
    const auto& x = start.states[k];
    std::snprintf(text, sizeof text, "%.11f %.11f %.11f %.11f %.11f %.11f %.11f %.11f %.11f\n", start.t[k], x[0], x[1],
                  x[2], x[3], x[0], x[1], x[2], x[3]);
    data += text;
  }
  workspace.write("twice.dat", data);
  workspace.run({"-c",
                 "impacting_20072",
                 "-d",
                 "twice",
                 "-o",
                 "twice",
                 "IRS=0",
                 "--both",
                 "GRSTOP=0",
                 "NPR=1",
                 "NMX=150",
                 "RL0=1",
                 "RL1=6",
                 "GCFIND=[1,1]",
                 "GCHIND=[1,1]",
                 "GCGIND=[1,1]",
                 "GCSEGTYP=[1,1]",
                 "GCHGRZIND=[[1],[1]]",
                 "GCIPSI=[1,2]",
                 "ICP=[1,61,62]",
                 "THL={61:0,62:0}"});
  const auto points = read_diagnostics(workspace.read("d.twice"));
  for (const DiagnosticPoint& point : points) {
    INFO("branch " << point.branch << " point " << point.point);
    CHECK(point.type != "TR");
    if (point.type == "LP" || point.type == "BP") CHECK(distance_to(point.multipliers, 1.0) < 1e-5);
    CHECK(point.type != "PD");  // both segments are the same orbit: multipliers are squares
  }
  const auto branch_points = of_type(points, "BP");
  REQUIRE(branch_points.size() == 1);
  CHECK(std::abs(with_label(workspace.solutions("twice"), branch_points.front().label).parameter(1) -
                 3.03619356554716) < 1e-7);
}
