#include "grazing/grazing_orbit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include "bvp/surface_rate.hpp"
#include "linear_algebra/dense_matrix.hpp"
#include "simulation/orbit_flow.hpp"
#include "text/user_error.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One turn from x*: where it ends, and the derivatives of that by x*, the last duration and the parameters.
struct Turn {
  std::string message;  // why there is none
  VectorXd end, f;      // f there
  MatrixXd by_state, by_parameters;
  std::vector<double> durations;
};

Turn failed(const std::string& message) {
  Turn turn;
  turn.message = message;
  return turn;
}

class TurnMap {
 public:
  TurnMap(const HybridSystem& system, const ContactTurn& turn)
      : system_(system),
        first_jump_(turn.section_jump),
        leading_(turn.segments.begin(), turn.segments.end() - 1),
        field_(turn.segments.back().field) {
    options_.active.resize(static_cast<std::size_t>(system.parameters()));
    std::iota(options_.active.begin(), options_.active.end(), 1);
    options_.max_duration = 10.0 * std::accumulate(turn.durations.begin(), turn.durations.end(), 0.0);
  }

  /// By Adams' formulas, else with less accuracy, else for stiff problems: what works is kept.
  Turn at(const VectorXd& x, double last, const VectorXd& par) {
    Turn turn = once(x, last, par);
    while (!turn.message.empty() && relax()) turn = once(x, last, par);
    return turn;
  }

 private:
  bool relax() {
    if (options_.method == IntegrationMethod::bdf) return false;
    if (options_.relative_tolerance < 1e-13) {
      options_.relative_tolerance = 1e-12;
      options_.absolute_tolerance = 1e-14;
      return true;
    }
    options_.method = IntegrationMethod::bdf;
    options_.relative_tolerance = 1e-11;
    options_.absolute_tolerance = 1e-13;
    options_.max_steps = 1000000;
    return true;
  }

  Turn once(const VectorXd& x, double last, const VectorXd& par) const {
    Turn turn;
    turn.end.resize(x.size());
    turn.by_state.resize(x.size(), x.size());
    turn.by_parameters.resize(x.size(), system_.parameters());
    system_.first(FunctionKind::jump, first_jump_, x.data(), par.data(), options_.active, turn.end.data(),
                  turn.by_state.data(), turn.by_parameters.data());
    if (!turn.end.allFinite()) return failed("the jump at the contact cannot be evaluated");
    if (!leading_.empty()) {
      const ReturnMap map = return_map(system_, leading_, turn.end, par, options_);
      if (!map.ok) return failed(map.message);
      turn.end = map.end;
      turn.by_parameters = (map.derivative * turn.by_parameters + map.parameter_derivative).eval();
      turn.by_state = (map.derivative * turn.by_state).eval();
      for (const MapSegment& segment : map.segments) turn.durations.push_back(segment.duration);
    }
    const SegmentFlow flow = integrate_for(system_, field_, turn.end, par, last, options_);
    if (flow.status == FlowStatus::failed) return failed(flow.message);
    turn.end = flow.end_state;
    turn.by_state = (flow.jacobian * turn.by_state).eval();
    turn.by_parameters = (flow.jacobian * turn.by_parameters + flow.parameter_derivative).eval();
    turn.durations.push_back(last);
    turn.f.resize(x.size());
    system_.value(FunctionKind::field, field_, turn.end.data(), par.data(), turn.f.data());
    return turn;
  }

  const HybridSystem& system_;
  int first_jump_;
  Signature leading_;
  int field_;
  FlowOptions options_;
};

Eigen::VectorXcd largest_first(const MatrixXd& matrix) {
  Eigen::VectorXcd values = eigenvalues(matrix);
  std::sort(values.begin(), values.end(), [](const auto& a, const auto& b) {
    const double difference = std::abs(a) - std::abs(b);
    return difference != 0.0 ? difference > 0.0 : a.imag() > b.imag();
  });
  return values;
}

std::vector<int> all_parameters(const HybridSystem& system) {
  std::vector<int> all(static_cast<std::size_t>(system.parameters()));
  std::iota(all.begin(), all.end(), 1);
  return all;
}

}  // namespace

double GrazingOrbit::period() const { return std::accumulate(durations.begin(), durations.end(), 0.0); }

GrazingOrbit find_grazing_orbit(const HybridSystem& system, const ContactTurn& start, const std::string& source) {
  constexpr int most_iterations = 20;
  constexpr double converged = 1e-13;
  constexpr double good_enough = 1e-9;  // where errors of the integration end Newton's method
  const Eigen::Index n = start.x.size();
  const int k = start.parameter - 1;
  TurnMap map(system, start);
  SurfaceRate surface(system.dimension(), system.parameters());
  const std::vector<int> parameters = all_parameters(system);
  VectorXd x = start.x;
  ParameterVector par = start.par;
  double last = start.durations.back();
  double last_step = INFINITY;
  Turn turn;
  for (int iteration = 0;; ++iteration) {
    turn = map.at(x, last, par);
    if (!turn.message.empty())
      throw ComputationError(
          fmt::format("{}: the orbit cannot be followed by forward integration: {}", source, turn.message));
    surface.evaluate(system, start.contact, x.data(), par.data(), parameters);
    if (last_step <= converged) break;
    MatrixXd matrix = MatrixXd::Zero(n + 2, n + 2);
    matrix.topLeftCorner(n, n) = turn.by_state - MatrixXd::Identity(n, n);
    matrix.block(0, n, n, 1) = turn.f;
    matrix.block(0, n + 1, n, 1) = turn.by_parameters.col(k);
    matrix.block(n, 0, 1, n) = surface.hx.transpose();
    matrix(n, n + 1) = surface.hp(k);
    matrix.block(n + 1, 0, 1, n) = surface.rate_x.transpose();
    matrix(n + 1, n + 1) = surface.rate_p(k);
    VectorXd right(n + 2);
    right << x - turn.end, -surface.h, -surface.rate;
    const VectorXd step = solve_with_complete_pivoting(matrix, right);
    const double size = step.lpNorm<Eigen::Infinity>() / (1.0 + x.lpNorm<Eigen::Infinity>());
    const bool stalls = size >= 0.5 * last_step;
    if (stalls && last_step <= good_enough) break;
    if (!std::isfinite(size) || iteration == most_iterations || (stalls && iteration > 5))
      throw ComputationError(fmt::format(
          "{}: Newton's method does not find the orbit in contact by forward integration (last steps {:.1e}, {:.1e}); "
          "compute the label with smaller EPSS, EPSU and more intervals (NTST)",
          source, last_step, size));
    x += step.head(n);
    last += step(n);
    par(k) += step(n + 1);
    last_step = size;
  }
  x = corrected_contact(system, start.contact.field, start.contact.event, x, par, source);
  GrazingOrbit orbit{grazing_point(system, start.contact.field, start.contact.event, start.contact.jump, x, par, source,
                                   start.aftermath),
                     start.segments,
                     turn.durations,
                     start.parameter,
                     {},
                     {},
                     {},
                     par(k) - start.par(k)};
  const GrazingPoint& at = orbit.point;
  const auto onto_p = [&](const MatrixXd& v) -> MatrixXd {
    return v - at.f * (at.section_gradient.transpose() * v / at.a);
  };
  orbit.A = onto_p(turn.by_state);
  orbit.by_parameters = onto_p(turn.by_parameters) - at.f * (surface.rate_p.transpose() / at.a);
  orbit.multipliers = largest_first(orbit.A);
  return orbit;
}

}  // namespace tchat
