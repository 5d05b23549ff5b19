#include "benchmark/torus_times.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <tchat/problem.hpp>

#include "../problems/torus/torus.cpp"
#include "benchmark/timing.hpp"
#include "continuation/path_follower.hpp"
#include "maps/invariant_curve.hpp"
#include "motion/hybrid_simulation.hpp"
#include "orbit/torus_system.hpp"
#include "stability/floquet_multipliers.hpp"
#include "support/test_system.hpp"

namespace tchat::benchmark {

namespace {

using test::pi;
using test::system_of;

constexpr double golden = std::numbers::phi;
constexpr int intervals = 20, collocation = 4;
constexpr NewtonSettings newton{8, 3, 1e-7, 1e-7};
constexpr int omega_parameter = 1;

/// The torus of problems/torus with the phase of the forcing as a third state, from revolution to revolution: n = 3.
struct TorusByPhase {
  static constexpr int dimension = 3, parameters = 2, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* u, const T* par, T* f) const {
    using std::cos, std::sqrt;
    const T growth = 1.0 + sqrt(u[0] * u[0] + u[1] * u[1]) * (cos(u[2]) - 1.0);
    f[0] = -par[1] * u[1] + u[0] * growth;
    f[1] = par[1] * u[0] + u[1] * growth;
    f[2] = par[0];
  }
  template <class T>
  T event(int, const T* u, const T*) const {
    return 2.0 * pi - u[2];
  }
  template <class T>
  void jump(int, const T* u, const T*, T* g) const {
    g[0] = u[0], g[1] = u[1], g[2] = u[2] - 2.0 * pi;
  }
};

double radius(double psi, double w) { return (1.0 + w * w) / (1.0 + w * w - std::cos(psi) - w * std::sin(psi)); }

/// A torus in closed form and how a return of it is seen.
struct Case {
  const HybridSystem* system;
  double time;      ///< of a return
  double rotation;  ///< at the start, omega = 2
  /// The state of the return of phase phi at the time t.
  Eigen::VectorXd (*state)(double phi, double t, double w);
  /// How far a state on the section is from the torus.
  double (*distance)(const Eigen::VectorXd& u, double w);
};

constexpr double first_omega = 2.0;

const Case four{&system_of<PlanarTorus>(), 2.0 * pi / golden, first_omega / golden - 1.0,
                [](double phi, double t, double w) -> Eigen::VectorXd {
                  const double now = 2.0 * pi * phi + w * t, angle = pi + golden * t, r = radius(now, w);
                  return Eigen::Vector4d(r * std::cos(angle), r * std::sin(angle), std::sin(now), std::cos(now));
                },
                [](const Eigen::VectorXd& u, double w) {
                  return std::abs(std::hypot(u(0), u(1)) - radius(std::atan2(u(2), u(3)), w));
                }};

const Case three{&system_of<TorusByPhase>(), 2.0 * pi / first_omega, golden / first_omega,
                 [](double phi, double t, double w) -> Eigen::VectorXd {
                   const double angle = 2.0 * pi * phi + golden * t, r = radius(w * t, w);
                   return Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), w * t);
                 },
                 [](const Eigen::VectorXd& u, double w) { return std::abs(std::hypot(u(0), u(1)) - radius(0.0, w)); }};

/// There and back again in omega and rho.
class TorusWalk {
 public:
  TorusWalk(const Case& torus, int orbits)
      : torus_(torus),
        shape_{torus.system->dimension(), orbits, intervals, collocation},
        system_(*torus.system, {{1, 1, 1}}, orbits, {omega_parameter, ParameterLayout().rotation()}),
        follower_(system_, shape_, WeightedNorm::unit(shape_), newton, omega_parameter),
        point_(follower_.make_point(start())),
        next_(point_) {
    if (!follower_.start_at_fixed_parameter(point_).converged()) throw std::runtime_error("no torus to start from");
    next_ = point_;
  }
  TorusWalk(const TorusWalk&) = delete;
  TorusWalk& operator=(const TorusWalk&) = delete;

  void step() {
    if (++steps_ % 10 == 0) ds_ = -ds_;
    if (!follower_.step(point_, ds_, next_).converged()) throw std::runtime_error("a step along the tori failed");
    std::swap(point_, next_);
    keep(torus_multipliers(system_, follower_.condensed(), point_.orbit));
  }
  double error() const {
    double largest = 0.0;
    for (int k = 0; k < 100; ++k) {
      const Eigen::VectorXd u =
          section_curve(system_, point_.orbit) * interpolation_weights(shape_.segments, k / 100.0).transpose();
      largest = std::max(largest, torus_.distance(u, point_.orbit.par(omega_parameter - 1)));
    }
    return largest;
  }

 private:
  Orbit start() const {
    Orbit x{shape_, uniform_mesh(intervals), Eigen::MatrixXd(shape_.dimension, shape_.columns()),
            ParameterVector(ParameterLayout())};
    x.par(0) = first_omega, x.par(1) = golden, x.par(2) = 5.0;
    x.par.rotation() = torus_.rotation;
    for (int i = 0; i < shape_.segments; ++i) {
      x.duration(i) = torus_.time;
      for (int k = 0; k < shape_.nodes(); ++k)
        x.states.col(i * shape_.nodes() + k) =
            torus_.state(static_cast<double>(i) / shape_.segments, x.tau(k) * torus_.time, first_omega);
    }
    return x;
  }

  const Case& torus_;
  OrbitShape shape_;
  TorusSystem system_;
  PathFollower follower_;
  PathPoint point_, next_;
  double ds_ = 0.05;
  int steps_ = 0;
};

/// The same torus by simulation: points of returns, and the curve through them.
struct Simulated {
  double seconds = 0.0, error = 0.0;
  int harmonics = 0;
};

Simulated simulated(const Case& torus, double tolerance, int returns) {
  SimulationSettings settings;
  settings.flow.relative_tolerance = tolerance;
  settings.flow.absolute_tolerance = 0.1 * tolerance;
  settings.flow.variational = false;
  settings.samples = 0;
  ParameterVector par{ParameterLayout()};
  par(0) = first_omega, par(1) = golden, par(2) = 5.0;
  const Mode mode{{{1, 1, 1}}, {}};
  Simulated result;
  result.seconds = processor_seconds([&] {
    HybridSimulation simulation(ModeRule(*torus.system, std::vector<Mode>{mode}), torus.state(0.0, 0.0, first_omega),
                                par, settings);
    Eigen::MatrixXd points(torus.system->dimension(), returns);
    constexpr double forever = 1e9;
    for (int k = -returns / 3; k < returns; ++k) {
      const SimulatedSegment segment = simulation.next(forever);
      if (segment.ended_by != SegmentEnd::event) throw std::runtime_error("the simulation stopped: " + segment.message);
      if (k >= 0) points.col(k) = segment.after;
    }
    const FittedCurve fitted = fit_invariant_curve(points, {.angles = {}, .max_harmonics = 200, .tolerance = 1e-3}, "");
    result.harmonics = fitted.curve.harmonics();
    for (int k = 0; k < 100; ++k)
      result.error = std::max(result.error, torus.distance(fitted.curve.at(k / 100.0), first_omega));
  });
  return result;
}

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace

void print_torus_times(const std::vector<int>& orbits, int steps, int returns) {
  fmt::print("(d) Tori, NTST = {}, NCOL = {}: a step of omega and rho with multipliers, medians\n\n", intervals,
             collocation);
  for (const Case* torus : {&three, &four}) {
    fmt::print("n = {}\n{:>8}{:>14}{:>20}{:>30}{:>20}\n", torus->system->dimension(), "N", "step [ms]",
               "off the torus by", "steps in one simulation", "peak so far [MB]");
    // The largest tolerance with which the simulation is as near as the orbits.
    double step_at_41 = 0.0;
    Simulated beside;
    for (const int n : orbits) {
      TorusWalk walk(*torus, n);
      std::vector<double> times;
      for (int k = 0; k < steps; ++k) times.push_back(processor_seconds([&] { walk.step(); }));
      if (beside.seconds == 0.0)
        for (double tolerance = 1e-5; tolerance > 1e-13; tolerance *= 0.1) {
          beside = simulated(*torus, tolerance, returns);
          if (beside.error <= 3e-8) break;
        }
      if (n == 41) step_at_41 = median(times);
      fmt::print("{:>8}{:>14.2f}{:>20.1e}{:>30.1f}{:>20.0f}\n", n, 1e3 * median(times), walk.error(),
                 beside.seconds / median(times), peak_megabytes());
    }
    fmt::print("  simulation of {} returns and a fit of {} harmonics: {:.2f} s, off the torus by {:.1e}\n",
               returns + returns / 3, beside.harmonics, beside.seconds, beside.error);
    if (step_at_41 > 0.0) fmt::print("  N = 41: {:.3f} s   (wanted: at most 0.5)\n", step_at_41);
    fmt::print("\n");
  }
}

}  // namespace tchat::benchmark
