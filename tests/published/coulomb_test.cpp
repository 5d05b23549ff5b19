// The oscillator with dry friction under a harmonic force, as problems/coulomb/Makefile runs it, against closed forms
// and matrix exponentials: where its motion begins to stick, in each of the four ways.
//
// Den Hartog's motion without stops (V = zeta = 0) turns at q = -x0 and q = x0 half a period pi / omega apart. With
// C = cos(pi / omega), S = sin(pi / omega) its solution q = -F + c1 cos t + c2 sin t + A V0 cos(omega t + phase),
// V0 = 1 / (1 - omega^2), gives x0^2 = A^2 V0^2 - F^2 U^2 with U = tan(pi / (2 omega)) / omega. At the turn the mass
// goes on at once while the force of spring and forcing, omega^2 x0, is larger than F: stops begin at
//
//     A = |1 - omega^2| F sqrt(U^2 + 1 / omega^4).
//
// Where the mass slips backward only, its velocity has the amplitude A omega / |1 - omega^2 + 2 i zeta omega|: it
// reaches the belt's speed V at A = V |1 - omega^2 + 2 i zeta omega| / omega.
#include <catch2/catch.hpp>
#include <cmath>

#include "published/exponential_flow.hpp"
#include "published/makefile_run.hpp"
#include "published/newton.hpp"

using namespace test_support;

namespace {

constexpr double pi = 3.14159265358979323846;
using Vector = Eigen::VectorXd;

double stops_begin(double omega) {
  const double U = std::tan(pi / (2.0 * omega)) / omega;
  return std::abs(1.0 - omega * omega) * std::hypot(U, 1.0 / (omega * omega));
}

double belt_is_reached(double omega, double V, double zeta) {
  return V * std::hypot(1.0 - omega * omega, 2.0 * zeta * omega) / omega;
}

/// Every point of a curve in omega and A; with the 10 to 11 digits of p-files.
template <class Closed>
void check_curve(const MakefileRun& chain, const std::string& name, Closed closed) {
  INFO(name);
  int seen = 0;
  for (const PointSection& section : chain.points(name))
    for (const PointRow& row : section.rows) {
      const double omega = row.values[section.column("omega")];
      INFO("omega = " << omega);
      check_near(row.values[section.column("A")], closed(omega));
      ++seen;
    }
  CHECK(seen > 60);
}

/// Motion with F = 1, state (q, v, sine, cosine).
struct Mass {
  double A, omega, V, zeta;

  AffineFlow slip(double friction) const {
    Eigen::Matrix4d M;
    M << 0, 1, 0, 0, -1, -2 * zeta, 0, A, 0, 0, 0, omega, 0, 0, -omega, 0;
    return {M, Eigen::Vector4d(0, friction, 0, 0)};
  }
  AffineFlow stick() const {
    Eigen::Matrix4d M = Eigen::Matrix4d::Zero();
    M(2, 3) = omega;
    M(3, 2) = -omega;
    return {M, Eigen::Vector4d(V, 0, 0, 0)};
  }
  /// Force of spring, damper and forcing; friction of 1 holds it while it is smaller.
  double force(const Vector& x) const { return A * x(3) - 2 * zeta * x(1) - x(0); }
};

/// A of the orbit slip forward, slip backward, stick that begins to stick where friction would just not hold it:
/// unknown q and phase at the start of slip, the three durations, A.
double switching_amplitude(const SolutionEntry& near) {
  const double omega = near.parameter(2), V = near.parameter(4), zeta = near.parameter(5);
  const auto& start = near.states.front();
  Vector z = Vector::Zero(6);
  z << start[0], std::atan2(start[2], start[3]), near.parameter(61), near.parameter(62), near.parameter(63),
      near.parameter(1);
  const auto defect = [&](const Vector& at) {
    const Mass mass{at(5), omega, V, zeta};
    const Vector first = Eigen::Vector4d(at(0), V, std::sin(at(1)), std::cos(at(1)));
    const Vector turned = mass.slip(-1.0).after(at(2), first);
    const Vector caught = mass.slip(1.0).after(at(3), turned);
    const Vector released = mass.stick().after(at(4), caught);
    Vector values = Vector::Zero(6);
    values << turned(1) - V, caught(1) - V, mass.force(caught) - 1.0, mass.force(released) - 1.0, released(0) - at(0),
        at(2) + at(3) + at(4) - 2.0 * pi / omega;
    return values;
  };
  return newton(z, 1e-12, defect)(5);
}

/// A of the symmetric orbit slip, stick whose stop at q just ends at the largest force, A - q = 1: unknown q, the phase
/// at the start of slip, its duration, A.
double dividing_amplitude(const SolutionEntry& near) {
  const double omega = near.parameter(2);
  const auto& start = near.states.front();
  Vector z = Vector::Zero(4);
  z << -start[0], std::atan2(start[2], start[3]), near.parameter(61), near.parameter(1);
  const auto defect = [&](const Vector& at) {
    const Mass mass{at(3), omega, 0.0, 0.0};
    const Vector first = Eigen::Vector4d(-at(0), 0.0, std::sin(at(1)), std::cos(at(1)));
    const Vector stopped = mass.slip(-1.0).after(at(2), first);
    Vector values = Vector::Zero(4);
    values << mass.force(first) - 1.0, stopped(1), stopped(0) - at(0), at(3) - at(0) - 1.0;
    return values;
  };
  return newton(z, 1e-12, defect)(3);
}

bool is_told(const MakefileRun& chain, const std::string& name, const std::string& words) {
  return chain.tchat({"labels", "q." + name}).text().find(words) != std::string::npos;
}

}  // namespace

TEST_CASE("make -j2 in problems/coulomb: sticking begins on the closed-form loci, in each of the four ways") {
  const MakefileRun chain("coulomb", "branches");
  chain.check_repeatable();
  chain.check_verified();

  check_near(chain.only("stopping", "GR").parameter(1), stops_begin(0.7));
  CHECK(is_told(chain, "stopping", "crossing-sliding: two events at once"));
  check_curve(chain, "onset", stops_begin);

  check_near(chain.only("slipping", "GR").parameter(1), belt_is_reached(0.7, 1.0, 0.1));
  CHECK(is_told(chain, "slipping", "grazing-sliding: grazing: contact with event 2"));
  check_curve(chain, "grazing_curve", [](double omega) { return belt_is_reached(omega, 1.0, 0.1); });

  const SolutionEntry switching = chain.only("one_stop", "GR");
  check_near(switching.parameter(1), switching_amplitude(switching));
  CHECK(is_told(chain, "one_stop", "switching-sliding: "));
  for (const SolutionEntry& orbit : chain.solutions("switching_curve"))
    check_near(orbit.parameter(1), switching_amplitude(orbit));

  const SolutionEntry dividing = chain.only("two_stops", "GR");
  check_near(dividing.parameter(1), dividing_amplitude(dividing));
  CHECK(is_told(chain, "two_stops", "adding-sliding: "));
}

TEST_CASE("From the crossing side the onset of stops is the same point, and its curve") {
  const MakefileRun chain("coulomb", "branches");
  chain.run("-c r.moving -s moving -o back IRS=EP1 DS=-0.05 RL0=1.1 RL1=4");
  const SolutionEntry onset = chain.only("back", "GR");
  check_near(onset.parameter(1), stops_begin(0.7));
  CHECK(is_told(chain, "back", "crossing-sliding: h_x f = 0 of field 2"));
  chain.run("-c r.back -s back -o onset_again --both IRS=GR1 ISW=2 ICP=[omega,A] RL0=0.55 RL1=3 NMX=100");
  check_curve(chain, "onset_again", stops_begin);

  // Beyond it the orbit would slide.
  chain.run("-c r.back -s back -o beyond IRS=GR1 DS=0.02 NMX=5");
  const auto beyond = chain.read("d.beyond");
  CHECK(beyond.find("Inadmissible: segment 1 begins on a surface that its field 1 (slip forward) leads back to") !=
        std::string::npos);

  // No curve of two events at once begins where the orbit touches a surface, or at a label that is none.
  const auto refused = [&](std::vector<std::string> words, const std::string& sentence) {
    words.insert(words.begin(), {"run", "coulomb", "-p", chain.plugin(), "-o", "none", "ISW=2"});
    const Outcome outcome = chain.tchat(words);
    INFO(outcome.text());
    CHECK(outcome.status != 0);
    CHECK(outcome.text().find(sentence) != std::string::npos);
  };
  refused({"-c", "r.slipping", "-s", "slipping", "IRS=GR1", "ICP=[omega,A]"},
          "no curve with ISW = 2 begins at label 2 (GR): the contact is inside segment 1");
  refused({"-c", "r.two_stops", "-s", "two_stops", "IRS=GR1", "ICP=[omega,A]"}, "tchat resegment --to grazing-curve");
  refused({"-c", "r.back", "-s", "back", "IRS=GR1", "ICP=[A]"}, "ICP");
}
