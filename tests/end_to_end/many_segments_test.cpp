// Orbits of hundreds of segments: a ball that is thrown up again when its impacts have become slow. The n-th flight
// after a throw lasts 2 r^n, so that an orbit of two throws and m - 1 flights after the second one has the period 2 + 2
// (1 - r^(m-1)) / (1 - r).
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

constexpr const char* thrown_ball = R"(par r=0.99, V=1, vc=0.05
init x=0.1, v=0
x' = v
v' = -1
event wall = x
jump bounce: v -> -r*v
jump launch: v -> V
aux energy = v^2/2+x
after start: flow until wall -> launch
after any if -v > vc: flow until wall -> bounce
after any: flow until wall -> launch
)";

/// The orbit whose slowest impact is below `slowest`, as ball.dat and gc.ball.
int simulate(const Workspace& workspace, double slowest) {
  workspace.write("ball.tch", thrown_ball);
  workspace.succeed(fmt::format("simulate ball -q --dat ball --events 3000 --max-period 1000 PAR(vc)={}", slowest));
  const std::string constants = workspace.read("gc.ball");
  return std::stoi(constants.substr(constants.find("GCNOSEG = ") + 10));
}

double period(double r, int segments) { return 2.0 + 2.0 * (1.0 - std::pow(r, segments - 1)) / (1.0 - r); }

}  // namespace

TEST_CASE("an orbit of 302 impacts is run, written, read, verified and resegmented") {
  const Workspace workspace;
  const int segments = simulate(workspace, 0.05);
  REQUIRE(segments == 302);
  workspace.succeed(
      "run ball -q -c ball -d ball -o branch NTST=2 ICP=[r,period,energy] NMX=10 DS=1e-4 UZR={r:0.99001}");
  // Parabolas are exact on any mesh, and 302 sums leave 1e-12.
  for (const SolutionEntry& label : workspace.solutions("branch")) {
    double sum = 0.0;
    for (int s = 1; s <= segments; ++s) sum += label.parameter(60 + s);
    CHECK(sum == Approx(period(label.parameter(1), segments)).epsilon(1e-11));
  }
  const Outcome checked = workspace.succeed("verify branch -p ball");
  CHECK(checked.out.find("agree with forward integration") != std::string::npos);
  CHECK(workspace.succeed("labels branch").out.find("302") != std::string::npos);
  workspace.succeed("run ball -q -c r.branch -s branch IRS=UZ1 -o again DS=-1e-4 NMX=3");
  CHECK(workspace.solutions("again").back().parameter(1) < 0.99001);
  workspace.succeed("resegment q.branch UZ1 -p ball --to rotate --by 5 -o turned");
  workspace.succeed("run ball -q -c turned -s turned -o rotated NMX=3");
  CHECK(workspace.solutions("rotated").back().parameter(61 + 297) == Approx(2.0).epsilon(1e-9));
}

TEST_CASE("no list of constants ends an orbit of more than a thousand segments") {
  const Workspace workspace;
  workspace.write("ball.tch", thrown_ball);
  workspace.succeed("simulate ball -q --dat ball --events 8000 --max-period 1500 PAR(r)=0.995 PAR(vc)=0.0066");
  workspace.succeed("run ball -q -c ball -d ball -o branch NTST=2 ICP=[r] NMX=3 DS=1e-5");
  const SolutionEntry last = workspace.solutions("branch").back();
  REQUIRE(last.states.front().size() > 2000);
  const int segments = static_cast<int>(last.states.front().size()) / 2;
  double sum = 0.0;
  for (int s = 1; s <= segments; ++s) sum += last.par.at(static_cast<std::size_t>(60 + s - 1));
  CHECK(sum == Approx(period(last.parameter(1), segments)).epsilon(1e-10));
}

TEST_CASE("durations beyond the 256th and monitors keep apart") {
  const Workspace workspace;
  const int segments = simulate(workspace, 0.0067);
  REQUIRE(segments > 460);  // durations beyond PAR(512)
  workspace.succeed(
      "run ball -q -c ball -d ball -o held NTST=2 ICP=[r,V,T400] HOLD=[period] NMX=4 DS=1e-4 BOUNDS={T480:[0,1]}");
  const auto labels = workspace.solutions("held");
  const auto total = [&](const SolutionEntry& label) {
    double sum = 0.0;
    for (int s = 1; s <= segments; ++s) sum += label.parameter(60 + s);
    return sum;
  };
  CHECK(labels.back().parameter(1) > labels.front().parameter(1));
  CHECK(total(labels.back()) == Approx(total(labels.front())).epsilon(1e-10));
  CHECK(labels.back().parameter(2) ==
        Approx(total(labels.back()) / period(labels.back().parameter(1), segments)).epsilon(1e-10));
}

TEST_CASE("a conservative family of 430 segments") {
  const Workspace workspace;
  constexpr int segments = 430;
  workspace.write("ball.tch", "x' = v\nv' = -1\nevent wall = x\njump bounce: v -> -v\naux energy = v^2/2+x\n");
  std::string data, constants = "NDIM=2 IPS=180 CONSERVED=energy ICP=[energy,period] NTST=1 NMX=6 DS=0.1 IAD=0\n";
  for (int s = 1; s <= segments; ++s) data += fmt::format("# PAR({}) = 2\n", 60 + s);
  for (const double tau : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    data += fmt::format("{}", tau);
    for (int s = 0; s < segments; ++s) data += fmt::format(" {} {}", 2.0 * tau * (1.0 - tau), 1.0 - 2.0 * tau);
    data += '\n';
  }
  std::string ones;
  for (int s = 0; s < segments; ++s) ones += s > 0 ? ",1" : "1";
  constants += fmt::format("GCFIND=[{0}]\nGCHIND=[{0}]\nGCGIND=[{0}]\n", ones);
  workspace.write("ball.dat", data);
  workspace.write("gc.ball", constants);
  workspace.succeed("run ball -q");
  const PointSection section = workspace.points("ball").front();
  const std::size_t energy = section.column("energy"), period = section.column("period");
  CHECK(section.rows.back().values[energy] != Approx(section.rows.front().values[energy]));
  for (const PointRow& row : section.rows) {
    const double flight = row.values[period] / segments;
    CHECK(row.values[energy] == Approx(flight * flight / 8.0).epsilon(1e-9));  // eleven digits are in the file
  }
}
