// A clock: a damped pendulum, x'' = -x - 2 d x', that gets a kick v -> v + k each time it passes x = 0 to the right.
//
// In closed form: between kicks v falls by the factor m = exp(-2 pi d / sqrt(1 - d^2)), so that the velocity after the
// kick is v = k / (1 - m), and m is the one multiplier of the orbit. This program follows the orbit in d, without the
// executable of tchat, and compares every point with that.
#include <cmath>
#include <cstdio>

#include "continuation/continuation_run.hpp"
#include "model/hybrid_system.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "tchat/problem.hpp"

namespace {

constexpr double pi = 3.14159265358979323846;

struct Clock {
  static constexpr int dimension = 2, parameters = 2, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    f[0] = x[1];
    f[1] = -x[0] - 2.0 * par[0] * x[1];
  }
  /// A segment ends where this falls to zero: x rises through 0.
  template <class T>
  T event(int, const T* x, const T*) const {
    return -x[0];
  }
  template <class T>
  void jump(int, const T* x, const T* par, T* g) const {
    g[0] = x[0];
    g[1] = x[1] + par[1];
  }
};

double multiplier_at(double damping) { return std::exp(-2.0 * pi * damping / std::sqrt(1.0 - damping * damping)); }

/// Prints each point, and keeps the largest difference from the closed form.
class Comparison final : public tchat::BranchSink {
 public:
  void point(const tchat::BranchPoint& point) override {
    const tchat::Orbit& orbit = point.path.orbit;
    const double damping = orbit.par(0), kick = orbit.par(1);
    const double velocity = orbit.start(0)[1];
    const double multiplier = point.multipliers.values.front().real();
    std::printf("%3d  d = %.6f  v = %.10f  multiplier = %.10f\n", point.number, damping, velocity, multiplier);
    const double exact = multiplier_at(damping);
    largest = std::fmax(largest, std::fabs(velocity - kick / (1.0 - exact)));
    largest = std::fmax(largest, std::fabs(multiplier - exact));
  }
  void next_step(int, double) override {}
  void note(int, const std::string& text) override { std::printf("     %s\n", text.c_str()); }

  double largest = 0.0;
};

/// The closed form at d = 0.1, k = 1 on a mesh of 20 intervals with 4 collocation points.
tchat::Orbit first_orbit(double damping) {
  const tchat::OrbitShape shape{2, 1, 20, 4};
  tchat::Orbit orbit{shape, tchat::uniform_mesh(shape.intervals), Eigen::MatrixXd(2, shape.columns()),
                     tchat::ParameterVector(tchat::ParameterLayout(2))};
  const double omega = std::sqrt(1.0 - damping * damping);
  const double velocity = 1.0 / (1.0 - multiplier_at(damping));
  orbit.par(0) = damping;
  orbit.par(1) = 1.0;
  orbit.duration(0) = 2.0 * pi / omega;
  for (int k = 0; k < shape.nodes(); ++k) {
    const double t = orbit.tau(k) * orbit.duration(0);
    const double decay = velocity * std::exp(-damping * t);
    orbit.node(0, k)[0] = decay * std::sin(omega * t) / omega;
    orbit.node(0, k)[1] = decay * (std::cos(omega * t) - damping * std::sin(omega * t) / omega);
  }
  return orbit;
}

}  // namespace

int main() {
  constexpr int principal = 1;  // PAR(1), the damping
  const tchat::HybridSystem clock(*tchat::ProblemTable<Clock>::get("clock"));
  const tchat::PeriodicOrbitSystem equations(clock, {{1, 1, 1}}, {principal});  // field 1, event 1, jump 1
  const tchat::Orbit start = first_orbit(0.1);
  tchat::PathFollower follower(equations, start.shape, tchat::WeightedNorm::unit(start.shape), {12, 4, 1e-11, 1e-11},
                               principal);
  tchat::PathPoint first = follower.make_point(start);
  if (!follower.start_at_fixed_parameter(first).converged()) {
    std::puts("no orbit near the start");
    return 1;
  }

  tchat::ContinuationSettings settings;
  settings.step.initial = 0.02;
  settings.step.maximum = 0.2;
  settings.max_points = 40;
  settings.principal = principal;
  settings.parameter_min = 0.05;
  settings.parameter_max = 0.4;
  settings.adapt_mesh_every = 1;
  settings.state_weights = Eigen::VectorXd::Ones(2);
  settings.monitored = {{}};
  Comparison comparison;
  tchat::ContinuationRun run(follower, equations, settings, {}, comparison);
  const tchat::BranchSummary summary = run.run(first);
  std::printf("%d points: %s\nLargest difference from the closed form: %.1e\n", summary.points, summary.detail.c_str(),
              comparison.largest);
  return comparison.largest < 1e-6 ? 0 : 1;
}
