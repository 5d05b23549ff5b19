// An oscillator beside an elastic stop, as problems/elastic_stop/Makefile runs it, against exact flows of its pieces.
//
// Each piece is q'' + 2 zeta q' + w2 q = k g + A cos(omega t) with w2 = 1, k = 0 (free) or w2 = 1 + k. The free orbit
// has the amplitude A / |1 - omega^2 + 2 i zeta omega|, which is the gap at grazing. The force is continuous, so the
// map of one period T is exp(J1 (T - c)) exp(J2 c) with the duration c of the contact: the trace t and determinant d of
// its 2 x 2 part say where a multiplier is -1 (1 + t + d = 0) or 1 (1 - t + d = 0).
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

#include "published/makefile_run.hpp"
#include "published/newton.hpp"

using namespace test_support;

namespace {

constexpr double pi = 3.14159265358979323846, damping = 0.05, stiffness = 4.0, gap = 1.0;

/// exp(J t) of a piece.
Eigen::Matrix2d flow(double w2, double t) {
  const double wd = std::sqrt(w2 - damping * damping), c = std::cos(wd * t), s = std::sin(wd * t) / wd;
  Eigen::Matrix2d result;
  result << c + damping * s, s, -w2 * s, c - damping * s;
  return std::exp(-damping * t) * result;
}

struct Piece {
  double k;  ///< of the spring, 0: free

  double w2() const { return 1.0 + k; }
  /// q and q' after the time `t`, from those at time `from`.
  Eigen::Vector2d after(const Eigen::Vector2d& start, double from, double t, double A, double omega) const {
    const std::complex<double> amplitude = A / std::complex<double>(w2() - omega * omega, 2.0 * damping * omega);
    const auto forced = [&](double time) {
      const std::complex<double> x = amplitude * std::polar(1.0, omega * time);
      return Eigen::Vector2d(x.real() + k * gap / w2(), -omega * x.imag());
    };
    return forced(from + t) + flow(w2(), t) * (start - forced(from));
  }
};

const Piece free_piece{0.0}, contact_piece{stiffness};

double grazing(double omega) {
  return gap * std::abs(std::complex<double>(1.0 - omega * omega, 2.0 * damping * omega));
}

Eigen::Matrix2d monodromy(double contact, double period) {
  return flow(1.0, period - contact) * flow(1.0 + stiffness, contact);
}

/// det(1 - M / critical)
double critical_determinant(double contact, double period, double critical) {
  return (Eigen::Matrix2d::Identity() - monodromy(contact, period) / critical).determinant();
}

/// A where an orbit with one contact in a period has the multiplier `critical`: unknown are time and velocity of the
/// touch, the duration of the contact, and A.
Eigen::VectorXd critical_orbit(const Eigen::Vector4d& near, double period, double critical, double omega) {
  return newton(near, 1e-11, [&](const Eigen::VectorXd& z) {
    const Eigen::Vector2d leave = contact_piece.after({gap, z(1)}, z(0), z(2), z(3), omega);
    const Eigen::Vector2d back = free_piece.after(leave, z(0) + z(2), period - z(2), z(3), omega);
    return Eigen::VectorXd(
        Eigen::Vector4d(leave(0) - gap, back(0) - gap, back(1) - z(1), critical_determinant(z(2), period, critical)));
  });
}

double rounded(double value) { return std::round(value * 1e3) / 1e3; }

/// Time and velocity of the first touch that begins segment s (from 0) of a contact, to three digits.
Eigen::Vector2d touch_of(const SolutionEntry& orbit, std::size_t s) {
  const std::vector<double>& start = orbit.states.front();
  return {rounded(std::atan2(start[4 * s + 2], start[4 * s + 3]) / orbit.parameter(2)), rounded(start[4 * s + 1])};
}

}  // namespace

TEST_CASE("make -j2 in problems/elastic_stop: grazing both ways in closed form, doubling and fold by linear pieces") {
  const MakefileRun chain("elastic_stop", "branches");
  chain.check_verified();
  const double omega = 2.5, period = 2.0 * pi / omega;

  // Into contact and back out of it: the same point, at which the contact lasts no time.
  check_near(chain.only("free", "GR").parameter(1), grazing(omega));
  const SolutionEntry lost = chain.only("back", "GR");
  check_near(lost.parameter(1), grazing(omega));
  check_near(lost.parameter(62), 0.0);
  check_near(lost.parameter(61), period);
  // The branch with contact begins there, and nothing of it is inadmissible.
  const std::vector<PointSection> contact = chain.points("contact");
  check_near(contact.front().rows.front().values[contact.front().column("A")], grazing(omega));
  CHECK(chain.read("d.contact").find("inadmissible") == std::string::npos);
  CHECK(chain.read("d.contact").find("changes sign by a jump") == std::string::npos);
  // At the point itself the multipliers are those of the free orbit, exp(-zeta T) cos and sin(wd T).
  for (const char* name : {"free", "back"}) {
    const DiagnosticPoint at = chain.point(name, "GR");
    REQUIRE(at.multipliers.size() == 4);
    const double angle = std::sqrt(1.0 - damping * damping) * period;
    CHECK(distance_to(at.multipliers, std::polar(std::exp(-damping * period), angle)) < 1e-9);
    CHECK(distance_to(at.multipliers, std::exp(-2.0 * omega / omega * period)) < 1e-9);  // of the circle of the forcing
  }

  // Joined again: the free orbit, a sine.
  for (const SolutionEntry& orbit : chain.solutions("free_again")) {
    CHECK(orbit.parameter(1) < grazing(omega));
    check_near(orbit.states.front()[0], orbit.parameter(1) / grazing(omega));
    check_near(orbit.states.front()[1], 0.0);
  }

  const SolutionEntry doubling = chain.only("contact", "PD");
  const Eigen::Vector2d touch = touch_of(doubling, 1);
  const Eigen::VectorXd exact = critical_orbit(
      {touch(0), touch(1), rounded(doubling.parameter(62)), rounded(doubling.parameter(1))}, period, -1.0, omega);
  check_near(doubling.parameter(1), exact(3));
  check_near(doubling.parameter(62), exact(2));

  // One contact in two periods turns back where it has the multiplier 1.
  const SolutionEntry fold = chain.only("one_contact", "LP");
  const Eigen::Vector2d single = touch_of(fold, 1);
  const Eigen::VectorXd turn = critical_orbit(
      {single(0), single(1), rounded(fold.parameter(62)), rounded(fold.parameter(1))}, 2.0 * period, 1.0, omega);
  check_near(fold.parameter(1), turn(3));
}

TEST_CASE("elastic stop: the second of two contacts ends where linear pieces touch the stop") {
  const MakefileRun chain("elastic_stop", "branches");
  const double omega = 2.5, whole = 4.0 * pi / omega;
  const SolutionEntry orbit = chain.only("doubled", "GR");
  // Unknown: time and velocity of the touch, durations of the contact and of the flight up to the tangency, A.
  const Eigen::Vector2d touch = touch_of(orbit, 3);
  Eigen::VectorXd near(5);
  near << touch, rounded(orbit.parameter(64)), rounded(orbit.parameter(61)), rounded(orbit.parameter(1));
  const Eigen::VectorXd exact = newton(near, 1e-11, [&](const Eigen::VectorXd& z) {
    const Eigen::Vector2d leave = contact_piece.after({gap, z(1)}, z(0), z(2), z(4), omega);
    const Eigen::Vector2d tangency = free_piece.after(leave, z(0) + z(2), z(3), z(4), omega);
    const Eigen::Vector2d back = free_piece.after(leave, z(0) + z(2), whole - z(2), z(4), omega);
    Eigen::VectorXd defect(5);
    defect << leave(0) - gap, tangency(0) - gap, tangency(1), back(0) - gap, back(1) - z(1);
    return defect;
  });
  check_near(orbit.parameter(1), exact(4));
  check_near(orbit.parameter(64), exact(2));
  check_near(orbit.parameter(62), 0.0);
  // The branch of one contact in two periods begins there.
  const std::vector<PointSection> next = chain.points("one_contact");
  check_near(next.front().rows.front().values[next.front().column("A")], exact(4));
}

TEST_CASE("elastic stop: curves of grazing and of period doublings in two parameters") {
  const MakefileRun chain("elastic_stop", "branches");
  int seen = 0;
  for (const PointSection& section : chain.points("grazing_curve"))
    for (const PointRow& row : section.rows) {
      const double at = row.values[section.column("omega")];
      check_near(row.values[section.column("A")], grazing(at), 1e-8 * grazing(at));
      ++seen;
    }
  CHECK(seen > 20);
  const std::vector<SolutionEntry> ends = chain.solutions("doubling_curve");
  REQUIRE(ends.size() == 3);  // an extremum of ICP(1) among them
  for (const SolutionEntry& orbit : ends)
    check_near(critical_determinant(orbit.parameter(62), 2.0 * pi / orbit.parameter(2), -1.0), 0.0, 1e-8);
}
