// A mass on a belt with friction that falls with the sliding velocity, then rises: the smooth cycle from its Hopf
// bifurcation to the contact with the belt's velocity, and the stick-slip motion beyond, with no constants by hand.
// Model and first approximations: J. J. Thomsen, A. Fidlin, Analytical approximations for stick-slip vibration
// amplitudes, Int. J. Non-Linear Mechanics 38 (2003) 389-403: the cycle is born at V_H = sqrt((mu1 - 2 zeta) / (3
// mu3)), and for weak friction it touches at sqrt(4/5) V_H. Else the references are motions integrated by a method of
// order 8.
#include <fmt/format.h>

#include <boost/math/tools/toms748_solve.hpp>
#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/workspace.hpp"
#include "published/smooth_motion.hpp"

using namespace test_support;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

struct Belt {
  double strength = 1.0;  ///< of friction and damping
  double zeta() const { return 0.05 * strength; }
  double mu0() const { return 0.4 * strength; }
  double mu1() const { return 0.3 * strength; }
  double mu3() const { return 0.1 * strength; }
  double hopf() const { return std::sqrt((mu1() - 2.0 * zeta()) / (3.0 * mu3())); }

  double acceleration(const MotionState<2>& x, double V) const {
    const double w = V - x[1];
    return -2.0 * zeta() * x[1] - x[0] + mu0() - mu1() * w + mu3() * w * w * w;
  }
  /// Where stick ends, and where a cycle in contact is at its largest velocity.
  MotionState<2> release(double V) const { return {mu0() - 2.0 * zeta() * V, V}; }

  template <class Event>
  auto slip(double V, Event event) const {
    const auto field = [*this, V](const MotionState<2>& x, MotionState<2>& f, double) {
      f = {x[1], acceleration(x, V)};
    };
    return SmoothMotion<2, decltype(field), Event>(field, event, release(V), 0.01);
  }

  /// The belt's velocity at which the cycle touches it: a turn from the contact has the same largest velocity.
  double contact() const {
    const auto excess = [this](double V) {
      auto motion = slip(V, [this, V](const MotionState<2>& x, double) { return acceleration(x, V); });
      return motion.next_fall()[1] - V;
    };
    std::uintmax_t iterations = 60;
    const auto root = boost::math::tools::toms748_solve(excess, 0.85 * hopf(), 0.95 * hopf(),
                                                        boost::math::tools::eps_tolerance<double>(48), iterations);
    return 0.5 * (root.first + root.second);
  }

  std::string formulas() const {
    return fmt::format(R"(par V=1.2, zeta={}, mu0={}, mu1={}, mu3={}
init x=0.4, v=0
w = V - v
field slip:     x' = v, v' = -2*zeta*v - x + mu0 - mu1*w + mu3*w^3
field overtake: x' = v, v' = -2*zeta*v - x - mu0 - mu1*w + mu3*w^3
event catch = V - v
event lag = v - V
slide stick on catch: faster -> overtake, slower -> slip
after any if stick:    stick until faster -> identity, slower -> identity
after any if overtake: overtake until lag -> identity
after any:             slip until catch -> identity
)",
                       zeta(), mu0(), mu1(), mu3());
  }
};

/// The equilibrium from a simulation, its Hopf bifurcation, the cycle to contact: q.cycle, whose GR is the last label.
void follow_cycle(const Workspace& workspace, const Belt& belt) {
  workspace.write("belt.tch", belt.formulas());
  workspace.succeed("simulate belt -q --dat rest");
  workspace.succeed("run belt -q -c rest -d rest -o rest DS=-0.02 RL0=0.3 RL1=2");
  workspace.succeed("run belt -q -c r.rest -s rest IRS=HB1 IPS=180 ISW=-1 GCHIND=[0] GCGIND=[0] -o cycle");
}

}  // namespace

TEST_CASE("the cycle of a mass on a belt touches the belt's velocity, and sticks beyond") {
  const Workspace workspace;
  const Belt belt;
  follow_cycle(workspace, belt);
  const SolutionEntry touching = workspace.solutions("cycle").back();
  CHECK(touching.internal.at(0) == 2.0);  // a contact
  // EPSS is 1e-9; the mesh's error is 1e-9, the reference's 1e-12.
  CHECK(touching.parameter(1) == Approx(belt.contact()).epsilon(1e-8));

  SECTION("the stick-slip motion") {
    const Outcome made = workspace.succeed("resegment q.cycle GR1 --to impacting -o stick -p belt UZR={-1:0.5}");
    CHECK(contains(made.out, "{(1,1,1), (3,4,1)}"));
    workspace.succeed("run belt -q -c stick -s stick -o stick_slip");
    const SolutionEntry at = workspace.solutions("stick_slip").back();
    constexpr double V = 0.5;
    REQUIRE(at.parameter(1) == Approx(V).epsilon(1e-9));
    auto motion = belt.slip(V, [](const MotionState<2>& x, double) { return V - x[1]; });
    const MotionState<2> caught = motion.next_fall();
    CHECK(at.parameter(61) == Approx(motion.time_of_fall()).epsilon(1e-8));
    CHECK(at.parameter(62) == Approx((belt.release(V)[0] - caught[0]) / V).epsilon(1e-8));
    workspace.succeed("verify stick_slip -p belt");
  }
  SECTION("the curve of contacts in two parameters") {
    workspace.succeed(
        "resegment q.cycle GR1 --to grazing-curve -o on -p belt -q ICP=[mu1,V,61] UZR={-mu1:0.35} RL0=0 RL1=1");
    workspace.succeed("run belt -q -c on -s on -o curve");
    const SolutionEntry at = workspace.solutions("curve").back();
    // mu1 alone differs: the same motion with friction of another slope.
    const double V = at.parameter(1), mu1 = at.parameter(4);
    REQUIRE(mu1 == Approx(0.35).epsilon(1e-9));
    const auto acceleration = [&](const MotionState<2>& x) {
      const double w = V - x[1];
      return -2.0 * belt.zeta() * x[1] - x[0] + belt.mu0() - mu1 * w + belt.mu3() * w * w * w;
    };
    const auto field = [&](const MotionState<2>& x, MotionState<2>& f, double) { f = {x[1], acceleration(x)}; };
    const auto event = [&](const MotionState<2>& x, double) { return acceleration(x); };
    SmoothMotion<2, decltype(field), decltype(event)> motion(field, event, belt.release(V), 0.01);
    CHECK(motion.next_fall()[1] == Approx(V).epsilon(1e-8));
  }
  SECTION("no impact, no discontinuity map") {
    const Outcome refused = workspace.tchat("grazing q.cycle GR1 -p belt");
    CHECK(refused.status == 2);
    CHECK(contains(refused.err, "the identity"));
  }
}

TEST_CASE("for weak friction the cycle touches at sqrt(4/5) of where it is born") {
  const auto deviation = [](double strength) {
    const Workspace workspace;
    const Belt belt{strength};
    follow_cycle(workspace, belt);
    return workspace.solutions("cycle").back().parameter(1) / belt.hopf() - std::sqrt(0.8);
  };
  // Averaging leaves terms of second order in the strength: half of it leaves a quarter.
  const double full = deviation(1.0), half = deviation(0.5);
  CHECK(std::abs(full) < 2e-3);
  CHECK(full / half == Approx(4.0).epsilon(0.1));
}
