#include "maps/grazing_orbit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include "base/user_error.hpp"
#include "linear/dense_matrix.hpp"
#include "model/event_at.hpp"
#include "motion/orbit_flow.hpp"
#include "orbit/ring_system.hpp"

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

/// Newton's method on x*, the last duration and one parameter.
class ContactSearch {
 public:
  ContactSearch(const HybridSystem& system, const ContactTurn& start, const std::string& source)
      : system_(system),
        start_(start),
        source_(source),
        map_(system, start),
        parameters_(all_parameters(system)),
        surface_(system.dimension(), system.parameters()),
        x_(start.x),
        par_(start.par),
        last_(start.durations.back()) {}

  GrazingOrbit run() {
    converge();
    x_ = corrected_contact(system_, start_.contact.field, start_.contact.event, x_, par_, source_);
    GrazingOrbit orbit{grazing_point(system_, start_.contact.field, start_.contact.event, start_.contact.jump, x_, par_,
                                     source_, start_.aftermath),
                       start_.segments,
                       turn_.durations,
                       start_.parameter,
                       {},
                       {},
                       {},
                       par_(free()) - start_.par(free())};
    const GrazingPoint& at = orbit.point;
    const auto onto_p = [&](const MatrixXd& v) -> MatrixXd { return project_along_flow(at.f, at.section_gradient, v); };
    orbit.A = onto_p(turn_.by_state);
    orbit.by_parameters = onto_p(turn_.by_parameters) - at.f * (surface_.rate_p.transpose() / at.a);
    orbit.multipliers = largest_first(orbit.A);
    return orbit;
  }

 private:
  Eigen::Index free() const { return start_.parameter - 1; }

  void converge() {
    constexpr int most_iterations = 20;
    constexpr double converged = 1e-13;
    constexpr double good_enough = 1e-9;  // where errors of the integration end Newton's method
    double before = INFINITY;
    for (int iteration = 0;; ++iteration) {
      evaluate();
      if (before <= converged) return;
      const VectorXd step = newton_step();
      const double size = step.lpNorm<Eigen::Infinity>() / (1.0 + x_.lpNorm<Eigen::Infinity>());
      const bool stalls = size >= 0.5 * before;
      if (stalls && before <= good_enough) return;
      if (!std::isfinite(size) || iteration == most_iterations || (stalls && iteration > 5))
        throw ComputationError(fmt::format(
            "{}: Newton's method does not find the orbit in contact by forward integration (last steps {:.1e}, "
            "{:.1e}); compute the label with smaller EPSS, EPSU and more intervals (NTST)",
            source_, before, size));
      x_ += step.head(x_.size());
      last_ += step(x_.size());
      par_(free()) += step(x_.size() + 1);
      before = size;
    }
  }

  void evaluate() {
    turn_ = map_.at(x_, last_, par_);
    if (!turn_.message.empty())
      throw ComputationError(
          fmt::format("{}: the orbit cannot be followed by forward integration: {}", source_, turn_.message));
    surface_.evaluate(system_, start_.contact, x_.data(), par_.data(), parameters_);
  }

  VectorXd newton_step() const {
    const Eigen::Index n = x_.size(), k = free();
    MatrixXd matrix = MatrixXd::Zero(n + 2, n + 2);
    matrix.topLeftCorner(n, n) = turn_.by_state - MatrixXd::Identity(n, n);
    matrix.block(0, n, n, 1) = turn_.f;
    matrix.block(0, n + 1, n, 1) = turn_.by_parameters.col(k);
    matrix.block(n, 0, 1, n) = surface_.hx.transpose();
    matrix(n, n + 1) = surface_.hp(k);
    matrix.block(n + 1, 0, 1, n) = surface_.rate_x.transpose();
    matrix(n + 1, n + 1) = surface_.rate_p(k);
    VectorXd right(n + 2);
    right << x_ - turn_.end, -surface_.h, -surface_.rate;
    return solve_with_complete_pivoting(matrix, right);
  }

  const HybridSystem& system_;
  const ContactTurn& start_;
  const std::string& source_;
  TurnMap map_;
  std::vector<int> parameters_;
  SurfaceRate surface_;
  VectorXd x_;
  ParameterVector par_;
  double last_;  // duration of the last segment
  Turn turn_;
};

}  // namespace

double GrazingOrbit::period() const { return std::accumulate(durations.begin(), durations.end(), 0.0); }

GrazingOrbit find_grazing_orbit(const HybridSystem& system, const ContactTurn& turn, const std::string& source) {
  return ContactSearch(system, turn, source).run();
}

}  // namespace tchat
