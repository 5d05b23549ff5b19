// Tangent vectors along a trajectory: the matrix exponential, closed forms, CVODES' sensitivities.
#include <catch2/catch.hpp>
#include <cmath>

#include "lyapunov_problems.hpp"
#include "motion/cvodes_flow.hpp"
#include "motion/tangent_flow.hpp"

using namespace tchat;
using namespace tchat::test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// x1' = 1 (time), x2' = cos(x1) x2: d x2(t) / d x2(0) = exp(sin t).
struct Breathing {
  static constexpr int dimension = 2, parameters = 0, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    using std::cos;
    f[0] = T(1.0), f[1] = cos(x[0]) * x[1];
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[1];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0], g[1] = x[1];
  }
};

/// x' = -x / 2 + 1e8 y, y' = -0.6 y
struct TransientGrowth {
  static constexpr int dimension = 2, parameters = 0, fields = 1, events = 1, jumps = 1;
  static inline long calls = 0;  // of the field
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    ++calls;
    f[0] = -0.5 * x[0] + 1e8 * x[1], f[1] = -0.6 * x[1];
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[1];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0], g[1] = x[1];
  }
};

/// s' = 1, y' = y^3 - y; at s = 6, s -> s - 6: y comes to rest if it begins below 1, else it grows beyond all bounds
/// in finite time.
struct Leaving {
  static constexpr int dimension = 2, parameters = 0, fields = 1, events = 1, jumps = 1;
  static inline long calls = 0;  // of the field
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    ++calls;
    f[0] = T(1.0), f[1] = x[1] * x[1] * x[1] - x[1];
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return 6.0 - x[0];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0] - 6.0, g[1] = x[1];
  }
};

/// s' = 1, x_i' = cos(s) (x_{i-1} - 2 x_i + x_{i+1}), ends held: few entries of f_x are not zero, which are multiplied
/// and factorised as such. At x = 0 the derivative is exp(sin(t) L), L = S diag(-4 sin^2(k pi / (2 n + 2))) S.
struct Chain {
  static constexpr int links = 40;
  static constexpr int dimension = links + 1, parameters = 0, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    using std::cos;
    f[0] = T(1.0);
    for (int i = 1; i <= links; ++i) {
      f[i] = -2.0 * x[i];
      if (i > 1) f[i] = f[i] + x[i - 1];
      if (i < links) f[i] = f[i] + x[i + 1];
      f[i] = cos(x[0]) * f[i];
    }
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return 1.0 - x[0];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
  }
  static MatrixXd derivative(double t) {
    constexpr double pi = 3.14159265358979323846;
    MatrixXd modes(links, links);
    VectorXd growth(links);
    for (int k = 0; k < links; ++k) {
      growth(k) = std::exp(-4.0 * std::sin(t) * std::pow(std::sin(0.5 * (k + 1) * pi / (links + 1)), 2));
      for (int i = 0; i < links; ++i)
        modes(i, k) = std::sqrt(2.0 / (links + 1)) * std::sin((i + 1) * (k + 1) * pi / (links + 1));
    }
    MatrixXd whole = MatrixXd::Identity(dimension, dimension);
    whole.bottomRightCorner(links, links) = modes * growth.asDiagonal() * modes.transpose();
    return whole;
  }
};

}  // namespace

TEST_CASE("many states, few entries: the derivative of a chain in closed form, by CVODES and by the tangent flow") {
  const HybridSystem& system = system_of<Chain>();
  const ParameterVector par = parameters({});
  VectorXd x = VectorXd::Zero(Chain::dimension);
  const double end = 0.9;
  for (const IntegrationMethod method : {IntegrationMethod::adams, IntegrationMethod::bdf}) {
    FlowOptions options;
    options.relative_tolerance = 1e-12;
    options.absolute_tolerance = 1e-14;
    options.method = method;
    CvodesFlow flow(system, 1, x, par, options);
    REQUIRE(flow.advance(end) == Progress::end_time);
    CHECK((flow.jacobian() - Chain::derivative(end)).cwiseAbs().maxCoeff() < 1e-9);
  }
  const DenseOutput state = [&](double t) {
    x(0) = t;
    return x.data();
  };
  TangentFlow tangent(system, par, 0.0);
  MatrixXd v = MatrixXd::Identity(Chain::dimension, Chain::dimension);
  REQUIRE(tangent.carry(v, 1, state, 0.0, end));
  CHECK((v - Chain::derivative(end)).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("tangent flow: growth along a trajectory in closed form, whatever the step") {
  const HybridSystem& system = system_of<Breathing>();
  const ParameterVector par = parameters({});
  VectorXd x(2);
  const DenseOutput state = [&](double t) {
    x << t, 0.0;
    return x.data();
  };
  const std::pair<double, double> orders[] = {{0.0, 1e-9}, {1e-8, 1e-6}};  // sixth, fourth: tolerance, error
  for (const auto& [tolerance, error] : orders)
    for (const double end : {0.01, 0.3, 2.0, 30.0}) {
      CAPTURE(tolerance, end);
      TangentFlow flow(system, par, tolerance);
      OrthonormalFrame frame(2, 2);
      REQUIRE(flow.carry(frame, 1, state, 0.0, end));
      frame.orthonormalise();
      const VectorXd growth = frame.take_growth();
      CHECK(std::abs(growth.sum() - std::sin(end)) < error * (1.0 + end));  // trace: cos t
    }
  TangentFlow flow(system, par, 0.0);
  OrthonormalFrame frame(2, 1);
  frame.vectors() << 0.0, 1.0;
  REQUIRE(flow.carry(frame, 1, state, 0.0, 1.5));
  frame.orthonormalise();
  CHECK(std::abs(frame.take_growth()(0) - std::sin(1.5)) < 1e-9);
}

TEST_CASE("tangent flow: a transient that grows 1e8 times takes no small steps") {
  const HybridSystem& system = system_of<TransientGrowth>();
  const ParameterVector par = parameters({});
  const VectorXd x = VectorXd::Zero(2);
  const DenseOutput state = [&](double) { return x.data(); };
  const double end = 6.0;
  MatrixXd expected(2, 2);
  expected << std::exp(-0.5 * end), 1e8 * (std::exp(-0.5 * end) - std::exp(-0.6 * end)) / 0.1, 0.0,
      std::exp(-0.6 * end);
  for (const double tolerance : {0.0, 1e-8}) {
    TangentFlow tangent(system, par, tolerance);
    MatrixXd v = MatrixXd::Identity(2, 2);
    TransientGrowth::calls = 0;
    REQUIRE(tangent.carry(v, 1, state, 0.0, end));
    CHECK((v - expected).cwiseAbs().maxCoeff() < (tolerance == 0.0 ? 1e-11 : 1e-9) * expected(0, 1));
    CHECK(std::abs(v(1, 1) / expected(1, 1) - 1.0) < (tolerance == 0.0 ? 1e-12 : 1e-9));
    CHECK(TransientGrowth::calls < 100);
  }
}

TEST_CASE("tangent flow: agrees with the sensitivities of CVODES along the Lorenz attractor") {
  const HybridSystem& system = system_of<Lorenz>();
  const ParameterVector par = lorenz_parameters();
  const VectorXd x0 = Eigen::Vector3d(-3.1, -5.2, 17.0);
  FlowOptions options;
  options.relative_tolerance = 1e-13;
  options.absolute_tolerance = 1e-14;
  CvodesFlow reference(system, 1, x0, par, options);
  REQUIRE(reference.advance(0.25) == Progress::end_time);

  const MatrixXd phi = reference.jacobian();
  options.variational = false;
  const auto error_of = [&](double tolerance) {
    OrthonormalFrame frame(3, 3);
    frame.vectors().setIdentity();
    TangentFlow tangent(system, par, tolerance);
    CvodesFlow flow(system, 1, x0, par, options);
    flow.on_piece([&](double from, double to) {
      // So short a time that columns stay apart: the frame is the flow's Jacobian as long as nothing is made
      // orthonormal.
      tangent.restart();
      return tangent.carry(frame, 1, flow.dense_output(), from, to);
    });
    REQUIRE(flow.advance(0.25) == Progress::end_time);
    return (frame.vectors() - phi).norm() / phi.norm();
  };
  CHECK(error_of(options.relative_tolerance) < 1e-9);
  CHECK(error_of(1e-8) < 1e-6);
}

TEST_CASE("simulated turn: one that leaves the motion for far away ends as a fault at once") {
  const HybridSystem& system = system_of<Leaving>();
  const ParameterVector par = parameters({});
  SimulationSettings settings;
  settings.flow.method = IntegrationMethod::runge_kutta;
  settings.flow.set(level::relaxed_flow);
  HybridSimulation motion(ModeRule(system, std::vector<Mode>{Mode{{{1, 1, 1}}, {}}}), Eigen::Vector2d(0.0, 0.1), par,
                          settings);
  for (int k = 0; k < 3; ++k) REQUIRE(motion.next(1e3).ended_by == SegmentEnd::event);
  Leaving::calls = 0;
  const SimulatedTurn turn = simulate_turn(motion, Eigen::Vector2d(6.0, 1.5), {{1, 1, 1}}, settings, true);
  CHECK(turn.fault == "segment 1 does not end as that of the motion");
  CHECK(Leaving::calls < 10'000);
}

TEST_CASE("tangent flow: says where a derivative is not finite") {
  const HybridSystem& system = system_of<Breathing>();
  const ParameterVector par = parameters({});
  VectorXd x = VectorXd::Constant(2, NAN);
  TangentFlow flow(system, par, 0.0);
  OrthonormalFrame frame(2, 2);
  CHECK_FALSE(flow.carry(
      frame, 1, [&](double) { return x.data(); }, 0.0, 1.0));
}
