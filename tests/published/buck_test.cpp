// The buck converter of Fossas and Olivar, as problems/buck/Makefile runs it: its period doublings as published, and
// all others against the closed form. Between two switchings (v, i) - the equilibrium is multiplied by exp(A t), so the
// switchings of a cycle of n ramps solve n equations, and its return map is a product of exponentials and saltations.
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>

#include "published/makefile_run.hpp"
#include "published/newton.hpp"

using namespace test_support;

namespace {

constexpr double R = 22.0, C = 47e-6, L = 20e-3, reference = 11.3, low = 3.8, high = 8.2, T = 400e-6;
constexpr double slope = (high - low) / T;

/// exp(A t) with C v' = i - v / R, L i' = -v; its eigenvalues are complex.
Eigen::Matrix2d exponential(double t) {
  const double gamma = 0.5 / (R * C), omega = std::sqrt(1.0 / (L * C) - gamma * gamma);
  Eigen::Matrix2d A;
  A << -1.0 / (R * C), 1.0 / C, -1.0 / L, 0.0;
  const Eigen::Matrix2d identity = Eigen::Matrix2d::Identity();
  return std::exp(-gamma * t) * (std::cos(omega * t) * identity + std::sin(omega * t) / omega * (A + gamma * identity));
}

/// A cycle of n ramps that is off for off(k) of ramp k and on for the rest, by its values and its return map.
struct Cycle {
  Eigen::VectorXd misses;  ///< control voltage minus ramp at each switching
  Eigen::Matrix2d map;
};

Cycle cycle(const Eigen::VectorXd& off, double vin, double gain) {
  const Eigen::Vector2d on_equilibrium(vin, vin / R);
  Eigen::Matrix2d flow = Eigen::Matrix2d::Identity();
  Eigen::Vector2d forced = Eigen::Vector2d::Zero();  // of the state 0
  for (const double part : off) {
    const Eigen::Matrix2d on = exponential((1.0 - part) * T), step = on * exponential(part * T);
    flow = step * flow;
    forced = step * forced + on_equilibrium - on * on_equilibrium;
  }
  Cycle result{Eigen::VectorXd(off.size()), Eigen::Matrix2d::Identity()};
  Eigen::Vector2d x = (Eigen::Matrix2d::Identity() - flow).partialPivLu().solve(forced);
  for (Eigen::Index k = 0; k < off.size(); ++k) {
    const Eigen::Matrix2d before = exponential(off(k) * T), after = exponential((1.0 - off(k)) * T);
    x = before * x;
    result.misses(k) = gain * (x(0) - reference) - low - slope * off(k) * T;
    const double rate = gain * (x(1) - x(0) / R) / C - slope;
    Eigen::Matrix2d saltation = Eigen::Matrix2d::Identity();
    saltation(1, 0) = vin / L * gain / rate;
    result.map = after * saltation * before * result.map;
    x = on_equilibrium + after * (x - on_equilibrium);
  }
  return result;
}

/// Vin at which a cycle of n ramps has the multiplier `critical`, by Newton's method from near it.
double critical_vin(const Eigen::VectorXd& off, double vin, double critical) {
  Eigen::VectorXd z(off.size() + 1);
  z << off, vin / 30.0;
  const auto defect = [&](const Eigen::VectorXd& at) {
    const Cycle c = cycle(at.head(off.size()), at(off.size()) * 30.0, 8.4);
    Eigen::VectorXd values(at.size());
    values << c.misses, (c.map - critical * Eigen::Matrix2d::Identity()).determinant();
    return values;
  };
  z = newton(z, 1e-10, defect);
  return z(off.size()) * 30.0;
}

/// The only PD or LP of a branch against the closed form; Vin is returned.
double check_critical(const MakefileRun& chain, const std::string& name, const std::string& type) {
  INFO(name);
  const SolutionEntry orbit = chain.only(name, type);
  const std::size_t ramps = orbit.states.front().size() / 6;
  Eigen::VectorXd off(ramps);
  for (std::size_t k = 0; k < ramps; ++k)
    off(k) = std::round(orbit.parameter(61 + 2 * static_cast<int>(k)) * 1e5) / 1e5;
  const double vin = orbit.parameter(1);
  check_near(vin, critical_vin(off, std::round(vin * 1e4) / 1e4, type == "PD" ? -1.0 : 1.0), 1e-8);
  return vin;
}

}  // namespace

TEST_CASE("make -j2 in problems/buck: published period doublings, and the others in closed form") {
  const MakefileRun chain("buck", "branches");
  chain.check_verified();

  check_near(check_critical(chain, "cycle", "PD"), 24.51657283, 1e-8);
  check_near(check_critical(chain, "doubled", "PD"), 31.11790201, 1e-8);
  check_critical(chain, "fourfold", "PD");
  check_critical(chain, "eightfold", "PD");
  check_critical(chain, "six_ramps", "PD");
  check_critical(chain, "six_ramps", "LP");
  for (const char* name : {"cycle", "six_ramps"}) CHECK(first_iterations(chain.read(std::string("d.") + name)) <= 3);

  // The switch stays on where v = Vin keeps the control voltage below the ramp.
  check_near(chain.only("cycle", "GR").parameter(1), reference + low / 8.4);

  // There the curve of period doublings ends: the trace of the return map is that of exp(A T) and, by the saltation,
  // minus a Vin / (L slope) times its upper right element.
  const SolutionEntry end = chain.only("cycle_doublings", "GR");
  const Eigen::Matrix2d flow = exponential(T);
  const double gain = ((1.0 + flow.trace() + flow.determinant()) * L * slope / flow(0, 1) - low) / reference;
  check_near(end.parameter(2), gain);
  check_near(end.parameter(1), reference + low / gain);

  // The upper corner: the control voltage is 8.2 V where a ramp ends, and the branch goes on with one switching less.
  const SolutionEntry corner = chain.only("fourfold", "GR");
  check_near(corner.states.back()[18], high);
  check_near(chain.solutions("from_missed_switch").front().parameter(1), corner.parameter(1));
}
