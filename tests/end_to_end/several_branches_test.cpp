// Branch points of symmetric problems, where several multipliers or eigenvalues come to the same value together: all
// branches that leave there, one for each MODE, against what the symmetry says and closed forms.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <set>
#include <sstream>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

using Words = std::vector<std::string>;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The rows of `tchat orbit LABEL --csv`: time, then states.
std::vector<std::vector<double>> rows_of(const Workspace& workspace, const std::string& branch,
                                         const std::string& label) {
  std::istringstream lines(workspace.succeed(Words{"orbit", "q." + branch, label, "--csv"}).out);
  std::vector<std::vector<double>> rows;
  std::string line;
  while (std::getline(lines, line)) {
    if (line.empty() || std::string("0123456789-.").find(line[0]) == std::string::npos) continue;
    std::istringstream words(line);
    std::string word;
    rows.emplace_back();
    while (std::getline(words, word, ',')) rows.back().push_back(word.empty() ? NAN : std::stod(word));
  }
  REQUIRE_FALSE(rows.empty());
  return rows;
}

}  // namespace

TEST_CASE("a ring of three oscillators: three branches leave where two multipliers go through +1, one for each pair") {
  // Stuart-Landau oscillators z' = (1 + 3 i) z - (1 + i c) |z|^2 z + K (1 + i b) (sum of the others - 2 z). In phase,
  // each of the two other modes has l^2 + 2 (1 + k) l + k^2 (1 + b^2) + 2 k (1 + b c) = 0 with k = 3 K: zero at
  // c = -(k (1 + b^2) + 2) / (2 b) = -5/4, and the period is 2 pi / (3 - c). The symmetry is that of a triangle:
  // branches have two oscillators alike, and the third not.
  const Workspace workspace;
  std::string ring = "par c=-1, b=2, K=0.2\ninit x1=1, y1=0, x2=1, y2=0, x3=1, y3=0\n";
  for (const auto* const k : {"123", "231", "312"}) {
    const std::string a(1, k[0]), b(1, k[1]), c(1, k[2]);
    ring += "r" + a + " = x" + a + "^2 + y" + a + "^2\n";
    ring +=
        "p" + a + " = x" + b + " + x" + c + " - 2*x" + a + "\nq" + a + " = y" + b + " + y" + c + " - 2*y" + a + "\n";
    ring += "x" + a + "' = x" + a + " - 3*y" + a + " - r" + a + "*(x" + a + " - c*y" + a + ") + K*(p" + a + " - b*q" +
            a + ")\n";
    ring += "y" + a + "' = y" + a + " + 3*x" + a + " - r" + a + "*(y" + a + " + c*x" + a + ") + K*(q" + a + " + b*p" +
            a + ")\n";
  }
  workspace.write("ring.tch", ring);
  workspace.succeed("simulate ring --dat s -q");
  const std::string in_phase =
      workspace.succeed("run ring -c s -d s -o b ICP=[c] DS=-.02 DSMAX=.1 RL0=-1.5 NMX=100").out;
  INFO(in_phase);
  CHECK(contains(in_phase, "BP label 2 at c = -1.25: branch point: 2 multipliers go through +1 together"));
  CHECK_FALSE(contains(in_phase, "may be missing"));
  std::set<int> others;
  double period = 0.0;
  for (const char* const mode : {"1", "2", "3"}) {
    const std::string name = std::string("c") + mode;
    const Outcome run =
        workspace.succeed(Words{"run", "ring", "-c", "r.b", "-s", "b", "IRS=BP1", "ISW=-1", "-o", name, "NMX=40",
                                "UZR={c: -1.26}", "STOP=UZ1", std::string("MODE=") + mode, "--both"});
    INFO(run.out + run.err);
    CHECK(contains(run.err, "number " + std::string(mode) + " (MODE = 1 to 3)"));
    CHECK(contains(run.err, "3 branches were found to leave label 2"));
    const auto rows = rows_of(workspace, name, "UZ1");
    // Of the pairs (2, 3), (3, 1), (1, 2) one is alike along the whole orbit.
    std::array<double, 3> apart{};
    for (const auto& row : rows) {
      const auto x = [&](std::size_t k) { return row.at(row.size() - 6 + 2 * k); };
      for (std::size_t k = 0; k < 3; ++k) apart[k] = std::max(apart[k], std::abs(x((k + 1) % 3) - x((k + 2) % 3)));
    }
    const auto alike = std::min_element(apart.begin(), apart.end());
    CHECK(*alike < 1e-7);
    CHECK(*std::max_element(apart.begin(), apart.end()) > 1e-2);
    others.insert(static_cast<int>(alike - apart.begin()));
    const double own = rows.back().front();
    CHECK(own != Approx(2.0 * std::numbers::pi / (3.0 + 1.26)).epsilon(1e-4));
    if (period > 0.0) CHECK(own == Approx(period).epsilon(1e-8));
    period = own;
    CHECK(workspace.succeed(Words{"verify", "q." + name, "UZ1"}).status == 0);
  }
  CHECK(others.size() == 3);
  const Outcome fourth =
      workspace.tchat(Words{"run", "ring", "-c", "r.b", "-s", "b", "IRS=BP1", "ISW=-1", "MODE=4", "-o", "d"});
  CHECK(fourth.status == 2);
  CHECK(contains(fourth.err, "MODE = 4, but 3 branches were found to leave label 2; allowed: 1 to 3"));
}

TEST_CASE("two eigenvalues go through 0 together: BP, and all four branches of equilibria in closed form") {
  // x' = p x - x^3 - a x y^2, y' = p y - y^3 - a x^2 y: on the axes x^2 = p, on the diagonals x^2 = y^2 = p / (1 + a).
  const Workspace workspace;
  workspace.write("square.tch", R"(par p=-0.5, a=0.5
init x=0, y=0
x' = p*x - x^3 - a*x*y^2
y' = p*y - y^3 - a*x^2*y
)");
  workspace.succeed("simulate square --state 0,0 --dat s -q");
  const std::string out = workspace
                              .succeed(Words{"run", "square", "-c", "s", "-d", "s", "-o", "b", "IPS=1", "ICP=[p]",
                                             "DS=.03", "RL0=-1", "RL1=1"})
                              .out;
  INFO(out);
  CHECK(contains(out, "BP label 2 at p = "));
  CHECK(contains(out, "branch point: 2 eigenvalues go through 0 together"));
  CHECK_FALSE(contains(out, "Hopf"));
  CHECK_FALSE(contains(out, "without a special point"));
  int on_axes = 0, on_diagonals = 0;
  for (const char* const mode : {"1", "2", "3", "4"}) {
    const std::string name = std::string("c") + mode;
    const Outcome run =
        workspace.succeed(Words{"run", "square", "-c", "r.b", "-s", "b", "IRS=BP1", "ISW=-1", "-o", name, "NMX=40",
                                "UZR={p: 0.36}", "STOP=UZ1", std::string("MODE=") + mode});
    INFO(run.out + run.err);
    CHECK(contains(run.err, "4 branches"));
    const std::vector<double> row = rows_of(workspace, name, "UZ1").front();
    const double x = std::abs(row.at(row.size() - 2)), y = std::abs(row.at(row.size() - 1));
    const double larger = std::max(x, y), smaller = std::min(x, y);
    if (smaller < 0.1) {
      ++on_axes;
      CHECK(larger == Approx(0.6).epsilon(1e-9));
      CHECK(smaller < 1e-9);
    } else {
      ++on_diagonals;
      CHECK(larger == Approx(0.6 / std::sqrt(1.5)).epsilon(1e-9));
      CHECK(smaller == Approx(larger).epsilon(1e-9));
    }
  }
  CHECK(on_axes == 2);
  CHECK(on_diagonals == 2);
}

namespace {

/// Equilibria from the origin, label BP1 in b.
void follow_origin(const Workspace& workspace, const std::string& name, const std::string& start) {
  workspace.succeed("simulate " + name + " --state " + start + " --dat s -q");
  workspace.succeed(Words{"run", name, "-c", "s", "-d", "s", "-o", "b", "IPS=1", "RL0=-1", "RL1=1.5", "-q"});
}

}  // namespace

TEST_CASE("three eigenvalues at 0 with the symmetry of a cube: thirteen branches, whatever couples the states") {
  // x' = p x - x (x^2 + a (y^2 + z^2)) and so on: 3 axes, 6 diagonals of faces, 4 of the cube.
  for (const char* const a : {"0.5", "2", "-0.3", "0.9"}) {
    const Workspace workspace;
    workspace.write("cube.tch", std::string("par p=-0.37, a=") + a + R"(
init x=0, y=0, z=0
x' = p*x - x*(x^2 + a*(y^2 + z^2))
y' = p*y - y*(y^2 + a*(z^2 + x^2))
z' = p*z - z*(z^2 + a*(x^2 + y^2))
)");
    follow_origin(workspace, "cube", "0,0,0");
    const Outcome many =
        workspace.tchat(Words{"run", "cube", "-c", "r.b", "-s", "b", "IRS=BP1", "ISW=-1", "MODE=99", "-o", "c"});
    INFO(a << "\n" << many.text());
    CHECK(contains(many.err, "13 branches were found"));
  }
}

TEST_CASE("a branch that crosses at the value 0 of the parameter is met with any step") {
  const Workspace workspace;
  workspace.write("logistic.tch", "par r=-0.5\ninit x=0\nx' = r*x - x^2\n");  // x = r
  follow_origin(workspace, "logistic", "0");
  for (const char* const step : {"0.01", "-0.01", "0.1"}) {
    const std::string ds = std::string("DS=") + step;
    workspace.succeed(Words{"run", "logistic", "-c", "r.b", "-s", "b", "IRS=BP1", "ISW=-1", "-o", "c", "NMX=1", ds});
    const std::vector<double> row = rows_of(workspace, "c", "EP1").front();
    CHECK(std::abs(row.back()) == Approx(std::abs(std::stod(step))).epsilon(1e-6));
    CHECK(workspace.points("c").front().rows.back().values[0] == Approx(row.back()).epsilon(1e-8));
  }
}
