// Grazing in modes of different dimension: the contact is in a mode of 3 states between modes of 5 and 2, or leads to
// a mode with more states. The references are integrations of each mode with the states that it has.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "end_to_end/integrate_to.hpp"
#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

// ---- a ball that a spring with a lagging force catches, rests, and is thrown ----------------------------------------

constexpr const char* catcher = R"(par k=10, d=0.3, V=1, r=0.6, B=1
init v=1, rate=0.5
field flight: x' = v, v' = -1, lag' = x - lag, theta' = rate, rate' = -d*rate - sin(theta)
mode spring: states x, v, lag
field spring: x' = v, v' = -1 - k*x - d*lag, lag' = 3*(v - lag)
mode rest: states x, v
field rest: x' = -0.2*x + 0.1*v, v' = 1 + x
event floor = x
event lowest = -v
event alarm = 0.7 - v
event bottom = x + B + 0.3*lag + theta
jump catch to spring: lag -> lag + 0.1*rate
jump stop to rest: v -> 0.1*lag
jump throw: x -> 0, v -> V - 0.5*x, lag -> 0.2*x, theta -> 0.1*x, rate -> 0.5
jump bump to spring: v -> v - (1+r)*(v - 0.9*lag/1.9)
after catch: spring until lowest -> stop, bottom -> bump
after bump: spring until lowest -> stop, bottom -> bump
after stop: rest until alarm -> throw
after any: flight until floor -> catch
)";

using Spring = std::array<double, 3>;
constexpr double k = 10.0, d = 0.3, V = 1.0, r = 0.6;

void spring_field(const Spring& u, Spring& f, double) { f = {u[1], -1.0 - k * u[0] - d * u[2], 3.0 * (u[1] - u[2])}; }
/// h_D less B, and its rate; theta is 0 in this mode.
double height(const Spring& u) { return u[0] + 0.3 * u[2]; }
double rate(const Spring& u) { return 1.9 * u[1] - 0.9 * u[2]; }
Spring bumped(const Spring& u) { return {u[0], u[1] - (1.0 + r) * (u[1] - 0.9 * u[2] / 1.9), u[2]}; }

/// From the lowest point over rest and flight to where the spring is touched again.
Spring caught(const Spring& lowest) {
  std::array<double, 2> z{lowest[0], 0.1 * lowest[2]};
  integrate_to(
      z,
      [](const auto& u, auto& f, double) {
        f = {-0.2 * u[0] + 0.1 * u[1], 1.0 + u[0]};
      },
      [](const auto& u) { return 0.7 - u[1]; });
  std::array<double, 5> x{0.0, V - 0.5 * z[0], 0.2 * z[0], 0.1 * z[0], 0.5};
  integrate_to(
      x,
      [](const auto& u, auto& f, double) {
        f = {u[1], -1.0, u[0] - u[2], u[4], -d * u[4] - std::sin(u[3])};
      },
      [](const auto& u) { return u[0]; });
  return {x[0], x[1], x[2] + 0.1 * x[4]};
}

Spring to_lowest(Spring u) {
  integrate_to(u, spring_field, [](const Spring& y) { return -y[1]; });
  return u;
}
/// To P, where h_D is least.
Spring to_section(Spring u) {
  integrate_to(u, spring_field, [](const Spring& y) { return -rate(y); });
  return u;
}
/// The return map on P that ignores the contact.
Spring smooth_return(const Spring& u) { return to_section(caught(to_lowest(u))); }

/// The turn from one catch to the next with the wall at B.
Spring impacting_turn(Spring u, double B) {
  constexpr double on_wall = 1e-9;
  const auto least = [B](const Spring& y) { return std::min(-y[1], height(y) + B); };
  integrate_to(u, spring_field, least);
  while (height(u) + B < on_wall) {
    u = bumped(u);
    integrate_to(u, spring_field, least);
  }
  return caught(u);
}

struct Grazing {
  Spring contact;
  double B, a, xi_1, xi_2, eigenvalue;
};

Grazing exact_grazing() {
  Spring y{-0.46, -0.26, -0.55};
  for (int turn = 0; turn < 30; ++turn) y = smooth_return(y);  // the multiplier is 0.09
  Eigen::Matrix3d A;
  constexpr double step = 1e-3;  // differences of order 6: their errors are those of the integration over the step
  for (std::size_t c = 0; c < 3; ++c) {
    const auto at = [&](double share) {
      Spring moved = y;
      moved[c] += share * step;
      const Spring end = smooth_return(moved);
      return Eigen::Vector3d(end[0], end[1], end[2]);
    };
    const auto difference = [&](double n) { return Eigen::Vector3d(at(n) - at(-n)); };
    A.col(static_cast<Eigen::Index>(c)) =
        (45.0 * difference(1.0) - 9.0 * difference(2.0) + difference(3.0)) / (60.0 * step);
  }
  Spring f{};
  spring_field(y, f, 0.0);
  const Spring image = bumped(f);  // the jump is linear
  const double a = rate(f);
  const Eigen::Vector3d flow(f[0], f[1], f[2]);
  const Eigen::Vector3d beta = Eigen::Vector3d(image[0], image[1], image[2]) - flow * (rate(image) / a);
  const auto seen = [](const Eigen::Vector3d& v) { return -height({v(0), v(1), v(2)}); };
  return {y, -height(y), a, seen(A * beta), seen(A * A * beta), A.trace()};  // A has rank one: rest has two states
}

/// The number behind `name` in the text.
double number_after(const std::string& text, const std::string& name) {
  const std::size_t at = text.find(name);
  INFO(name << " in\n" << text);
  REQUIRE(at != std::string::npos);
  return std::stod(text.substr(at + name.size()));
}

/// The numbers of the line that begins with `name`.
std::vector<double> row(const std::string& text, const std::string& name) {
  const std::size_t at = text.find("\n" + name);
  INFO(name << " in\n" << text);
  REQUIRE(at != std::string::npos);
  std::istringstream words(text.substr(at + 1 + name.size(), text.find('\n', at + 1) - at - 1 - name.size()));
  std::vector<double> result;
  for (double value = 0.0; words >> value;) result.push_back(value);
  return result;
}

/// q.contact, its GR1 the contact in the spring.
void run_to_contact(const Workspace& workspace) {
  workspace.write("catcher.tch", catcher);
  workspace.succeed("simulate catcher -q --dat start");
  workspace.succeed("run catcher -q -c start -d start -o contact ICP=[B] RL0=0.3 DS=-0.02 NTST=20 EPSS=1e-11");
}

/// The columns of a sweep by two names.
std::vector<std::pair<double, double>> columns_of(const std::string& sweep, const std::string& first,
                                                  const std::string& second) {
  std::istringstream lines(sweep);
  std::vector<std::pair<double, double>> result;
  std::vector<std::string> names;
  for (std::string line; std::getline(lines, line);) {
    const std::vector<std::string> words = words_of(line);
    if (words.empty() || words.front() == "#") continue;
    if (names.empty()) {
      names = words;
      continue;
    }
    const auto value = [&](const std::string& name) {
      const auto at = std::find(names.begin(), names.end(), name);
      REQUIRE(at != names.end());
      return std::stod(words.at(static_cast<std::size_t>(at - names.begin())));
    };
    result.emplace_back(value(first), value(second));
  }
  return result;
}

// ---- a forced oscillator beside a spring whose force lags: contact leads to one state more ------------------------

constexpr const char* stop = R"(par A=0.1, omega=0.8, k=15, c=0.1
init s=0, u=1
field touching: x' = v, v' = -x - c*v + A*u - k*(x-1) - lag, s' = s*(1-s^2-u^2) + omega*u, \
                u' = u*(1-s^2-u^2) - omega*s, lag' = 2*v - 3*lag
mode free: states x, v, s, u
field free: x' = v, v' = -x - c*v + A*u, s' = s*(1-s^2-u^2) + omega*u, u' = u*(1-s^2-u^2) - omega*s
event touch = 1 - x
event release = x - 1
event crest = v
jump in: lag -> 0
jump out to free:
jump pass to free:
after in: touching until release -> out
after any: free until touch -> in, crest -> pass
after start: free until touch -> in, crest -> pass
)";

}  // namespace

TEST_CASE("a contact in a mode of 3 states: contact, return map and xi as integration of the modes has them") {
  const Workspace workspace;
  run_to_contact(workspace);
  const Grazing exact = exact_grazing();
  CHECK(workspace.solutions("contact").back().parameter(5) == Approx(exact.B).epsilon(1e-10));
  const std::string text = workspace.succeed("grazing q.contact GR1 -p catcher").out;
  const std::vector<double> contact = row(text, "x* ");
  REQUIRE(contact.size() == 3);
  for (std::size_t a = 0; a < 3; ++a) CHECK(contact[a] == Approx(exact.contact[a]).epsilon(1e-9));
  CHECK(row(text, "h_D,x ") == std::vector<double>{1.0, 0.0, 0.3});
  CHECK(number_after(text, "\na* = ") == Approx(exact.a).epsilon(1e-9));
  CHECK(number_after(text, "Eigenvalues: ") == Approx(exact.eigenvalue).epsilon(1e-8));
  CHECK(text.find(", 0, 0\n") != std::string::npos);
  CHECK(number_after(text, "xi_1 ") == Approx(exact.xi_1).epsilon(1e-7));
  CHECK(number_after(text, "xi_2 ") == Approx(exact.xi_2).epsilon(1e-7));
  // Also on the grazing curve, where the collocation of the whole orbit has them.
  workspace.succeed("resegment q.contact GR1 -q -p catcher --to grazing-curve -o curve ICP=[B,V] NMX=4");
  workspace.succeed("run catcher -q -c curve -s curve -o curve");
  CHECK(number_after(workspace.read("d.curve"), "xi_1:") == Approx(exact.xi_1).epsilon(1e-7));
  workspace.succeed("verify curve -p catcher");
}

TEST_CASE("a verdict in a mode of 3 states, and the motion beyond grazing") {
  const Workspace workspace;
  run_to_contact(workspace);
  const std::string text = workspace.succeed("grazing q.contact GR1 -p catcher").out;
  CHECK(text.find("Verdict: continuous") != std::string::npos);
  // The attractor shrinks to the contact as the wall moves back to it.
  const Grazing exact = exact_grazing();
  const auto extent = [&](double distance) {
    Spring u = caught(to_lowest(exact.contact));
    double largest = 0.0;
    for (int turn = 0; turn < 120; ++turn) {
      u = impacting_turn(u, exact.B - distance);
      if (turn < 60) continue;
      const Spring y = to_section(u);
      for (std::size_t a = 0; a < 3; ++a) largest = std::max(largest, std::abs(y[a] - exact.contact[a]));
    }
    return largest;
  };
  const double far = extent(1e-3), near = extent(1e-5);
  CHECK(far < 0.01);
  CHECK(near < 0.1 * far);
}

TEST_CASE("the composite map of a contact in a mode of 3 states follows the impacting motion") {
  const Workspace workspace;
  run_to_contact(workspace);
  const double B = exact_grazing().B;
  workspace.succeed(
      "sweep catcher -q --map q.contact:GR1 --order exact --smooth-order 2 --over B=0.61:0.626:5 --follow down -o map");
  const auto rows = columns_of(workspace.read("map.sweep"), "B", "penetration");
  REQUIRE(rows.size() == 5);
  for (const auto& [wall, penetration] : rows) {
    Spring u{0.0, -1.165, 0.34};
    for (int turn = 0; turn < 200; ++turn) u = impacting_turn(u, wall);
    CAPTURE(wall, penetration);
    // The states of the second order in B* - B that the expansion leaves out.
    CHECK(std::abs(penetration + height(to_section(u)) + wall) < 0.05 * (B - wall) * (B - wall));
  }
}

TEST_CASE("contacts that jumps of another mode cannot follow") {
  const Workspace workspace;
  const std::string text = catcher;
  workspace.write("catcher.tch", text.substr(0, text.find("after")));
  const std::string state = "grazing catcher --state -0.46,-0.26,-0.54,7,7 --correct PAR(B)=0.6269 --mode ";
  const Outcome refused = workspace.tchat(state + "2,4,2");
  INFO(refused.text());
  CHECK(refused.status == 2);
  CHECK(refused.err.find("jump 2 (stop) sets 2 states, and field 2 (spring) after it has 3") != std::string::npos);
  // States that the mode has not are left alone, though the event function would see them.
  const std::string mended = workspace.succeed(state + "2,4,4").out;
  CHECK(row(mended, "x* ").size() == 3);
}

TEST_CASE("a contact segment with a state that the mode before has not") {
  const Workspace workspace;
  workspace.write("stop.tch", stop);
  const std::string start = workspace.succeed("simulate stop --dat start").out;
  CHECK(start.find("{(2,3,3)}") != std::string::npos);
  CHECK(workspace.read("gc.start").find("GCSEGTYP = [0]") != std::string::npos);  // `pass` is the identity there
  workspace.succeed("run stop -q -c start -d start -o up ICP=[A] RL1=2 DS=0.02 NTST=20");
  const double omega = 0.8, damping = 0.1;
  CHECK(workspace.solutions("up").back().parameter(1) ==
        Approx(std::hypot(1.0 - omega * omega, damping * omega)).epsilon(1e-9));  // the amplitude is 1
  workspace.succeed("resegment q.up GR1 -q -p stop --to impacting -o born");
  workspace.succeed("run stop -q -c born -s born -o touching NMX=20 NPR=5");
  workspace.succeed("verify touching -p stop");
  for (const SolutionEntry& label : workspace.solutions("touching")) {
    const std::vector<double>& first = label.states.front();
    const double A = label.parameter(1);
    const auto oscillate = [=](const auto& u, auto& f, double force) {
      const double radial = 1.0 - u[2] * u[2] - u[3] * u[3];
      f[0] = u[1];
      f[1] = -u[0] - damping * u[1] + A * u[3] + force;
      f[2] = u[2] * radial + omega * u[3];
      f[3] = u[3] * radial - omega * u[2];
    };
    std::array<double, 4> x{first[0], first[1], first[2], first[3]};
    const double flight = integrate_to(
        x, [&](const auto& u, auto& f, double) { oscillate(u, f, 0.0); }, [](const auto& u) { return 1.0 - u[0]; });
    std::array<double, 5> y{x[0], x[1], x[2], x[3], 0.0};
    const double contact = integrate_to(
        y,
        [&](const auto& u, auto& f, double) {
          oscillate(u, f, -15.0 * (u[0] - 1.0) - u[4]);
          f[4] = 2.0 * u[1] - 3.0 * u[4];
        },
        [](const auto& u) { return u[0] - 1.0; });
    CAPTURE(label.label, A);
    CHECK(label.parameter(61) == Approx(flight).epsilon(1e-7));
    CHECK(label.parameter(62) == Approx(contact).epsilon(1e-7));
    for (std::size_t a = 0; a < 4; ++a) CHECK(y[a] == Approx(first[a]).margin(1e-7));
  }
}
