// Orbits with infinitely many impacts, from simulation to where chatter becomes incomplete.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <numeric>

#include "end_to_end/workspace.hpp"
#include "support/ball_impacts.hpp"

using namespace test_support;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const char* const ball =
    "par Gamma=1.1, r=0.5\ninit height=1, velocity=0.458, table=1, w=0.458\n"
    "growth = 1 - (table^2 + w^2)/Gamma^2\nmoving = growth*table + w\n"
    "height' = velocity\nvelocity' = -1\ntable' = moving\nw' = growth*w - table\n"
    "event landing = height - table\njump impact: velocity -> -r*velocity + (1 + r)*moving\n"
    "contact resting on landing until lifts: flow, impact -> settled\nafter any: flow until landing -> impact\n";

/// Two masses, the second one above a stop.
const char* const two_masses =
    "par F=1, omega=0.5, r=0.5\ninit u2=0.5, s=-0.8, c=0.6\ngrowth = 1 - s^2 - c^2\n"
    "u1' = v1\nv1' = -0.2*v1 - u1 - (u1 - u2) - 0.1*(v1 - v2)\n"
    "u2' = v2\nv2' = u1 - u2 + 0.1*(v1 - v2) - 0.5 + F*c\n"
    "s' = growth*s + omega*c\nc' = growth*c - omega*s\n"
    "event stop = u2\njump impact: v2 -> -r*v2\n"
    "contact pressed on stop until lifts: flow, impact -> settled\nafter any: flow until stop -> impact\n";

/// A pendulum against a wall at an angle; the restitution falls with the speed, and that of the first impact, by which
/// it changes v, goes through zero at v = -sqrt 2.
const char* const pendulum =
    "par A=2, omega=1.5, r=0.4\ninit angle=1, c=1\ngrowth = 1 - c^2 - s^2\nR(u) = r/(1 + 0.5*u^2)\n"
    "angle' = v\nv' = -(1 + A*c)*sin(angle) - 0.1*v\nc' = growth*c - omega*s\ns' = growth*s + omega*c\n"
    "event wall = angle - 0.5\njump impact: v -> -R(v)*v\n"
    "contact leaning on wall until leaves: flow, impact -> settled\nafter any: flow until wall -> impact\n";

/// A relief valve: G. Licsko, A. Champneys, C. Hos, SIAM J. Appl. Dyn. Syst. 8 (2009); lengths in units of u.
std::string valve(const std::string& u) {
  return "par q=0.1, r=0.5\nnumber u=" + u +
         "\ninit y=0, v=0, p=10\ny' = v\nv' = -1.25*v - (y + 10*u) + u*p\np' = 20*(q - y/u*sqrt(p))\n"
         "event seat = y\njump impact: v -> -r*v\n"
         "contact closed on seat until opens: flow, impact -> settled\nafter any: flow until seat -> impact\n";
}

/// The multipliers of the first label in the d-file.
std::vector<std::complex<double>> multipliers(const std::string& text) {
  std::vector<std::complex<double>> values;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    int number = 0;
    double real = 0.0, imaginary = 0.0;
    if (std::sscanf(line.c_str(), " Multiplier %d %lf %lf", &number, &real, &imaginary) != 3) continue;
    if (number <= static_cast<int>(values.size())) break;
    values.emplace_back(real, imaginary);
  }
  return values;
}

/// Trace and determinant of the derivative of n impacts, from the one at the end of the label's last segment on, in
/// phase and velocity.
std::pair<double, double> of_impacts(const SolutionEntry& label, int n) {
  const double gamma = label.parameter(1), r = label.parameter(2);
  const std::vector<double>& x = label.states.back();
  const std::size_t last = x.size() - 4;
  const double phase = std::atan2(x[last + 2], x[last + 3]), velocity = x[last + 1] - x[last + 3];
  const auto image = [&](double dt, double dv) {
    BallImpacts impacts(gamma, r, phase + dt, velocity + dv);
    for (int k = 0; k < n; ++k) REQUIRE(impacts.next());
    const long double t = impacts.phase();
    return std::pair{t, impacts.velocity() - gamma * std::cos(t)};
  };
  constexpr double step = 1e-7;
  const auto [t1, v1] = image(step, 0.0);
  const auto [t2, v2] = image(-step, 0.0);
  const auto [t3, v3] = image(0.0, step);
  const auto [t4, v4] = image(0.0, -step);
  const long double tt = (t1 - t2) / (2 * step), vt = (v1 - v2) / (2 * step), tv = (t3 - t4) / (2 * step),
                    vv = (v3 - v4) / (2 * step);
  return {static_cast<double>(tt + vv), static_cast<double>(tt * vv - tv * vt)};
}

const SolutionEntry& label_of(const std::vector<SolutionEntry>& labels, int type) {
  const auto found = std::find_if(labels.begin(), labels.end(), [&](const SolutionEntry& l) { return l.type == type; });
  REQUIRE(found != labels.end());
  return *found;
}

constexpr int fold = 5, doubling = 7;  // types of labels

}  // namespace

TEST_CASE("a branch of orbits with complete chatter ends where chatter becomes incomplete") {
  const Workspace workspace;
  workspace.write("ball.tch", ball);
  workspace.succeed("simulate ball --dat rest -q");
  for (const auto& [r, end] : {std::pair{"0.5", 1.59734883119515}, {"0.3", 1.94693848031279}}) {
    INFO("r = " << r);
    if (std::string(r) != "0.5") workspace.succeed("simulate ball PAR(r)=" + std::string(r) + " --dat rest -q");
    const Outcome outcome = workspace.succeed("run ball -c rest -d rest -o locked RL1=2.5 DSMAX=0.05 NMX=400");
    INFO(outcome.text());
    CHECK(contains(outcome.out, "chatter becomes incomplete"));
    const PointRow& last = workspace.points("locked").front().rows.back();
    CHECK(std::abs(last.values[0] - end) < 1e-9);
    CHECK(std::abs(last.values.back() - 2.0 * std::acos(-1.0)) < 1e-9);
    // As the model's own rules have it, all orbits are admissible.
    CHECK_FALSE(contains(outcome.out, "inadmissible"));
    // The limit has no derivative where chatter becomes incomplete, and there are no multipliers to compare.
    const Outcome verified = workspace.succeed("verify q.locked -p ball");
    CHECK(contains(verified.out, "multipliers: not determined"));
    CHECK(contains(verified.out, "2 labels agree"));
    CHECK(contains(workspace.succeed("labels q.locked --csv").out, "chatter becomes incomplete, segment"));
  }
}

TEST_CASE("a sweep gives orbits with chatter one number however many impacts come before their limit") {
  const Workspace workspace;
  workspace.write("ball.tch", ball);
  const Outcome outcome = workspace.succeed("sweep ball --over Gamma=1.05:1.55:21 -o swept");
  INFO(outcome.text());
  CHECK(contains(outcome.out, "21 times, first at Gamma = 1.05"));
  CHECK_FALSE(contains(outcome.out, "Attractor 2"));
}

TEST_CASE("impacts accumulate where slow ones are thrown back, whatever the restitution of fast ones is") {
  const Workspace workspace;
  workspace.write("pendulum.tch", pendulum);
  workspace.succeed("simulate pendulum --max-period 64 --dat rest -q");
  const Outcome outcome = workspace.succeed("run pendulum -c rest -d rest -o leaning RL1=4 DSMAX=0.05 NMX=200");
  INFO(outcome.text());
  // By integration from impact to impact, with 1e-13, and bisection: complete at 3.01750778870, not at ...875.
  const PointRow& last = workspace.points("leaning").front().rows.back();
  CHECK(std::abs(last.values[0] - 3.01750778873) < 5e-9);
  CHECK(contains(outcome.out, "labels 1 to 2"));
  CHECK_FALSE(contains(outcome.out, "inadmissible"));
  CHECK_FALSE(contains(outcome.out, "zero at every point"));
}

TEST_CASE("a sweep that begins in contact leaves it where it cannot last, and keeps the branch") {
  const Workspace workspace;
  workspace.write("pendulum.tch", pendulum);
  const Outcome swept = workspace.succeed("sweep pendulum --over A=1.1:2.9:19 --follow up --max-period 64 -o swept");
  INFO(swept.text());
  CHECK(contains(swept.out, "19 times, first at A = 1.1"));
  CHECK_FALSE(contains(swept.out, "No attractor"));
  const Outcome outcome = workspace.tchat(
      "simulate pendulum PAR(A)=1.4 --max-period 64 --state 0.5,-1e-18,-0.7407407,0.6718122 --mode 2,2,4");
  INFO(outcome.text());
  CHECK(contains(outcome.err + outcome.out, "in contact behind event 2 (leaves), which ends that"));
  CHECK(contains(outcome.out, "Periodic orbit"));
}

TEST_CASE("a bead in a shaken slot chatters on both walls, and a curve ends where neither's chatter is complete") {
  const Workspace workspace;
  workspace.write("slot.tch",
                  "par g=0.05, rr=0.6\ninit v=0.3, c=1\ngrowth = 1 - c^2 - s^2\nx' = v\nv' = c + 0.05 - 0.1*v\n"
                  "c' = growth*c - s\ns' = growth*s + c\nevent left = x + g\nevent right = g - x\n"
                  "jump hitL: v -> -0.4*v\njump hitR: v -> -rr*v\ncontact onL on left until freeL: flow, hitL -> setL\n"
                  "contact onR on right until freeR: flow, hitR -> setR\n"
                  "after any: flow until left -> hitL, right -> hitR\n");
  // Away from contact what is made of the impacts has no value, and that is no fault.
  const Outcome checked = workspace.succeed("check slot --state 0.1,0.5,1,0 --random 3");
  INFO(checked.text());
  CHECK(contains(checked.out, "No fault found"));
  workspace.succeed("simulate slot --max-period 64 --dat two -q");
  workspace.succeed("run slot -c two -d two -o two RL1=0.4 DSMAX=0.02 NMX=200");
  const Outcome outcome = workspace.succeed(std::vector<std::string>{
      "run", "slot", "-c", "r.two", "-s", "two", "IRS=GR1", "-o", "border", "HOLD={end(setR_margin,7): 0}",
      "ICP=[rr,g,end(setR_margin,7)]", "RL0=0.3", "RL1=0.8", "DS=-0.01", "DSMAX=0.05", "NMX=80"});
  INFO(outcome.text());
  CHECK(contains(outcome.out, "event 1, left"));
  CHECK(contains(outcome.out, "stopped: where chatter becomes incomplete"));
  for (const PointRow& row : rows_of(workspace.points("border")))
    CHECK(std::abs(row.values.back() - 2 * std::acos(-1.0)) < 1e-8);
}

TEST_CASE("explore draws orbits with chatter once, beside those that it knows of the bouncing ball") {
  const Workspace workspace;
  workspace.write("ball.tch", ball);
  const Outcome outcome = workspace.succeed("explore ball --over Gamma=1.02:1.56:28 -o diagram");
  INFO(outcome.text());
  // The orbit with one impact a period: LP at pi (1 - r) / (1 + r), PD where the square of Gamma is that of LP and of
  // 2 (1 + r^2) / (1 + r)^2.
  CHECK(contains(outcome.out, "3 branches. Coverage"));
  CHECK(contains(outcome.out, "(100 %)"));
  CHECK(contains(outcome.out, "at 1.047197551"));
  CHECK(contains(outcome.out, "PD 2 at 1.526823701"));
}

TEST_CASE("impacts that do not throw the motion back end a simulation with their restitution") {
  const Workspace workspace;
  workspace.write("ball.tch", ball);
  for (const char* r : {"0", "-0.3"}) {
    const Outcome outcome = workspace.tchat(std::string("simulate ball PAR(r)=") + r + " --state 1.4,0,0,1.1");
    INFO(outcome.text());
    CHECK(contains(outcome.out, std::string("goes on through landing at once")));
    CHECK(contains(outcome.out, std::string("restitution ") + r + ","));
  }
}

TEST_CASE("without a contact mode a simulation ends at the limit, within a bar that slow impacts do not spoil") {
  const Workspace workspace(Workspace::Plugin::source);
  const std::string text = ball;
  const std::size_t contact = text.find("contact");
  workspace.write("open.tch", text.substr(0, contact) + "after any: flow until landing -> impact\n");
  // The last impacts have velocities of 1e-10, and times that hardly say anything. Limits by Neville's tableau of nine
  // impacts, the table by DOP853 to 1e-13: columns agree to 1e-10.
  for (const auto& [gamma, limit] : {std::pair("0.9", 11.31308149619), {"1.2", 13.00934862948}}) {
    const Outcome outcome =
        workspace.tchat(fmt::format("simulate open --events 300 --state 0,3,0,1.3 PAR(r)=0.3 PAR(Gamma)={}", gamma));
    INFO(outcome.text());
    const double bar = number_after(outcome.out, "+- ");
    CHECK(bar < 1e-5);
    CHECK(std::abs(number_after(outcome.out, "The limit is at t = ") - limit) <= bar);
    CHECK(contains(outcome.out, "are of pattern length 1"));
  }
}

TEST_CASE("a simulation says that chatter is not complete where impacts at falling intervals end in a longer one") {
  // At Gamma = 1.4, r = 0.7 the table falls away before the ball rests on it; at 1.1, 0.5 the ball comes to rest.
  const Workspace workspace;
  workspace.write("ball.tch", ball);
  const std::string bounces = workspace.succeed("simulate ball PAR(Gamma)=1.4 PAR(r)=0.7 --events 3000 --rows 0").out;
  INFO(bounces);
  CHECK(contains(bounces, "Chatter is not complete: "));
  CHECK(contains(bounces, "of jump 1 (impact) at falling intervals"));
  CHECK_FALSE(contains(bounces, "infinitely many impacts"));
  const std::string rests = workspace.succeed("simulate ball --rows 0").out;
  INFO(rests);
  CHECK_FALSE(contains(rests, "not complete"));
  CHECK(contains(rests, "infinitely many impacts"));
}

TEST_CASE("the time at rest falls to zero like a power of the distance from where chatter becomes incomplete") {
  const Workspace workspace;
  workspace.write("ball.tch", ball);
  workspace.succeed("simulate ball --dat rest -q");
  workspace.succeed(std::vector<std::string>{"run", "ball", "-c", "rest", "-d", "rest", "-o", "locked", "RL1=2",
                                             "DSMAX=0.05", "NMX=400", "ICP=[Gamma,end(settled_time,4)]",
                                             "UZR={Gamma: [1.596, 1.597, 1.5973, 1.59734, 1.597348, 1.5973487]}"});
  const std::vector<PointRow> rows = workspace.points("locked").front().rows;
  std::vector<double> left, at_rest;
  for (const SolutionEntry& orbit : workspace.solutions("locked")) {
    if (orbit.type != -4 || left.size() == 6) continue;  // the last one is GR
    left.push_back(1.59734883119515 - orbit.parameter(1));
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const PointRow& r) { return r.label == orbit.label; });
    REQUIRE(row != rows.end());
    constexpr std::size_t monitor = 6;  // behind Gamma, the norm and four maxima
    at_rest.push_back(orbit.parameter(65) - row->values[monitor]);
  }
  // The impacts where they become incomplete are self-similar, which has the exponent; the factor is known to four
  // digits.
  constexpr double exponent = 0.603031441718;
  REQUIRE(left.size() == 6);
  for (std::size_t k = 3; k < 6; ++k)
    CHECK(std::abs(std::log(at_rest[k] / at_rest[k - 1]) / std::log(left[k] / left[k - 1]) - exponent) < 1e-3);
  CHECK(std::abs(at_rest[5] / std::pow(left[5], exponent) - 4.6235) < 2e-3);
}

TEST_CASE("towards a tangential release all flights shrink to nothing, and the branch ends with its limit") {
  const Workspace workspace;
  workspace.write("ball.tch", ball);
  workspace.succeed("simulate ball --dat rest -q");
  const std::string out = workspace.succeed("run ball -c rest -d rest -o low RL0=0.9 DS=-0.01 NMX=300").out;
  INFO(out);
  const std::size_t at = out.find("Gamma = ", out.find("tangential"));
  REQUIRE(at != std::string::npos);
  double value = 0.0, uncertainty = 0.0;
  REQUIRE(std::sscanf(out.c_str() + at, "Gamma = %lf +- %lf", &value, &uncertainty) == 2);
  CHECK(std::abs(value - 1.0) <= uncertainty);
  CHECK(uncertainty < 1e-3);
  CHECK_FALSE(contains(out, "inadmissible"));
}

TEST_CASE("an orbit with chatter that takes two periods of the table ends where its chatter becomes incomplete") {
  const Workspace workspace;
  workspace.write("ball.tch", ball);
  const std::string found = workspace.succeed("simulate ball PAR(Gamma)=4.5 PAR(r)=0.2 --max-period 64 --dat two").out;
  INFO(found);
  CHECK(contains(found, "period 12.56637061"));
  CHECK(contains(found, "infinitely many impacts"));
  const std::string out = workspace.succeed("run ball -c two -d two -o two DS=-0.02 DSMAX=0.1 RL0=4 NMX=300").out;
  INFO(out);
  CHECK(contains(out, "chatter becomes incomplete"));
  double low = 4.3, high = 4.6;  // impacts accumulate above
  for (int k = 0; k < 45; ++k) {
    const double middle = 0.5 * (low + high);
    (BallImpacts::time_until_rest(BallImpacts(middle, 0.2)) < 0 ? low : high) = middle;
  }
  CHECK(std::abs(workspace.points("two").front().rows.back().values[0] - high) < 1e-8);
}

TEST_CASE("the curve on which chatter becomes incomplete leads from one restitution to another") {
  const Workspace workspace;
  workspace.write("ball.tch", ball);
  workspace.succeed("simulate ball --dat rest -q");
  workspace.succeed("run ball -c rest -d rest -o locked RL1=2.5 DSMAX=0.05 NMX=400");
  const Outcome outcome = workspace.succeed(std::vector<std::string>{
      "run", "ball", "-c", "r.locked", "-s", "locked", "IRS=GR1", "-o", "border", "HOLD={end(settled_margin,4): 0}",
      "ICP=[r,Gamma,end(settled_margin,4)]", "UZR={r: 0.3}", "RL0=0.29", "RL1=0.8", "DS=-0.01", "DSMAX=0.05"});
  INFO(outcome.text());
  CHECK(contains(outcome.out, "UZ label 3 at r = 0.3, Gamma = 1.94693848"));
  CHECK_FALSE(contains(outcome.out, "incomplete"));
  // Where the limit has no derivative what multipliers come out says nothing.
  CHECK(contains(outcome.out, "multipliers are not determined (impacts cease to"));
  CHECK_FALSE(contains(outcome.out, "may be missing"));
}

TEST_CASE("behind the border of chatter orbits with one impact more each come one after the other") {
  const Workspace workspace;
  workspace.write("ball.tch", ball);
  workspace.succeed("simulate ball PAR(Gamma)=1.5982525 --transient-events 3000 --max-period 20 --dat at9 -q");
  workspace.succeed("run ball -c at9 -d at9 -o at9 --both DSMAX=0.02 DS=0.001 NMX=60 RL0=1.5973 RL1=1.61");
  workspace.succeed("resegment q.at9 5 --to impacting -o at10");
  workspace.succeed("run ball -c at10 -s at10 -o at10 DSMAX=0.02 NMX=60 RL0=1.5973 RL1=1.61");
  for (const int n : {9, 10}) {
    INFO(n << " impacts");
    const std::vector<SolutionEntry> labels = workspace.solutions("at" + std::to_string(n));
    // Multipliers -1 and 1 of the impacts themselves; differences of their long chains know three digits.
    const auto [trace, determinant] = of_impacts(label_of(labels, doubling), n);
    CHECK(std::abs(1.0 + trace + determinant) < 1e-3);
    const auto [of_fold, other] = of_impacts(label_of(labels, fold), n);
    CHECK(std::abs(1.0 - of_fold + other) < 1e-3);
  }
}

TEST_CASE(
    "orbits behind the border of chatter lie nearer to it by a factor that tends to the growth from impact to impact") {
  constexpr double border = 1.597348831195154, mu = 1.98959998107406, kappa = 0.660442249723743;
  const Workspace workspace;
  workspace.write("ball.tch", ball);
  std::vector<double> distances;
  for (const int n : {14, 15, 16}) {
    const std::string gamma = fmt::format("PAR(Gamma)={:.15g}", border + 6e-7 * std::pow(mu, 20 - n));
    const std::string name = "at" + std::to_string(n), of_name = " -c " + name + " -d " + name + " -o " + name;
    const std::string found = workspace
                                  .succeed("simulate ball " + gamma +
                                           " --transient-events 3500 --recognition 1e-9 --max-period 40 --dat " + name)
                                  .out;
    INFO(found);
    CHECK(contains(found, "signature {(1,1,1)}^" + std::to_string(n)));
    workspace.succeed("run ball" + of_name + " DSMAX=0.002 DS=0.0001 NMX=100 RL1=1.598 EPSL=1e-11 EPSU=1e-11");
    distances.push_back(label_of(workspace.solutions(name), doubling).parameter(1) - border);
  }
  // What a return adds to the distance falls by kappa^2 with each impact, what is left of it by 1 / mu.
  const double first = mu - distances[0] / distances[1], second = mu - distances[1] / distances[2];
  CHECK(first > 0.0);
  CHECK(std::abs(second / first - kappa * kappa * mu) < 0.02);
  // So near to the border flights fall by the factor kappa for long, and do not accumulate.
  const std::string near = fmt::format("PAR(Gamma)={:.15g}", border + 6e-7 * mu * mu);
  CHECK_FALSE(contains(workspace.tchat("simulate ball " + near + " --events 4000").out, "accumulate"));
}

TEST_CASE("an orbit with chatter goes on with more impacts before their limit, or with fewer") {
  const Workspace workspace;
  workspace.write("ball.tch", ball);
  workspace.succeed("simulate ball --dat rest -q");
  workspace.succeed("run ball -c rest -d rest -o locked NMX=3 EPSL=1e-11 EPSU=1e-11");
  const SolutionEntry before = workspace.solutions("locked").front();
  const auto durations = [](const SolutionEntry& orbit, int count) {
    std::vector<double> result;
    for (int k = 1; k <= count; ++k) result.push_back(orbit.parameter(60 + k));
    return result;
  };
  const std::string impact = "1,1,1;", rest = "1,1,3;2,2,4";
  for (const int explicit_impacts : {6, 4, 2, 1}) {
    INFO(explicit_impacts << " impacts");
    std::string signature;
    for (int k = 0; k < explicit_impacts; ++k) signature += impact;
    workspace.succeed(std::vector<std::string>{"resegment", "q.locked", "1", "--to", "signature", "--signature",
                                               signature + rest, "-o", "other"});
    workspace.succeed("run ball -c other -s other -o run NMX=1");
    const SolutionEntry after = workspace.solutions("run").front();
    const std::vector<double> old = durations(before, 5), now = durations(after, explicit_impacts + 2);
    for (std::size_t k = 0; k <= static_cast<std::size_t>(std::min(3, explicit_impacts)); ++k)
      CHECK(std::abs(old[k] - now[k]) < 1e-9);
    CHECK(std::abs(std::accumulate(now.begin(), now.end(), 0.0) - 2.0 * std::acos(-1.0)) < 1e-9);
    // And back.
    workspace.succeed(std::vector<std::string>{"resegment", "q.run", "EP1", "--to", "signature", "--signature",
                                               impact + impact + impact + rest, "-o", "back"});
    workspace.succeed("run ball -c back -s back -o back NMX=1");
    const std::vector<double> again = durations(workspace.solutions("back").front(), 5);
    for (std::size_t k = 0; k < 5; ++k) CHECK(std::abs(old[k] - again[k]) < 1e-9);
  }
  const Outcome none = workspace.tchat(
      std::vector<std::string>{"resegment", "q.locked", "1", "--to", "signature", "--signature", rest, "-o", "none"});
  CHECK(none.status == 2);
  CHECK(contains(none.err, "at least one impact comes before their limit"));
  // As many as rounding leaves no room for.
  std::string many;
  for (int k = 0; k < 60; ++k) many += impact;
  const Outcome outcome = workspace.tchat(std::vector<std::string>{"resegment", "q.locked", "1", "--to", "signature",
                                                                   "--signature", many + rest, "-o", "none"});
  CHECK(outcome.status == 2);
  CHECK(contains(outcome.err, "so many impacts do not come before the limit"));
}

TEST_CASE("in contact a clock is put back, and no release is missed where nothing else moves") {
  const Workspace workspace;
  workspace.write("clock.tch",
                  "par F=1.1, r=0.5\nnumber turn=2*pi\ninit h=0.5\nh' = v\nv' = -1 + F*sin(t)\nt' = 1\n"
                  "event floor = h\nevent full = turn - t\njump impact: v -> -r*v\njump back: t -> t - turn\n"
                  "contact resting on floor until lifts: flow, impact -> settled\n"
                  "after settled: resting until full -> back\n"
                  "after any: flow until floor -> impact, full -> back\n");
  const std::string out = workspace.succeed("simulate clock --dat clock --max-period 40").out;
  INFO(out);
  CHECK(contains(out, "Periodic orbit"));
  CHECK(contains(out, "period 6.28318530"));
  CHECK(contains(out, "resting for"));
  CHECK(contains(out, "until full"));
  CHECK(contains(out, "infinitely many impacts"));
  workspace.succeed("run clock -c clock -d clock -o clock NMX=2");
  CHECK(workspace.tchat("verify q.clock -p clock").status == 0);
}

TEST_CASE("in contact several further events are watched until the release") {
  // tau falls back twice in contact, and n counts where the clock passes 2.05 ms, in contact as well.
  const Workspace workspace;
  workspace.write("shaker.tch",
                  "par A=1.2e-4, f=50, r=0.6\nnumber g=9.81\ninit y=1.2e-3, tau=0.003\nw = 2*pi*f\n"
                  "y' = v\nv' = -g\ntau' = 1\nn' = 0\n"
                  "event landing = y - A*sin(w*tau)\nevent turn = 1/f - tau\nevent dip = 0.99 - cos(w*(tau - 0.0025))\n"
                  "jump impact: v -> -r*v + (1+r)*A*w*cos(w*tau)\njump back: tau -> tau - 1/f\njump count: n -> n + 1\n"
                  "contact resting on landing until lifts: flow, impact -> settled\n"
                  "after settled: resting until turn -> back, dip -> count\n"
                  "after any: flow until landing -> impact, turn -> back, dip -> count\n");
  workspace.succeed("simulate shaker --time 0.4 --rows 0");
  std::istringstream events(workspace.read("shaker.events"));
  std::string line;
  int turns = 0, dips_in_contact = 0;
  while (std::getline(events, line)) {
    int segment = 0, field = 0, event = 0;
    if (std::sscanf(line.c_str(), "%d %d %d", &segment, &field, &event) != 3) continue;
    turns += event == 2;
    dips_in_contact += field == 2 && event == 3;
  }
  CHECK(turns == 20);
  CHECK(dips_in_contact > 10);
}

TEST_CASE("a jump that moves states in contact has no limit that a simulation would take") {
  const Workspace workspace;
  workspace.write("moved.tch",
                  "par r=0.5, G=3\ninit y=0.1\ny' = v\nv' = -G\nz' = -z\nevent floor = y\n"
                  "jump imp: v -> -r*v, z -> z + 0.1\ncontact rest on floor until up: flow, imp -> lim\n"
                  "after any: flow until floor -> imp\n");
  const std::string out = workspace.tchat("simulate moved --rows 0 --wait 20").out;
  INFO(out);
  CHECK(contains(out, "the contact lasts"));
  CHECK_FALSE(contains(out, "no event within"));
}

TEST_CASE("check finds a jump whose impacts cannot accumulate, and says what restitution others have") {
  const Workspace workspace;
  std::string text = ball;
  workspace.write("ball.tch", text);
  const std::string right = workspace.succeed("check ball").out;
  INFO(right);
  CHECK(contains(right, "chatter of jump 1 (impact) at event 1 (landing): restitution 0.5 at"));
  const std::string velocity = "(1 + r)*moving";
  workspace.write("wrong.tch", text.replace(text.find(velocity), velocity.size(), "(1 + r)*w"));
  const Outcome wrong = workspace.tchat("check wrong");
  INFO(wrong.text());
  CHECK(wrong.status == 1);
  CHECK(contains(wrong.out, "are moved by"));
  CHECK(contains(wrong.out, "(state velocity)"));
  CHECK(contains(wrong.out, "impacts cannot accumulate"));
  CHECK(contains(workspace.succeed("check ball PAR(r)=1.2").out, "restitution 1.2 at"));
}

TEST_CASE("multipliers of an orbit with chatter are those of its impacts, and three are zero") {
  const Workspace workspace;
  workspace.write("two.tch", two_masses);
  const std::string text = workspace.succeed("simulate two --dat two -o two").out;
  INFO(text);
  CHECK(contains(text, "then settled (infinitely many impacts)"));
  CHECK(contains(text, "start u1 = -0.12446926841"));
  workspace.succeed("run two -c two -d two -o branch NMX=2 IID=3");
  std::vector<std::complex<double>> found = multipliers(workspace.read("d.branch"));
  REQUIRE(found.size() == 6);
  std::sort(found.begin(), found.end(), [](auto a, auto b) { return std::abs(a) > std::abs(b); });
  CHECK(std::abs(std::complex(found[0].real(), std::abs(found[0].imag())) -
                 std::complex(0.16678206420953, 0.02429332816162)) < 1e-9);
  CHECK(std::abs(found[1] - std::conj(found[0])) < 1e-9);
  for (std::size_t k = 3; k < 6; ++k) CHECK(std::abs(found[k]) < 1e-10);  // the third is that of the drive's circle
}

TEST_CASE("a relief valve chatters, in any units") {
  const Workspace workspace;
  for (const std::string u : {"1", "1e-3", "1e-9"}) {
    INFO("u = " << u);
    workspace.write("valve.tch", valve(u));
    const std::string text = workspace.succeed("simulate valve --dat valve -o valve").out;
    INFO(text);
    CHECK(contains(text, "period 2.8137143271"));
  }
}

TEST_CASE("impacts of a valve cease to accumulate above q = 0.02 for r = 0.8, sections between them or not") {
  const Workspace workspace;
  std::string text = valve("1");
  workspace.write("valve.tch", text);
  workspace.write("cut.tch", text.replace(text.find("after any:"), std::string::npos,
                                          "event top = v\nafter any: flow until seat -> impact, top -> identity\n"));
  for (const char* problem : {"valve", "cut"}) {
    INFO(problem);
    const std::string command =
        std::string("simulate ") + problem + " PAR(r)=0.8 --events 600 --max-period 250 PAR(q)=";
    CHECK(contains(workspace.succeed(command + "0.02").out, "infinitely many impacts"));
    const std::string beyond = workspace.succeed(command + "0.021").out;
    INFO(beyond);
    CHECK(contains(beyond, "Chatter is not complete"));
  }
}

TEST_CASE("mistakes in contact statements have their line and cure") {
  const Workspace workspace;
  const auto with = [](const std::string& line) {
    std::string text = ball;
    const std::string old = "contact resting on landing until lifts: flow, impact -> settled";
    return text.replace(text.find(old), old.size(), line);
  };
  const std::pair<const char*, const char*> mistakes[] = {
      {"contact resting on landing: flow, impact -> settled", "it is written 'contact NAME on EVENT until EVENT"},
      {"contact resting on floor until lifts: flow, impact -> settled", "there is no event 'floor'"},
      {"contact resting on landing until lifts: flow, bounce -> settled", "there is no jump 'bounce'"},
      {"contact resting on landing until landing: flow, impact -> settled", "there are two events with the name"},
      {"contact resting on landing until lifts: resting, impact -> settled", "is made by a slide or contact statement"},
  };
  for (const auto& [line, message] : mistakes) {
    INFO(line);
    workspace.write("ball.tch", with(line));
    const Outcome outcome = workspace.tchat("check ball");
    INFO(outcome.text());
    CHECK(outcome.status == 2);
    CHECK(contains(outcome.text(), message));
    CHECK(contains(outcome.text(), "ball.tch:11"));
  }
}
