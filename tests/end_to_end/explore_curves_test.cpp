// tchat explore --and: curves in two parameters that are known in closed form, and the points that they have in common.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>

#include "end_to_end/bouncing_ball.hpp"
#include "end_to_end/closed_forms.hpp"
#include "end_to_end/workspace.hpp"
#include "files/point_file_reader.hpp"

using namespace test_support;

namespace {

constexpr double zeta = 0.05, restitution = 0.8;

/// The name of the first curve of a kind whose origin ends with, or is, one of `from`, as "PD 3 of b2" or " of b2".
std::string curve_from(const std::string& tree, const std::string& kind, const std::vector<std::string>& from) {
  const std::string word = "  " + kind + " curve ";
  for (std::size_t at = tree.find(word); at != std::string::npos; at = tree.find(word, at + 1)) {
    const std::size_t line = tree.rfind('\n', at) + 1;
    const std::string origin = tree.substr(at, tree.find(':', at) - at);
    if (std::any_of(from.begin(), from.end(), [&](const std::string& end) { return origin.ends_with(end); }))
      return tree.substr(line, at - line);
  }
  FAIL("no " << kind << " curve from " << from.back() << " in\n" << tree);
  return "";
}

/// " of b7" for each branch whose line has this text.
std::vector<std::string> labels_of(const std::string& tree, const std::string& text) {
  std::vector<std::string> names;
  for (std::size_t at = tree.find(text); at != std::string::npos; at = tree.find(text, at + 1)) {
    const std::size_t line = tree.find_first_not_of(' ', tree.rfind('\n', at) + 1);
    names.push_back(" of " + tree.substr(line, tree.find(' ', line) - line));
  }
  return names;
}

/// The tree that `tchat explore` writes to OUTPUT.txt.
std::string explored(const Workspace& workspace, const std::string& words, const std::string& output) {
  const Outcome outcome = workspace.tchat("explore " + words + " -o " + output + " -j 2 -q");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  return workspace.read(output + ".txt");
}

struct Place {
  double first, second;
};

/// All points of a curve but its ends.
std::vector<Place> inner_points(const std::string& path, const std::string& second) {
  std::vector<Place> places;
  for (const tchat::PointSection& section : tchat::read_point_file(path).sections) {
    const auto column = std::find(section.columns.begin(), section.columns.end(), second) - section.columns.begin();
    for (std::size_t k = 0; k + 1 < section.rows.size(); ++k)
      places.push_back({section.rows[k].values.front(), section.rows[k].values[static_cast<std::size_t>(column)]});
  }
  REQUIRE(places.size() > 4);
  return places;
}

double squared_alpha(double velocity, double omega, int periods) {
  return std::pow(ImpactingOrbit(velocity, omega, zeta, restitution, periods).alpha(), 2);
}

/// The fold of the orbits with one impact in so many periods: alpha^2 is quadratic in the impact velocity.
double fold(double omega, int periods) {
  const double zero = squared_alpha(0.0, omega, periods);
  const double one = squared_alpha(1.0, omega, periods), two = squared_alpha(2.0, omega, periods);
  const double second = 0.5 * (two - 2.0 * one + zero), first = one - zero - second;
  return std::sqrt(zero - first * first / (4.0 * second));
}

/// Their doubling. With E the free oscillator's flow over the period and S the impact's saltation matrix
/// ((-r, 0), (s, -r)), s = (1 + r) (alpha y2 - 1)/v, the multiplier -1 has 1 + tr(E S) + det(E S) = 0, which is linear
/// in s; alpha y2 at the impact is linear in v.
double doubling(double omega, int periods) {
  const double time = 2.0 * M_PI * periods / omega, frequency = std::sqrt(1.0 - zeta * zeta);
  const double decay = std::exp(-zeta * time);
  const double s =
      (2.0 * restitution * decay * std::cos(frequency * time) - 1.0 - restitution * restitution * decay * decay) /
      (decay * std::sin(frequency * time) / frequency);
  const auto force = [&](double velocity) {
    const ImpactingOrbit orbit(velocity, omega, zeta, restitution, periods);
    return orbit.alpha() * orbit.at(0.0)[3];
  };
  const double at_rest = force(0.0), slope = force(1.0) - at_rest;
  const double velocity = (1.0 + restitution) * (at_rest - 1.0) / (s - (1.0 + restitution) * slope);
  return ImpactingOrbit(velocity, omega, zeta, restitution, periods).alpha();
}

}  // namespace

TEST_CASE("the impact oscillator: folds and doublings of three periods come from points of the grazing curve") {
  const Workspace workspace;
  const Outcome outcome =
      workspace.tchat("explore linosc --over alpha=1:40:41 --and omega=1.4:6.5 PAR(omega)=2.0072 -o osc -q -j 2");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const std::string tree = workspace.read("osc.txt");
  INFO(tree);
  const auto points = [&](const std::string& name) { return inner_points(workspace.file("osc/p." + name), "omega"); };

  for (const Place& point : points(curve_from(tree, "GR", {" of b1"})))
    CHECK(point.first ==
          Approx(std::hypot(1.0 - point.second * point.second, 2.0 * zeta * point.second)).epsilon(1e-8));
  // Where xi_k = 0 and xi_n > 0 for n < k: the free oscillator makes half a turn in k periods.
  for (int k = 1; k <= 3; ++k) {
    const std::vector<std::string> family =
        labels_of(tree, "  one impact in " + std::to_string(k) + " return" + (k > 1 ? "s" : "") + ", at omega");
    INFO("one impact in " << k << " periods");
    const std::string folds = curve_from(tree, "LP", family);
    const std::string doublings = curve_from(tree, "PD", k == 1 ? std::vector<std::string>{"PD 3 of b2"} : family);
    for (const Place& point : points(folds)) CHECK(point.first == Approx(fold(point.second, k)).epsilon(1e-8));
    for (const Place& point : points(doublings)) CHECK(point.first == Approx(doubling(point.second, k)).epsilon(1e-8));
    const double omega = 2.0 * k * std::sqrt(1.0 - zeta * zeta);
    const std::string joint = fmt::format("({:.10g}, {:.10g}): ", std::hypot(1.0 - omega * omega, 0.1 * omega), omega);
    const std::size_t at = tree.find(joint, tree.find("Codimension two"));
    REQUIRE(at != std::string::npos);
    const std::string members = tree.substr(at, tree.find('\n', at) - at);
    for (const std::string& name : {folds, doublings, curve_from(tree, "GR", {" of b1"})})
      CHECK(members.find(name) != std::string::npos);
  }

  SECTION("the same command finds all of it done, and make makes the curves") {
    REQUIRE(
        workspace.tchat("explore linosc --over alpha=1:40:41 --and omega=1.4:6.5 PAR(omega)=2.0072 -o osc -q").status ==
        0);
    CHECK(workspace.read("osc.txt") == tree);
    const std::string file = "osc/p." + curve_from(tree, "PD", labels_of(tree, "  one impact in 3 returns, at omega"));
    const std::string before = workspace.read(file);
    REQUIRE(workspace.shell("mkdir made && cp linosc.so Makefile.osc made").status == 0);
    const Outcome made = workspace.make("made", "-s -f Makefile.osc " + file);
    INFO(made.text());
    REQUIRE(made.status == 0);
    CHECK(workspace.read("made/" + file) == before);
  }
}

TEST_CASE("the bouncing ball in two parameters: each curve once, whichever branch has its label") {
  const Workspace workspace;
  workspace.write("ball.tch", bouncing_ball);
  const Outcome outcome = workspace.tchat("explore ball --over Gamma=1:1.7:71 --and r=0.35:0.6 --doublings 1 -o b -q");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const std::string tree = workspace.read("b.txt");
  INFO(tree);
  const auto birth = [](double r) { return M_PI * (1.0 - r) / (1.0 + r); };
  for (const Place& point : inner_points(workspace.file("b/p." + curve_from(tree, "LP", {"LP 4 of b1"})), "r"))
    CHECK(point.first == Approx(birth(point.second)).epsilon(1e-8));
  const std::string doublings = curve_from(tree, "PD", {"PD 2 of b1"});
  for (const Place& point : inner_points(workspace.file("b/p." + doublings), "r")) {
    const double r = point.second;
    const double slope = 2.0 * (1.0 + r * r) / ((1.0 + r) * (1.0 + r));
    CHECK(point.first == Approx(std::hypot(birth(r), slope)).epsilon(1e-8));
  }
  CHECK(tree.find("the edge r = 0.6") != std::string::npos);
  CHECK(tree.find("the edge Gamma = 1.7") != std::string::npos);
  // The doubled orbits have BP where the others have PD.
  CHECK(tree.find("-> b1, curve " + doublings) != std::string::npos);
  CHECK(tree.find("BP curve") == std::string::npos);
}

TEST_CASE("one impact in two returns: a period doubling is passed twice within a step that turns at a branch point") {
  const Workspace workspace;
  const Outcome outcome = workspace.tchat(
      "explore linosc --over alpha=1:40:41 PAR(omega)=2 --returns 2 --doublings 0 --branches 4 -o osc -q");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const std::string tree = workspace.read("osc.txt");
  INFO(tree);
  const std::vector<std::string> twice = labels_of(tree, "one impact in 2 returns, GR 2 of b1");
  REQUIRE(twice.size() == 1);
  const std::size_t at = tree.find("GR 3" + twice.front());
  REQUIRE(at != std::string::npos);
  const auto value = [&](const std::string& label) {
    return std::stod(tree.substr(tree.find(label, at) + label.size()));
  };
  // The branch goes back where it bifurcates from the orbits of one period, through the same orbits shifted by one.
  CHECK(value("BP 3 at ") == Approx(doubling(2.0, 1)).epsilon(1e-8));
  CHECK(value("PD 2 at ") == Approx(value("PD 4 at ")).epsilon(1e-8));
}

namespace {

/// How many curves of a kind a tree has.
std::size_t count_of(const std::string& tree, const std::string& kind) {
  std::size_t count = 0;
  const std::string word = "  " + kind + " curve ";
  for (std::size_t at = tree.find(word); at != std::string::npos; at = tree.find(word, at + 1)) ++count;
  return count;
}

/// The label of this type that is nearest to a place, of a curve.
Place nearest_label(const std::string& tree, const std::string& curve, const std::string& type, const Place& to) {
  Place best{INFINITY, INFINITY};
  const std::size_t from = tree.find("\n" + curve + "  ") + 1;
  for (std::size_t line = tree.find('\n', from) + 1; tree.compare(line, 4, "    ") == 0;
       line = tree.find('\n', line) + 1) {
    Place found{INFINITY, INFINITY};
    const std::string form = "    " + type + " %*d at (%lf, %lf)";
    if (std::sscanf(tree.c_str() + line, form.c_str(), &found.first, &found.second) == 2 &&
        std::hypot(found.first - to.first, found.second - to.second) <
            std::hypot(best.first - to.first, best.second - to.second))
      best = found;
  }
  return best;
}

/// Two curves have labels of these types at a place, and are listed together there.
void check_meeting(const std::string& tree, const Place& place, const std::vector<std::array<std::string, 2>>& labels,
                   double tolerance) {
  INFO("(" << place.first << ", " << place.second << ") in\n" << tree);
  for (const auto& [curve, type] : labels) {
    INFO(type << " of " << curve);
    const Place found = nearest_label(tree, curve, type, place);
    CHECK(found.first == Approx(place.first).epsilon(0.0).margin(tolerance));
    CHECK(found.second == Approx(place.second).epsilon(0.0).margin(tolerance));
  }
  bool is_listed = false;
  for (std::size_t at = tree.find("\n(", tree.find("Codimension two")); at != std::string::npos;
       at = tree.find("\n(", at + 1)) {
    Place found{};
    std::sscanf(tree.c_str() + at, "\n(%lf, %lf)", &found.first, &found.second);
    if (std::hypot(found.first - place.first, found.second - place.second) > 2.0 * tolerance) continue;
    const std::string members = tree.substr(at + 1, tree.find('\n', at + 1) - at);
    is_listed = is_listed || std::all_of(labels.begin(), labels.end(), [&](const auto& label) {
                  return members.find(label[0]) != std::string::npos;
                });
  }
  CHECK(is_listed);
}

}  // namespace

namespace {

constexpr double predators_on_surface = 1.6;

/// Predators and prey at rest, x = d/(1 - d) and y = (1 - x/K)(1 + x), on the surface.
void check_boundary(const std::string& path) {
  for (const Place& point : inner_points(path, "d")) {
    const double x = point.second / (1.0 - point.second);
    CHECK(point.first == Approx(x / (1.0 - predators_on_surface / (1.0 + x))).epsilon(1e-8));
  }
}

}  // namespace

TEST_CASE("predators and prey: Hopf, boundary and grazing curve end or cross where a cycle is born on the surface") {
  const Workspace workspace;
  REQUIRE(workspace.shell("cp " PREDATOR_SOURCE " .").status == 0);
  const Outcome outcome =
      workspace.tchat("explore predator --over K=0.5:6:56 --and d=0.3:0.8 --state 0.5,0.3 -o food -j 2 -q");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const std::string tree = workspace.read("food.txt");
  INFO(tree);
  for (const char* const kind : {"HB", "BE", "GR"}) CHECK(count_of(tree, kind) == 1);
  const std::string hopf = curve_from(tree, "HB", {" of b1", " of b2"}),
                    boundary = curve_from(tree, "BE", {" of b1", " of b2"});
  const std::string grazing = curve_from(tree, "GR", {" of b1", " of b2", " of b3", " of b4", " of b5", " of b6"});
  // The prey's isocline has its maximum at the Hopf bifurcation.
  for (const Place& point : inner_points(workspace.file("food/p." + hopf), "d"))
    CHECK(point.first == Approx((1.0 + point.second) / (1.0 - point.second)).epsilon(1e-8));
  check_boundary(workspace.file("food/p." + boundary));
  const double d = std::sqrt(1.0 - 1.0 / predators_on_surface);  // both
  check_meeting(tree, {(1.0 + d) / (1.0 - d), d}, {{hopf, "BE"}, {boundary, "HB"}, {grazing, "HB"}}, 1e-6);
  CHECK(tree.find("HB 4 at 3, curve " + hopf) != std::string::npos);  // where the cycles shrink
  CHECK(tree.find("Without a curve: BP 2 of b1, BP 5 of b2: the branches that cross at a BP of equilibria part when a "
                  "second parameter changes, unless a symmetry or an invariant set keeps the BP") != std::string::npos);
  // Here the BP persists, as prey alone is an invariant set: at another d, K = d / (1 - d).
  REQUIRE(workspace.tchat("explore predator --over K=0.5:2:16 PAR(d)=0.6 --state 0.5,0.3 -o other -q").status == 0);
  CHECK(workspace.read("other.txt").find("BP 2 at 1.5 ->") != std::string::npos);
}

TEST_CASE("predators and prey: a boundary curve from where the Hopf curve reaches the surface") {
  const Workspace workspace;
  REQUIRE(workspace.shell("cp " PREDATOR_SOURCE " .").status == 0);
  const Outcome outcome =
      workspace.tchat("explore predator --over K=2:4.5:26 --and d=0.45:0.7 --state 0.5,0.3 -o food -j 2 -q");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const std::string tree = workspace.read("food.txt");
  INFO(tree);
  CHECK(count_of(tree, "BE") == 1);
  const std::string boundary = curve_from(tree, "BE", {" of c1", " of c2", " of c3"});
  check_boundary(workspace.file("food/p." + boundary));
  // ISW = 2 from a label of the curve goes on along it.
  const std::string files = "food/r." + boundary + " -s food/" + boundary;
  REQUIRE(workspace.tchat("run predator -c " + files + " IRS=EP1 ISW=2 RL1=8 BOUNDS={} NMX=10 -o further").status == 0);
  check_boundary(workspace.file("p.further"));
}

TEST_CASE("equilibria and cycles: cusp, zero-Hopf, generalised Hopf and boundary points where curves meet") {
  // x' = b1 + b2 x - x^3 drives the growth x - 1 + l r^2 - r^4, l = b2 - 1, of an oscillation of the amplitude r.
  const Workspace workspace;
  workspace.write("cusp.tch",
                  "par b1=0, b2=1.5\ninit u=1, x=1.2\nr2 = u^2 + v^2\ngrowth = x - 1 + (b2 - 1)*r2 - r2^2\n"
                  "u' = growth*u - v\nv' = growth*v + u\nx' = b1 + b2*x - x^3\n"
                  "event low = x + 1\njump back: x -> 2\nafter any: low -> back\n");
  const std::string tree = explored(workspace, "cusp --over b1=-3:3:31 --and b2=-1:3.5", "c");
  INFO(tree);
  CHECK(count_of(tree, "LP") == 2);
  CHECK(count_of(tree, "HB") == 1);
  CHECK(count_of(tree, "BE") == 1);
  const std::string hopf = curve_from(tree, "HB", {" of b2"}), boundary = curve_from(tree, "BE", {" of b2"});
  const std::string folds = curve_from(tree, "LP", {" of b2"}),
                    cycles = curve_from(tree, "LP", labels_of(tree, ", HB "));
  const auto points = [&](const std::string& name) { return inner_points(workspace.file("c/p." + name), "b2"); };
  const auto at_rest = [](double x, double b2) { return Approx(x * x * x - b2 * x).epsilon(1e-8).margin(1e-8); };
  for (const Place& point : points(hopf)) CHECK(point.first == at_rest(1.0, point.second));
  for (const Place& point : points(boundary)) CHECK(point.first == at_rest(-1.0, point.second));
  for (const Place& point : points(folds))
    CHECK(std::abs(point.first) == at_rest(-std::sqrt(std::max(point.second, 0.0) / 3.0), point.second));
  for (const Place& point : points(cycles))
    CHECK(point.first == at_rest(1.0 - std::pow(point.second - 1.0, 2) / 4.0, point.second));
  const Place cusp = nearest_label(tree, folds, "CP", {0.0, 0.0});
  CHECK(std::hypot(cusp.first, cusp.second) <= 1e-8);
  check_meeting(tree, {-2.0, 3.0}, {{folds, "ZH"}, {hopf, "ZH"}}, 1e-8);
  check_meeting(tree, {2.0, 3.0}, {{folds, "BE"}, {boundary, "LP"}}, 1e-8);
  check_meeting(tree, {0.0, 1.0}, {{hopf, "GH"}, {cycles, "GH"}}, 1e-8);
}

TEST_CASE("a map: folds of doubled orbits begin at generalised period doubling") {
  // x -> -(1 + p) x + q x^3 + x^5: doubled orbits p = q x^2 + x^4 turn where q < 0 alone, at p = -q^2 / 4.
  const Workspace workspace;
  workspace.write("map.tch",
                  "par p=-0.3, q=0.3\ninit x=0.01\nx' = 0\nphi' = 1\nevent turn = 1 - phi\n"
                  "jump back: x -> -(1+p)*x + q*x^3 + x^5, phi -> phi - 1\nafter any: turn -> back\n");
  const std::string tree = explored(workspace, "map --over p=-0.3:0.1:21 --and q=-0.5:0.5", "m");
  INFO(tree);
  CHECK(count_of(tree, "LP") == 1);
  for (const Place& point : inner_points(workspace.file("m/p." + curve_from(tree, "LP", {" of c1", " of c2"})), "q")) {
    CHECK(point.first == Approx(-0.25 * point.second * point.second).margin(1e-8));
    CHECK(point.second < 0.0);
  }
}

TEST_CASE("a map: torus bifurcations of orbits and of doubled orbits end at a 1:2 resonance") {
  // Fixed points have the determinant 1 + p - q, doubled orbits 1 + p + (2 + d / c) q with d / c = -5/3 (q > 0).
  const Workspace workspace;
  workspace.write("map.tch",
                  "par p=-0.3, q=-0.2\ninit x=0.01, y=0\nx' = 0\ny' = 0\nphi' = 1\nevent turn = 1 - phi\n"
                  "jump back: x -> -x + y, y -> -(1+p)*y + q*x - 0.3*x^3 + 0.5*x^2*y, phi -> phi - 1\n"
                  "after any: turn -> back\n");
  const std::string tree = explored(workspace, "map --over q=-0.2:0.2:21 --and p=-0.5:0.5", "m");
  INFO(tree);
  CHECK(count_of(tree, "TR") == 2);
  const auto points = [&](const std::string& name) { return inner_points(workspace.file("m/p." + name), "p"); };
  const std::size_t end = tree.find("  TR curve born at R2");
  REQUIRE(end != std::string::npos);
  const std::size_t begin = tree.rfind('\n', end) + 1;
  for (const Place& point : points(tree.substr(begin, end - begin)))
    CHECK(point.second == Approx(-point.first / 3.0).margin(1e-8));
}

TEST_CASE("second ranges that are none are refused with the form") {
  const Workspace workspace;
  const auto refusal = [&](const std::string& words) {
    const Outcome outcome = workspace.tchat("explore linosc --over alpha=1:5 --and " + words);
    CHECK(outcome.status == 2);
    return outcome.text();
  };
  for (const char* const words : {"omega", "omega=3:2", "omega=1:3:100"})
    CHECK(refusal(words).find("as alpha=2.9:3.3") != std::string::npos);
  CHECK(refusal("beta=1:2").find("is no parameter of problem") != std::string::npos);
  CHECK(refusal("alpha=1:2").find("the parameter of --over") != std::string::npos);
  CHECK(refusal("omega=3:4").find("the diagram is at omega = 2, outside of this range") != std::string::npos);
}
