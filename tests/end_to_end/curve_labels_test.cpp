// A label on a curve needs what defines it: no codimension two where its function is zero all along or has a pole, no
// fold where a branch turns by symmetry, ends that are located to their digits, multipliers only where they are known.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

using Words = std::vector<std::string>;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// The value behind NAME = in the line of a label, "  HB label 3 at b1 = -2e-12, b2 = ...".
double value_of(const std::string& out, const std::string& label, const std::string& name) {
  const std::size_t at = out.find("\n  " + label + " label ");
  REQUIRE(at != std::string::npos);
  const std::size_t value = out.find(" " + name + " = ", at);
  REQUIRE(value != std::string::npos);
  return std::stod(out.substr(value + name.size() + 4));
}

}  // namespace

TEST_CASE("1:3 resonance of a map whose Re d is the same at every angle: no Chenciner point beside it") {
  // z -> e^(i th) z (1 + p + (-0.5 + 0.3 i) |z|^2) + 0.6 conj(z)^2: Re d = -1.72, as Re 1 / (e^(3 i th) - 1) = -1/2.
  const Workspace workspace;
  workspace.write("r3.tch", R"(par p=-0.1, th=1.8, b=0.6
init tau=0, x=0, y=0
r2 = x^2 + y^2
A = x*(1 + p - 0.5*r2) - y*0.3*r2
B = y*(1 + p - 0.5*r2) + x*0.3*r2
tau' = 1
x' = 0
y' = 0
event tick = 1 - tau
jump apply: tau -> 0, x -> cos(th)*A - sin(th)*B + b*(x^2 - y^2), y -> sin(th)*A + cos(th)*B - 2*b*x*y
after any: tick -> apply
)");
  workspace.succeed("simulate r3 --state 0,0,0 --free p --refine --dat r3 -q");
  workspace.succeed("run r3 -d r3 -c r3 -o orbits RL0=-.1 RL1=.1 DS=.02");
  const std::string out = workspace
                              .succeed(Words{"run", "r3", "-c", "r.orbits", "-s", "orbits", "-o", "curve", "IRS=TR1",
                                             "ISW=2", "ICP=[th,p]", "RL0=1.7", "RL1=2.5", "DS=.02"})
                              .out;
  INFO(out);
  CHECK_FALSE(contains(out, "CH"));
  CHECK(value_of(out, "R3", "th") == Approx(2.0 * std::numbers::pi / 3.0).epsilon(1e-9));
}

TEST_CASE("Henon's map: R1 to R4 in closed form, and no Chenciner point where it preserves areas") {
  const Workspace workspace;
  workspace.write("hen.tch", R"(par alpha=2, beta=0
init x=1, y=1
x' = 0
y' = 0
phi' = 1
event turn = 1 - phi
jump map: x -> y, y -> alpha - beta*x - y^2, phi -> phi - 1
after any: turn -> map
)");
  const Words accurate{"EPSL=1e-11", "EPSU=1e-11", "EPSS=1e-11", "NTST=4"};
  const auto run = [&](Words words) {
    words.insert(words.end(), accurate.begin(), accurate.end());
    return workspace.succeed(words).out;
  };
  workspace.succeed("simulate hen --state 1,1,0 --free beta --refine --dat start -q");
  run({"run", "hen", "-c", "start", "-d", "start", "-o", "beta", "DS=0.02", "DSMAX=0.1", "RL0=-1.5", "RL1=1.5",
       "NMX=200", "--both"});
  const std::string out = run({"run", "hen", "-c", "r.beta", "-s", "beta", "-o", "tr", "IRS=TR1", "ISW=2",
                               "ICP=[alpha,beta]", "DS=0.02", "DSMAX=0.1", "RL0=-2", "RL1=4", "NMX=300", "--both"});
  INFO(out);
  CHECK_FALSE(contains(out, "CH label"));
  CHECK(contains(out, "so without special points: CH"));
  // A fixed point x has the multipliers of mu^2 + 2 x mu + 1, alpha = x^2 + 2 x.
  const std::vector<std::pair<const char*, double>> places{{"R1", -1.0}, {"R2", 3.0}, {"R3", 1.25}, {"R4", 0.0}};
  for (const auto& [label, alpha] : places) {
    INFO(label);
    CHECK(value_of(out, label, "alpha") == Approx(alpha).margin(1e-9));
    CHECK(value_of(out, label, "beta") == Approx(1.0).margin(1e-9));
  }
}

TEST_CASE("folds of a gear end where a contact has shrunk, at no cusp and no 1:1 resonance") {
  // By Liouville's formula the two nontrivial multipliers have the product exp(-2 zeta T): 0.13 there.
  const Workspace workspace;
  workspace.write("gear.tch", R"(par F=0.075, omega=0.6, zeta=0.05, fm=0.1
init x=1, v=-0.041275, s=0.823385, c=-0.567483
x' = v
base = fm + F*c - 2*zeta*v
s' = (1 - s^2 - c^2)*s + omega*c
c' = (1 - s^2 - c^2)*c - omega*s
field free:  v' = base
field drive: v' = base - (x - 1)
field back:  v' = base - (x + 1)
event touch_drive = 1 - x
event leave_drive = x - 1
event touch_back = x + 1
event leave_back = -1 - x
event top = v
after touch_drive: drive until leave_drive -> identity, top -> identity
after touch_back: back until leave_back -> identity, top -> identity
after top if x > 1: drive until leave_drive -> identity, top -> identity
after top if x < -1: back until leave_back -> identity, top -> identity
after any: free until touch_drive -> identity, touch_back -> identity, top -> identity
)");
  workspace.succeed(Words{"simulate", "gear", "--mode", "1,1,1;1,3,1;1,5,1", "--dat", "a", "-q"});
  workspace.succeed("run gear -c a -d a -o a --both RL0=0.01 RL1=0.3 DS=0.00145 DSMAX=0.0145 NMX=400 -q");
  const std::string longest = GENERATE("0.01", "0.03");
  const std::string out = workspace
                              .succeed(Words{"run", "gear", "-c", "r.a", "-s", "a", "IRS=3", "ISW=2", "-o", "lp",
                                             "ICP=[F,omega]", "RL0=0.01", "RL1=0.3", "BOUNDS={omega: [0.4, 1.6]}",
                                             "DS=-0.003", "DSMAX=" + longest, "NMX=400"})
                              .out;
  INFO(out);
  CHECK_FALSE(contains(out, "CP"));
  CHECK_FALSE(contains(out, "R1"));
  CHECK(value_of(out, "GR", "F") == Approx(0.0663324).margin(1e-7));
  CHECK(value_of(out, "GR", "omega") == Approx(0.62104).margin(1e-5));
}

TEST_CASE("where a branch turns by symmetry there is no fold to follow") {
  const Workspace workspace;
  workspace.write("fork.tch", R"(par p=0.5, q=0
init x=1, y=0, z=0.7
g = 1 - x^2 - y^2
x' = g*x - y
y' = g*y + x
z' = q + p*z - z^3
)");
  workspace.succeed("simulate fork --dat s -q");
  const std::string out = workspace.succeed("run fork -c s -d s -o b DS=-0.02 RL0=-1 RL1=1 NMX=100").out;
  INFO(out);
  CHECK(contains(out, "  BP label 2 at p = "));
  const Words curve{"run", "fork", "-c", "r.b", "-s", "b", "-o", "c", "ISW=2", "ICP=[p,q]"};
  for (const auto& [start, reason] : {std::pair{"IRS=LP1", "no point LP1"}, std::pair{"IRS=BP1", "ISW = 3"}}) {
    Words words = curve;
    words.push_back(start);
    const Outcome refused = workspace.tchat(words);
    CHECK(refused.status == 2);
    CHECK(contains(refused.err, reason));
  }
}

TEST_CASE("folds of AUTO's wav are found with any steps and tolerances") {
  const Workspace workspace;
  workspace.write("wav.tch", R"(par p1=3, p2=145, p3=500, p4=210, p5=3.4, p6=0.023, p7=0.2
init u1=62.7662, u2=88.8308
R = u2/(p5 + u2)*u1/(1 + u1 + p6*u1^2)
u1' = -p1*(p4*R - (p2 - u1))
u2' = -p1*(p4*R - p7*(p3 - u2))
)");
  workspace.write("wav.dat", "62.7662 88.8308\n");
  workspace.write("gc.wav", "NDIM = 2, IPS = 1, IRS = 0\nICP = [p3]\nRL0 = 400, RL1 = 800, NMX = 900\n");
  for (const char* const settings :
       {"DS=1 DSMAX=2 EPSL=1e-10 EPSU=1e-10 EPSS=1e-10",
        "DS=1.697575701399987 DSMAX=19.887155223508007 EPSL=1e-9 "
        "EPSU=1e-9 EPSS=1e-11",
        "DS=0.16025175730364813 DSMAX=1.2884180019674816 EPSL=1e-9 EPSU=1e-9 EPSS=1e-11",
        "DS=0.3275222014237624 DSMAX=3.1454282489846053 EPSL=1e-7 EPSU=1e-7 EPSS=1e-10 IADS=3"}) {
    INFO(settings);
    const std::string out = workspace.succeed(std::string("run wav ") + settings).out;
    CHECK(value_of(out, "LP", "p3") == Approx(666.1441048).epsilon(1e-9));
    CHECK(count_of(out, ": fold") == 2);
  }
}

TEST_CASE("the fold of a canard explosion has a label, or its change of stability is told") {
  // FitzHugh and Nagumo, AUTO's fhn: a = 0.430518, T = 16.6267.
  const Workspace workspace;
  workspace.write("fhn.tch", "par a=0, b=0.8, c=3\ninit x=0, y=0\nx' = c*(x - x^3/3 + y)\ny' = -(x - a + b*y)/c\n");
  workspace.write("fhn.dat", "0 0\n");
  workspace.write("gc.fhn",
                  "NDIM = 2, IPS = 1\nICP = [a]\nRL0 = 0, RL1 = 1, NMX = 400\nDS = 0.02, DSMAX = 0.05\n"
                  "EPSL = 1e-10, EPSU = 1e-10, EPSS = 1e-10\n");
  workspace.succeed("run fhn -o rest -q");
  for (const std::string intervals : {"50", "100", "200"}) {
    const std::string out =
        workspace
            .succeed(Words{"run", "fhn", "-c", "r.rest", "-s", "rest", "-o", "cycles", "IRS=HB1", "IPS=180", "ISW=-1",
                           "DS=0.02", "DSMAX=0.2", "NTST=" + intervals, "NMX=400", "RL0=-0.1", "UZR={-a: 0}", "ISP=2"})
            .out;
    INFO(out);
    const bool has_label = contains(out, "\n  LP label ");
    CHECK(has_label != contains(out, "the stability changes without a special point"));
    if (intervals != "50") CHECK(has_label);
    if (!has_label) continue;
    CHECK(value_of(out, "LP", "a") == Approx(0.430518245).epsilon(1e-8));
    CHECK(contains(out, "1.66268E+01"));
  }
}

TEST_CASE("near a homoclinic orbit multipliers are noise: stability is not known, and the branch goes on") {
  const Workspace workspace;
  SECTION("a rimless wheel, whose multiplier is cos^2(2 spoke) on every slope") {
    workspace.write("wheel.tch", R"(par slope=0.08, spoke=0.39269908169872414, g=9.81, l=1
init th=-0.3126990816987241, w=1.5
th' = w
w' = g/l*sin(th)
event heel = slope + spoke - th
event backheel = th - slope + spoke
jump step: th -> th - 2*spoke, w -> w*cos(2*spoke)
jump stepback: th -> th + 2*spoke, w -> w*cos(2*spoke)
after any: heel -> step, backheel -> stepback
)");
    workspace.succeed("simulate wheel --dat w -q");
    const std::string out =
        workspace.succeed("run wheel -c w -d w -o down DS=-0.002 RL0=0.05 DSMAX=0.02 NMX=60 IID=3").out;
    INFO(out);
    CHECK(contains(out, ", 0 unstable and "));
    CHECK(contains(out, " of unknown stability"));
    CHECK_FALSE(contains(out, "may be missing"));
    // Where the multiplier is printed, it is right within the uncertainty that is printed with it.
    const std::string file = workspace.read("d.down");
    int known = 0;
    for (std::size_t at = file.find("Multiplier   1 "); at != std::string::npos;
         at = file.find("Multiplier   1 ", at + 1)) {
      const double mu = std::stod(file.substr(at + 15));
      const std::string list = file.substr(at, 400);
      const std::size_t note = list.find("are known to ");
      const double uncertainty = note < list.find("\n  BR") ? std::stod(list.substr(note + 13)) : 1e-7;
      if (list.find("not determined") < list.find("\n  BR")) continue;
      CHECK(std::abs(mu - 0.5) <= 2.0 * uncertainty + 1e-6);
      ++known;
    }
    CHECK(known > 30);
  }
  SECTION("AUTO's ab at B = 17 to the period 100") {
    workspace.write("ab.tch", R"(par D=0.05, B=17, beta=3
init u1=0.05, u2=0.3
r = D*(1 - u1)*exp(u2)
u1' = -u1 + r
u2' = -u2 + B*r - beta*u2
)");
    workspace.succeed("simulate ab --dat s -q");
    workspace.succeed("run ab -c s -d s -o rest DS=0.005 DSMAX=0.1 RL0=0 RL1=0.5 NMX=300 -q");
    const std::string out = workspace
                                .succeed(Words{"run",
                                               "ab",
                                               "-c",
                                               "r.rest",
                                               "-s",
                                               "rest",
                                               "-o",
                                               "cycles",
                                               "IRS=HB2",
                                               "IPS=180",
                                               "ISW=-1",
                                               "DS=0.02",
                                               "DSMAX=0.5",
                                               "NTST=200",
                                               "IAD=3",
                                               "EPSL=1e-7",
                                               "EPSU=1e-7",
                                               "NMX=400",
                                               "UZR={-period: 100}",
                                               "RL1=0.3"})
                                .out;
    INFO(out);
    // AUTO-07p with the same settings.
    CHECK(value_of(out, "UZ", "D") == Approx(0.11945482404).epsilon(1e-9));
  }
}

TEST_CASE("orbits that shrink end at the Hopf bifurcation, folds at the generalised Hopf point, to their digits") {
  // r' = r (b1 + b2 r^2 - r^4): cycles end at b1 = 0, folds, b1 = -b2^2 / 4, at the origin.
  const Workspace workspace;
  workspace.write("gh.tch", R"(par b1=0.05, b2=0.5
init x=0.9, y=0, z=0.3
r2 = x^2 + y^2
g = b1 + b2*r2 - r2^2
x' = g*x - y*(1 + 0.3*r2)
y' = g*y + x*(1 + 0.3*r2)
z' = -z + 0.3*x^2 + b1
)");
  workspace.succeed("simulate gh --dat s -q");
  const std::string cycles = workspace.succeed("run gh -c s -d s -o c DS=-0.02 RL0=-1 RL1=1 NMX=200 DSMAX=0.05").out;
  INFO(cycles);
  CHECK(std::abs(value_of(cycles, "HB", "b1")) < 1e-10);
  CHECK(contains(cycles, "x = 0, y = 0"));
  const std::string folds = workspace
                                .succeed(Words{"run", "gh", "-c", "r.c", "-s", "c", "-o", "f", "IRS=LP1", "ISW=2",
                                               "ICP=[b1,b2]", "RL0=-1", "RL1=1", "DS=0.02", "DSMAX=0.1", "NMX=100"})
                                .out;
  INFO(folds);
  CHECK(std::abs(value_of(folds, "GH", "b1")) < 1e-9);
  CHECK(std::abs(value_of(folds, "GH", "b2")) < 1e-9);
  // A run can start from the last cycle.
  const std::string back = workspace.succeed("run gh -c r.c -s c -o back IRS=HB1 DS=-0.02 NMX=20").out;
  CHECK(value_of(back, "LP", "b1") == Approx(-0.0625).epsilon(1e-8));
}

TEST_CASE("folds of AUTO's abc end at both generalised Hopf points, whatever the step, and do not go back over") {
  const Workspace workspace;
  workspace.write("abc.tch", R"(par D=0.1, alpha=1, beta=1.55, B=8, sigma=0.04
init u1=0.1
rate = D*exp(u3)
u1' = -u1 + rate*(1 - u1)
u2' = -u2 + rate*(1 - u1 - sigma*u2)
u3' = -u3 - beta*u3 + rate*B*(1 - u1 + alpha*sigma*u2)
)");
  workspace.succeed("simulate abc --dat s -q");
  workspace.succeed("run abc -c s -d s -o eq DS=0.01 DSMAX=0.05 NMX=500 RL1=0.5");
  // The first Lyapunov coefficient is 0 on the curve of Hopf points: another condition, of equilibria alone.
  const std::string hopf = workspace
                               .succeed(Words{"run", "abc", "-c", "r.eq", "-s", "eq", "-o", "h", "IRS=HB3", "ISW=2",
                                              "ICP=[D,alpha]", "DS=-0.01", "DSMAX=0.05", "NMX=200", "RL0=0.1"})
                               .out;
  workspace.succeed("run abc -c r.eq -s eq -o c IRS=HB3 IPS=180 ISW=-1 NTST=60 NMX=200");
  INFO(hopf);
  REQUIRE(count_of(hopf, "\n  GH label ") == 2);
  const std::string second = hopf.substr(hopf.rfind("\n  GH label "));
  const std::string step = GENERATE("0.02", "0.05", "0.2");
  for (const bool is_second : {false, true}) {
    const std::string folds =
        workspace
            .succeed(Words{"run", "abc", "-c", "r.c", "-s", "c", "-o", "f", "IRS=LP1", "ISW=2", "ICP=[D,alpha]",
                           is_second ? "DS=-0.01" : "DS=0.01", "DSMAX=" + step, "NMX=700", "RL0=0.1", "RL1=0.6"})
            .out;
    INFO(folds);
    const std::string& expected = is_second ? second : hopf;
    CHECK(value_of(folds, "GH", "D") == Approx(value_of(expected, "GH", "D")).margin(5e-9));
    CHECK(value_of(folds, "GH", "alpha") == Approx(value_of(expected, "GH", "alpha")).margin(1e-7));
    CHECK(contains(folds, "its parameters are known to"));
    CHECK(count_of(folds, "\n  CP label ") == (is_second ? 1 : 0));
  }
}

TEST_CASE("where the first parameter turns along a curve of folds or doublings there is a label") {
  const Workspace workspace;
  // In polar coordinates r' = -r ((r - 2)^2 - (p - q^2)): folds at p = q^2.
  workspace.write("turning.tch", R"(par p=0.25, q=0.3
init x=2.4, y=0
r = sqrt(x^2 + y^2)
g = (r - 2)^2 - (p - q^2)
x' = -x*g - y
y' = -y*g + x
)");
  workspace.succeed("simulate turning --free p --dat s -q");
  workspace.succeed("run turning -c s -d s -o orbits DS=-0.02 DSMAX=.05 RL0=-.1 NMX=60 STOP=LP1");
  for (const char* const step : {"DS=-0.02", "DS=0.02"}) {
    const std::string out =
        workspace
            .succeed(Words{"run", "turning", "-c", "r.orbits", "-s", "orbits", "-o", "folds", "IRS=LP1", "ISW=2",
                           "ICP=[p,q]", "DSMAX=.1", "RL0=-1", "RL1=1", "NMX=40", step, "UZR={q: -0.5}"})
            .out;
    INFO(out);
    if (!contains(out, "q = -0.5")) continue;
    CHECK(count_of(out, "\n  EX label ") == 1);
    CHECK(contains(out, "extremum of p along the curve"));
    CHECK(std::abs(value_of(out, "EX", "p")) < 1e-10);
    CHECK(std::abs(value_of(out, "EX", "q")) < 1e-7);
  }
  // The logistic map's doubling at a = 3, where a = 2.8 + p - q^2: p = 0.2 + q^2.
  workspace.write("doubling.tch", R"(par p=0.8, q=0.5
init tau=0, x=0.5
a = 2.8 + p - q^2
x' = 0
tau' = 1
event turn = 1 - tau
jump map: x -> a*x*(1 - x), tau -> 0
after any: turn -> map
)");
  workspace.succeed("simulate doubling PAR(p)=0.3 --free p --dat d -q");
  workspace.succeed("run doubling -c d -d d -o fixed DS=0.02 RL1=1");
  const std::string out = workspace
                              .succeed(Words{"run", "doubling", "-c", "r.fixed", "-s", "fixed", "-o", "curve",
                                             "IRS=PD1", "ISW=2", "ICP=[p,q]", "RL0=-1", "RL1=1", "NMX=60", "DS=-0.02"})
                              .out;
  INFO(out);
  CHECK(std::abs(value_of(out, "EX", "p") - 0.2) < 1e-9);
}

TEST_CASE("where the rules of the model have another impact a branch ends, and goes on inadmissible if it must") {
  // A relief valve that stays closed once it hits its seat slowly: |y2| < eps.
  const Workspace workspace;
  workspace.write("closing.tch", R"(par q=0.1, kappa=1.25, beta=20, delta=10, r=0.8, eps=0.05
init y1=0.5, y3=10.5
field flow: y1' = y2, y2' = -kappa*y2 - (y1 + delta) + y3, y3' = beta*(q - y1*sqrt(y3))
field closed: y1' = 0, y2' = 0, y3' = beta*q
event seat = y1
event opens = delta - y3
jump impact: y2 -> -r*y2
jump settle: y1 -> 0, y2 -> 0
after impact if abs(y2) < eps and y3 < delta: flow until seat -> settle
after settle: closed until opens -> identity
after opens: flow until seat -> impact
after any: flow until seat -> impact
)");
  // Eight impacts at q = 0.05, as simulated; at q = 0.1 the seventh is faster than eps.
  workspace.succeed(Words{"simulate", "closing", "PAR(q)=0.05", "--dat", "c1", "-q"});
  const std::string run = "run closing -c c1 -d c1 DS=0.005 DSMAX=0.02 RL0=0.01 RL1=0.6 NMX=200 UZR={q:0.1} ";
  const std::string ends = workspace.succeed(run + "-o first").out;
  INFO(ends);
  // The seventh impact has the velocity -eps there, to EPSS.
  CHECK(value_of(ends, "GR", "q") < 0.1);
  CHECK(contains(ends, "y1 = 0, y2 = -0.0"));
  const std::size_t at = ends.find("y1 = 0, y2 = ");
  CHECK(std::stod(ends.substr(at + 13)) == Approx(-0.05).epsilon(1e-6));
  workspace.succeed("simulate closing -s first IRS=GR1 --dat on -q");
  const std::string out = workspace.succeed(run + "-o low GRSTOP=0").out;
  INFO(out);
  CHECK(contains(out, "inadmissible"));
  CHECK(contains(workspace.read("d.low"), "the problem's rules lead to another segment"));
}
