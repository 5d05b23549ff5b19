// The rocking block, as problems/rocking_block/Makefile runs it, against closed forms.
//
// On the right corner x'' = x - 1 + beta cos(omega t): x = 1 + A exp(t) + B exp(-t) - b cos(omega t + phase) with
// b = beta / (1 + omega^2). With h = pi / omega, C = cosh h, S = sinh h, c = b cos(phase), s = b sin(phase), half of a
// symmetric orbit, x(0) = x(h) = 0 and x'(0) = -r x'(h), has
//
//     s = (1 + r) / (1 - r) coth(h/2) c / omega - tanh(h/2) / omega,   x'(0) = 2 r / (1 - r) coth(h/2) c
//
// and b^2 = c^2 + s^2: two orbits, which meet in a fold where b is least. The map of half an orbit, in the mirror, has
// the determinant r^2 and the trace -2 r C - r S (a_0 + r a_h) / x'(0) with the accelerations a_0 = -1 + (1 + omega^2)
// c and a_h = -1 - (1 + omega^2) c at its ends; the orbit loses its symmetry where it has the multiplier -1.
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>

#include "published/makefile_run.hpp"
#include "published/newton.hpp"

using namespace test_support;

namespace {

constexpr double pi = 3.14159265358979323846, r = 0.925;

/// sqrt(c^2 + s^2) with s = p + q c, as beta
double beta_of(double c, double omega) {
  const double half = 0.5 * pi / omega, s = ((1.0 + r) / (1.0 - r) * c / std::tanh(half) - std::tanh(half)) / omega;
  return (1.0 + omega * omega) * std::hypot(c, s);
}

double fold(double omega) {
  const double half = 0.5 * pi / omega, p = -std::tanh(half) / omega,
               q = (1.0 + r) / (1.0 - r) / std::tanh(half) / omega;
  return beta_of(-p * q / (1.0 + q * q), omega);
}

double symmetry_breaking(double omega) {
  const double h = pi / omega, C = std::cosh(h), S = std::sinh(h);
  const double velocity = 2.0 * r / (1.0 - r) / std::tanh(0.5 * h);  // of c
  const double c =
      r * S * (1.0 + r) / (r * S * (1.0 - r) * (1.0 + omega * omega) - (1.0 + r * r - 2.0 * r * C) * velocity);
  return beta_of(c, omega);
}

/// The motion from an impact at time t to the next one, and its derivative by time and velocity of the impact.
struct Rocking {
  double miss, velocity;  ///< x at the given end, velocity after an impact there
  Eigen::Matrix2d map;
};

Rocking rocking(double corner, double from, double velocity, double to, double beta, double omega) {
  const auto forced = [&](double t) { return Eigen::Vector2d(-std::cos(omega * t), omega * std::sin(omega * t)); };
  const double b = beta / (1.0 + omega * omega), T = to - from;
  Eigen::Matrix2d flow;
  flow << std::cosh(T), std::sinh(T), std::sinh(T), std::cosh(T);
  const Eigen::Vector2d rest(corner, 0.0), start(0.0, velocity);
  const Eigen::Vector2d end = rest + b * forced(to) + flow * (start - rest - b * forced(from));
  const double first = -corner + beta * std::cos(omega * from), last = end(0) - corner + beta * std::cos(omega * to);
  Eigen::Matrix2d begin, impact;
  begin << -velocity, 0.0, -first, 1.0;  // of x and x' at the fixed time `from`
  impact << -1.0 / end(1), 0.0, -r * last / end(1), r;
  return {end(0), r * end(1), impact * flow * begin};
}

/// beta at which an orbit with n impacts in n / 2 periods has the multiplier `critical`, by Newton's method from near
/// it; unknown are times and velocities after impacts, and beta.
double critical_beta(const Eigen::VectorXd& times, const Eigen::VectorXd& velocities, double beta, double critical) {
  const double omega = 2.0;
  const Eigen::Index n = times.size();
  Eigen::VectorXd z(2 * n + 1);
  z << times, velocities, beta;
  const auto defect = [&](const Eigen::VectorXd& at) {
    Eigen::VectorXd values(2 * n + 1);
    Eigen::Matrix2d map = Eigen::Matrix2d::Identity();
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Index next = (k + 1) % n;
      const double end = at(next) + (next == 0 ? static_cast<double>(n) * pi / omega : 0.0);
      const Rocking piece = rocking(k % 2 == 0 ? 1.0 : -1.0, at(k), at(n + k), end, at(2 * n), omega);
      values(k) = piece.miss;
      values(n + k) = piece.velocity - at(n + next);
      map = piece.map * map;
    }
    values(2 * n) = (map - critical * Eigen::Matrix2d::Identity()).determinant();
    return values;
  };
  z = newton(z, 1e-9, defect);
  return z(2 * n);
}

/// The only period doubling of a branch against linear pieces, from an orbit rounded to four digits.
void check_doubling(const MakefileRun& chain, const std::string& name) {
  INFO(name);
  const SolutionEntry orbit = chain.only(name, "PD");
  const auto rounded = [](double value) { return std::round(value * 1e4) / 1e4; };
  const auto& start = orbit.states.front();
  const auto n = static_cast<Eigen::Index>(start.size() / 4);
  Eigen::VectorXd times(n), velocities(n);
  double time = std::atan2(start[2], start[3]) / orbit.parameter(2);
  for (Eigen::Index k = 0; k < n; ++k) {
    times(k) = rounded(time);
    velocities(k) = rounded(start[static_cast<std::size_t>(4 * k + 1)]);
    time += orbit.parameter(61 + static_cast<int>(k));
  }
  const double beta = orbit.parameter(1);
  check_near(beta, critical_beta(times, velocities, rounded(beta), -1.0), 1e-8);
}

template <class Closed>
void check_curve(const MakefileRun& chain, const std::string& name, Closed closed) {
  INFO(name);
  int seen = 0;
  for (const PointSection& section : chain.points(name))
    for (const PointRow& row : section.rows) {
      const double beta = closed(row.values[section.column("omega")]);
      check_near(row.values[section.column("beta")], beta, 1e-8 * beta);
      ++seen;
    }
  CHECK(seen > 20);
}

}  // namespace

TEST_CASE("make -j2 in problems/rocking_block: fold and loss of symmetry in closed form, doublings by linear pieces") {
  const MakefileRun chain("rocking_block", "branches");
  chain.check_verified();

  // Half of the orbit in the mirror doubles its period where the whole one has a branch point.
  for (const char* name : {"symmetric", "half"}) {
    check_near(chain.only(name, "LP").parameter(1), fold(2.0));
    CHECK(first_iterations(chain.read(std::string("d.") + name)) <= 3);
  }
  check_near(chain.only("symmetric", "BP").parameter(1), symmetry_breaking(2.0));
  check_near(chain.only("half", "PD").parameter(1), symmetry_breaking(2.0));
  check_curve(chain, "fold_curve", fold);
  check_curve(chain, "symmetry_breaking_curve", symmetry_breaking);

  for (const char* name : {"asymmetric", "mirrored", "doubled", "fourfold"}) check_doubling(chain, name);
  check_near(chain.only("asymmetric", "PD").parameter(1), chain.only("mirrored", "PD").parameter(1));

  // An asymmetric orbit ends as x = 1 - b cos(omega t) of one side alone, which touches x = 0 at b = 1.
  for (const char* name : {"asymmetric", "mirrored"}) check_near(chain.only(name, "BP").parameter(1), 5.0);
}
