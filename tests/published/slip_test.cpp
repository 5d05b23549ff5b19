// The spring-loaded inverted pendulum, as problems/slip/Makefile runs it. The references are closed forms of bouncing
// and hopping in place, and motions in polar coordinates about the foot, integrated by a method of order 8: hopping in
// place with small sideways motions, whose map of one stride gives branch points, the period doubling and multipliers,
// and gaits that are symmetric in time, found by shooting from the shortest leg to the apex of the flight.
#include <Eigen/Dense>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <catch2/catch.hpp>
#include <cmath>

#include "published/makefile_run.hpp"
#include "published/newton.hpp"
#include "published/smooth_motion.hpp"

using namespace test_support;

namespace {

constexpr double pi = 3.14159265358979323846, k = 40.0, w2 = 5.0;
const double w = std::sqrt(w2), stiff = std::sqrt(k);

template <class Function>
double root(const Function& f, double from, double to) {
  std::uintmax_t iterations = 60;
  const auto at =
      boost::math::tools::toms748_solve(f, from, to, boost::math::tools::eps_tolerance<double>(50), iterations);
  return 0.5 * (at.first + at.second);
}

/// Hopping in place that lifts off with the velocity v.
struct Hopping {
  double v;

  double amplitude() const { return std::sqrt(1.0 / (k * k) + v * v / k); }
  /// From the shortest leg to lift-off.
  double half_stance() const { return std::acos(-1.0 / (k * amplitude())) / stiff; }
  double energy() const { return 1.0 + 0.5 * v * v; }
  double period() const { return 2.0 * v + 2.0 * half_stance(); }

  /// Small (alpha, alpha'), from landing to lift-off: l alpha'' = alpha - 2 l' alpha', l a cosine.
  Eigen::Matrix2d stance() const {
    using State = std::array<double, 4>;
    const auto field = [this](const State& x, State& f, double t) {
      const double l = 1.0 - 1.0 / k - amplitude() * std::cos(stiff * t),
                   rate = amplitude() * stiff * std::sin(stiff * t);
      f = {x[2], x[3], (x[0] - 2.0 * rate * x[2]) / l, (x[1] - 2.0 * rate * x[3]) / l};
    };
    boost::numeric::odeint::runge_kutta_fehlberg78<State> method;
    constexpr int steps = 200;
    const double step = 2.0 * half_stance() / steps;
    State x{1.0, 0.0, 0.0, 1.0};
    for (int i = 0; i < steps; ++i) method.do_step(field, x, -half_stance() + i * step, step);
    return (Eigen::Matrix2d() << x[0], x[1], x[2], x[3]).finished();
  }
  /// From lift-off to the state after landing.
  Eigen::Matrix2d flight() const {
    const double c = std::cos(2.0 * w * v), s = std::sin(2.0 * w * v) / w;
    return (Eigen::Matrix2d() << c, s, v + v * c, 1.0 + v * s).finished();
  }
  Eigen::Matrix2d stride() const { return flight() * stance(); }
};

/// The velocity at which a multiplier of small sideways motions is `value`.
double velocity_of_multiplier(double value, double from, double to) {
  const auto determinant = [&](double v) {
    return (Hopping{v}.stride() - value * Eigen::Matrix2d::Identity()).determinant();
  };
  return root(determinant, from, to);
}

/// (alpha, l, alpha', l', integral of l'^2) about the foot.
using Leg = MotionState<5>;

struct Runner {
  double damping = 0.0, push = 0.0;

  auto stance(const Leg& start, bool pushes) const {
    const auto field = [*this, pushes](const Leg& x, Leg& f, double) {
      const double force = k * (1.0 - x[1]) - damping * x[3] + (pushes ? push : 0.0);
      f = {x[2], x[3], (std::sin(x[0]) - 2.0 * x[2] * x[3]) / x[1], x[1] * x[2] * x[2] - std::cos(x[0]) + force,
           x[3] * x[3]};
    };
    const auto event = [pushes](const Leg& x, double) { return pushes ? 1.0 - x[1] : -x[3]; };
    return SmoothMotion<5, decltype(field), decltype(event)>(field, event, start, 0.005);
  }
};

struct Stride {
  Leg lift_off, landed, end;
  std::array<double, 3> durations;
};

/// (vx, vy) of the hip.
Eigen::Vector2d velocity(const Leg& x) {
  const double c = std::cos(x[0]), s = std::sin(x[0]);
  return {-x[1] * x[2] * c - x[3] * s, x[3] * c - x[1] * x[2] * s};
}

/// From the shortest leg to the next time.
Stride stride(const Runner& runner, const Leg& start) {
  Stride result;
  auto push = runner.stance(start, true);
  const Leg off = result.lift_off = push.next_fall();
  const Eigen::Vector2d v = velocity(off);
  const auto angle = [&](double t) { return off[0] * std::cos(w * t) + off[2] / w * std::sin(w * t); };
  const auto height = [&](double t) { return off[1] * std::cos(off[0]) + t * (v(1) - 0.5 * t) - std::cos(angle(t)); };
  double last = v(1);  // the apex
  while (height(last) > 0.0) last += 0.01;
  const double t = root(height, last - 0.01, last);
  const double alpha = angle(t), vy = v(1) - t;
  result.landed = {alpha, 1.0, -(v(0) * std::cos(alpha) + vy * std::sin(alpha)),
                   vy * std::cos(alpha) - v(0) * std::sin(alpha), 0.0};
  auto compression = runner.stance(result.landed, false);
  result.end = compression.next_fall();
  result.durations = {push.time_of_fall(), t, compression.time_of_fall()};
  return result;
}

/// The start of segment `s` (from 0) of a labelled orbit.
const double* start_of(const SolutionEntry& orbit, int s) { return orbit.states.front().data() + 5 * s; }

Leg leg_of(const double* x) {
  const double c = std::cos(x[0]), s = std::sin(x[0]), length = x[1] / c;
  return {x[0], length, -(x[2] * c + x[3] * s) / length, x[3] * c - x[2] * s, 0.0};
}

double distance(const Leg& a, const Leg& b) {
  return std::hypot(std::hypot(a[0] - b[0], a[1] - b[1]), std::hypot(a[2] - b[2], a[3] - b[3]));
}

/// The orbit is one of an independent integration. It grows errors tenfold at most, and tchat's are 1e-11.
void check_stride(const SolutionEntry& orbit, const Runner& runner = {}) {
  const Leg start = leg_of(start_of(orbit, 0));
  const Stride next = stride(runner, start);
  CHECK(distance(next.end, start) < 1e-9);
  CHECK(distance(next.landed, leg_of(start_of(orbit, 2))) < 1e-9);
  for (int s = 0; s < 3; ++s) check_near(orbit.parameter(61 + s), next.durations[static_cast<std::size_t>(s)]);
}

/// The shortest leg and its turning rate, at which alpha = 0, of a symmetric gait that satisfies two conditions.
template <class Conditions>
Leg symmetric_gait(const SolutionEntry& near, const Conditions& conditions) {
  const auto rounded = [](double value) { return std::round(value * 1e3) / 1e3; };
  const Leg found = leg_of(start_of(near, 0));
  const Eigen::VectorXd z =
      newton(Eigen::Vector2d(rounded(found[1]), rounded(found[2])), 1e-11, [&](const Eigen::VectorXd& unknown) {
        const Leg start{0.0, unknown(0), unknown(1), 0.0, 0.0};
        auto push = Runner{}.stance(start, true);
        return Eigen::VectorXd(conditions(start, push.next_fall()));
      });
  return {0.0, z(0), z(1), 0.0, 0.0};
}

double energy(const Leg& x) {
  return x[1] * std::cos(x[0]) + 0.5 * velocity(x).squaredNorm() + 0.5 * k * (1.0 - x[1]) * (1.0 - x[1]);
}

/// Zero where the leg is upright at the apex of the flight, which makes the flight symmetric.
double angle_at_apex(const Leg& off) {
  const double t = velocity(off)(1);
  return off[0] * std::cos(w * t) + off[2] / w * std::sin(w * t);
}

/// Zero where the flight lasts half a swing, which makes it symmetric but for the sign of omega.
double beyond_half_swing(const Leg& off) { return 2.0 * velocity(off)(1) - pi / w; }

std::vector<PointRow> rows(const MakefileRun& chain, const std::string& name) {
  std::vector<PointRow> all;
  for (const PointSection& section : chain.points(name))
    all.insert(all.end(), section.rows.begin(), section.rows.end());
  REQUIRE(all.size() > 3);
  return all;
}

}  // namespace

TEST_CASE("make -j2 in problems/slip: bouncing and hopping in place in closed form") {
  const MakefileRun chain("slip", "branches");
  chain.check_verified();
  chain.check_repeatable(MakefileRun::Chain::is_long);

  const SolutionEntry rest = chain.solutions("rest").front();
  check_near(rest.states.front()[1], 1.0 - 1.0 / k, 1e-12);
  const PointSection bounce = chain.points("bounce").front();
  for (const PointRow& row : bounce.rows) check_near(row.values[bounce.column("period")], 2.0 * pi / stiff);
  const SolutionEntry first = chain.only("bounce", "GR");
  check_near(start_of(first, 0)[1], 1.0 - 2.0 / k);
  check_near(bounce.rows.back().values[bounce.column("energy")], 1.0);

  const PointSection hop = chain.points("hop").front();
  REQUIRE(hop.rows.size() > 30);
  for (const PointRow& row : hop.rows) {
    const double period = row.values[hop.column("period")];
    // The period rises with v. The eleven digits in the file suffice for 1e-9 even at the first hops.
    const double v = period <= Hopping{1e-9}.period()
                         ? 0.0
                         : root([&](double at) { return Hopping{at}.period() - period; }, 1e-9, 4.0);
    check_near(row.values[hop.column("energy")], Hopping{v}.energy());
    check_near(row.values[hop.column("mean(vx)")], 0.0);
  }
  // No point of any branch has a flight below the ground, or lifts off early.
  for (const char* name : {"hop", "swing", "swing_back", "run", "run_back", "driven"})
    CHECK(chain.read("d." + std::string(name)).find("inadmissible") == std::string::npos);
}

TEST_CASE("slip: gaits branch off where a stride maps small sideways motions to themselves") {
  const MakefileRun chain("slip", "branches");
  const PointSection hop = chain.points("hop").front();
  const auto energy_at = [&](const std::string& type, std::size_t n) {
    const int label = chain.point("hop", type, n).label;
    for (const PointRow& row : hop.rows)
      if (row.label == label) return row.values[hop.column("energy")];
    return 0.0;
  };
  // Half a swing reverses alpha and keeps alpha': the flight and the reversed stance are inverse to each other, so that
  // the square of the map is the identity, and its multipliers are 1 and -1.
  const double half_swing = 0.5 * pi / w;
  check_near(energy_at("BP", 1), 1.0 + pi * pi / (8.0 * w2));
  CHECK((Hopping{half_swing}.stride() * Hopping{half_swing}.stride() - Eigen::Matrix2d::Identity()).norm() < 1e-11);
  check_near(energy_at("BP", 2), Hopping{velocity_of_multiplier(1.0, 1.0, 1.3)}.energy());
  check_near(energy_at("PD", 1), Hopping{velocity_of_multiplier(-1.0, 0.72, 0.9)}.energy());

  // The multipliers: 1 of the family, two of the map, 0 of the section and 0 of landing, which forgets omega.
  for (const char* type : {"PD", "EP"}) {
    const DiagnosticPoint point = chain.point("hop", type);
    const SolutionEntry orbit = with_label(chain.solutions("hop"), point.label);
    const Eigen::Vector2cd own = Hopping{0.5 * orbit.parameter(62)}.stride().eigenvalues();
    for (const auto& value : {own(0), own(1), std::complex<double>(1.0)})
      CHECK(distance_to(point.multipliers, value) < 1e-8 * (1.0 + std::abs(value)));
    int zeros = 0;
    for (const auto& value : point.multipliers) zeros += std::abs(value) < 1e-8;
    CHECK(zeros == 2);
  }
}

TEST_CASE("slip: running and swinging gaits are motions that are symmetric in time") {
  const MakefileRun chain("slip", "branches");
  for (const std::string name : {"run", "swing"}) {
    INFO(name);
    for (const std::size_t n : {1, 2}) {
      const SolutionEntry orbit = chain.solution(name, "UZ", n);
      const double wanted = n == 1 ? 1.8 : 3.0;
      const Leg start = symmetric_gait(orbit, [&](const Leg& from, const Leg& off) {
        return Eigen::Vector2d(energy(from) - wanted, name == "run" ? angle_at_apex(off) : beyond_half_swing(off));
      });
      CHECK(distance(leg_of(start_of(orbit, 0)), start) < 1e-9);
      check_stride(orbit);
      // omega on touching the ground, and after landing: running loses nothing, swinging reverses it.
      const double* flight = start_of(orbit, 1);
      const double touch =
          -w * flight[0] * std::sin(w * orbit.parameter(62)) + flight[4] * std::cos(w * orbit.parameter(62));
      check_near(start_of(orbit, 2)[4], name == "run" ? touch : -touch);
      CHECK(chain.point(name, "UZ", n).point * (name == "run" && n == 1 ? -1 : 1) > 0);  // negative: stable

      // The mirror image.
      const SolutionEntry back = chain.solution(name + "_back", "UZ", n);
      for (int s = 0; s < 3; ++s) {
        check_near(back.parameter(61 + s), orbit.parameter(61 + s));
        for (int i = 0; i < 5; ++i)
          check_near(start_of(back, s)[i], (i == 1 || i == 3 ? 1.0 : -1.0) * start_of(orbit, s)[i]);
      }
    }
  }
  // All swinging gaits fly for half a swing.
  for (const SolutionEntry& orbit : chain.solutions("swing")) check_near(orbit.parameter(62), pi / w);

  // They end where the foot touches the ground without crossing it.
  const SolutionEntry contact = chain.only("swing", "GR");
  const Leg last = symmetric_gait(contact, [](const Leg&, const Leg& off) {
    return Eigen::Vector2d(beyond_half_swing(off), -velocity(off)(1) + std::sin(-off[0]) * -off[2]);
  });
  CHECK(distance(leg_of(start_of(contact, 0)), last) < 1e-9);
}

TEST_CASE("slip: beside the runner that conserves energy a damped one is driven, and attracts") {
  const MakefileRun chain("slip", "branches");
  const SolutionEntry orbit = chain.only("driven", "UZ");
  const double damping = orbit.parameter(3), push = orbit.parameter(4);
  check_near(damping, 0.2);
  const Runner runner{damping, push};
  check_stride(orbit, runner);
  const Leg start = leg_of(start_of(orbit, 0));
  check_near(energy(start), 1.8);

  // Disturbed, it comes closer by the largest multiplier, 0.9757, each stride.
  Leg disturbed = start;
  disturbed[2] += 1e-3;
  constexpr int strides = 200;
  for (int i = 0; i < strides; ++i) disturbed = stride(runner, disturbed).end;
  CHECK(distance(disturbed, start) < 2e-3 * std::pow(0.9757, strides));

  // The first of d and f balance over the conservative orbit: d times the integral of l'^2 is f times the stroke.
  const SolutionEntry free_runner = chain.solution("run", "UZ", 1);
  const Leg lowest = leg_of(start_of(free_runner, 0));
  auto extension = Runner{}.stance(lowest, true);
  const double balance = 2.0 * extension.next_fall()[4] / (1.0 - lowest[1]);
  const std::vector<PointRow> branch = rows(chain, "driven");
  const PointSection section = chain.points("driven").front();
  const auto ratio = [&](std::size_t i) {
    return branch[i].values[section.column("f")] / branch[i].values[section.column("d")];
  };
  const double d1 = branch[1].values[section.column("d")], d2 = branch[2].values[section.column("d")];
  // To d = 0 along a line: d^2 = 1e-4 is left out.
  check_near((ratio(1) * d2 - ratio(2) * d1) / (d2 - d1), balance, 1e-4);
}

TEST_CASE("slip: what is conserved where, and the side of the first hop") {
  const MakefileRun chain("slip", "q.hop");
  const Outcome check = chain.tchat({"check", "slip", "-p", chain.plugin(), "-c", "r.hop"});
  INFO(check.text());
  CHECK(check.status == 0);
  CHECK(check.out.find("energy: conserved by field 2 (flight)") != std::string::npos);
  const Outcome damped = chain.tchat({"check", "slip", "-p", chain.plugin(), "-c", "r.hop", "PAR(d)=0.1"});
  CHECK(damped.status == 1);
  CHECK(damped.out.find("energy: NOT conserved by field 1 (stance)") != std::string::npos);

  const Outcome born =
      chain.tchat({"resegment", "q.bounce", "GR1", "--to", "impacting", "-p", chain.plugin(), "-o", "again"});
  INFO(born.text());
  CHECK(born.out.find("free: energy, period, T1, T2, T3") != std::string::npos);
  CHECK(born.out.find("leads to the side with the new event") != std::string::npos);
}
