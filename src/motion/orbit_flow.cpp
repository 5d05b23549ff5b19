#include "motion/orbit_flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "linear/dense_matrix.hpp"
#include "model/events.hpp"
#include "model/function_values.hpp"
#include "model/parameter_vector.hpp"
#include "model/scales.hpp"
#include "motion/cvodes_flow.hpp"
#include "motion/sparse_solver.hpp"
#include "motion/tangent_flow.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

void require(bool condition, const std::string& what) {
  if (!condition) throw UserError("integration: " + what);
}

void require_index(const HybridSystem& system, FunctionKind kind, int index, const char* what) {
  const int count = system.count(kind);
  require(index >= 1 && index <= count,
          fmt::format("{} {} does not exist, {} has 1..{}.", what, index, system.name(), count));
}

VectorXd checked_parameters(const HybridSystem& system, int field, const VectorXd& x0, const VectorXd& par,
                            const FlowOptions& options) {
  require_index(system, FunctionKind::field, field, "field");
  require(x0.size() == system.dimension(),
          fmt::format("the state has {} entries, {} has dimension {}.", x0.size(), system.name(), system.dimension()));
  require(x0.allFinite(), "the state at the start is not finite.");
  for (const int k : options.active)
    require(k >= 1 && k < system.layout().first_duration(),
            fmt::format("PAR({}) is no parameter, allowed are 1..{}.", k, system.layout().first_duration() - 1));
  return full_parameters(system, par);
}

/// Of many states, few of which others depend on, tangents along a flow of states alone are quicker than CVODES'
/// sensitivities.
bool has_few_entries(const HybridSystem& system, int field, const VectorXd& x0, const VectorXd& par) {
  if (system.dimension() < least_sparse_dimension) return false;
  VectorXd f(x0.size());
  MatrixXd f_x(x0.size(), x0.size());
  system.first(FunctionKind::field, field, x0.data(), par.data(), {}, f.data(), f_x.data(), nullptr);
  return is_sparse(f_x);
}

SegmentFlow result_at(const CvodesFlow& flow, FlowStatus status) {
  SegmentFlow result;
  result.status = status;
  if (status == FlowStatus::failed) result.message = flow.message();
  result.duration = flow.time();
  result.end_state = flow.state();
  result.jacobian = flow.jacobian();
  result.parameter_derivative = flow.parameter_derivative();
  return result;
}

}  // namespace

VectorXd full_parameters(const HybridSystem& system, const VectorXd& par) {
  require(par.size() >= system.parameters(),
          fmt::format("{} parameter values given, {} needs {}.", par.size(), system.name(), system.parameters()));
  require(par.allFinite(), "a parameter value is not finite.");
  VectorXd full = VectorXd::Zero(std::max<Eigen::Index>(par.size(), system.layout().room()));
  full.head(par.size()) = par;
  return full;
}

SegmentFlow integrate_segment(const HybridSystem& system, const IndexVector& index, const VectorXd& x0,
                              const VectorXd& par_given, const FlowOptions& options) {
  const VectorXd par = checked_parameters(system, index.field, x0, par_given, options);
  require_index(system, FunctionKind::event, index.event, "event function");
  FlowOptions of_flow = options;
  const bool is_by_tangents =
      options.variational && options.active.empty() && has_few_entries(system, index.field, x0, par);
  of_flow.variational = options.variational && !is_by_tangents;
  CvodesFlow flow(system, index.field, x0, par, of_flow);
  flow.watch({index.event});
  std::optional<TangentFlow> tangent;
  MatrixXd jacobian;
  if (is_by_tangents) {
    jacobian = MatrixXd::Identity(x0.size(), x0.size());
    tangent.emplace(system, par, options.relative_tolerance).use_sizes(options.sizes);
    flow.on_piece(
        [&](double from, double to) { return tangent->carry(jacobian, index.field, flow.dense_output(), from, to); });
  }
  const Progress progress = flow.advance(options.max_duration);
  if (progress == Progress::failed) return result_at(flow, FlowStatus::failed);
  SegmentFlow result =
      result_at(flow, progress == Progress::root ? FlowStatus::event_reached : FlowStatus::time_reached);
  if (is_by_tangents) {
    result.jacobian = jacobian;
    result.parameter_derivative.resize(x0.size(), 0);
  }
  if (progress == Progress::stopped) {
    result.status = FlowStatus::failed;
    result.message = no_finite_derivatives(system, FunctionKind::field, index.field, result.end_state);
    return result;
  }
  result.event_velocity = event_at(system, index.event, index.field, result.end_state.data(), par.data()).rate();
  if (result.status == FlowStatus::time_reached)
    result.message = fmt::format("{} did not fall to zero within time {:g}",
                                 system.function_name(FunctionKind::event, index.event), options.max_duration);
  return result;
}

SegmentFlow integrate_to_instant(const HybridSystem& system, const IndexVector& index, const VectorXd& x0,
                                 const VectorXd& par_given, const FlowOptions& options) {
  constexpr int most_steps = 8;
  const VectorXd par = full_parameters(system, par_given);
  double time = 0.0;
  for (int step = 0; step < most_steps; ++step) {
    SegmentFlow flow = integrate_for(system, index.field, x0, par, time, options);
    if (flow.status == FlowStatus::failed) return flow;
    const EventAt at = event_at(system, index.event, index.field, flow.end_state.data(), par.data());
    const double change = -at.h / at.rate();
    const double next = time + change;
    flow.event_velocity = at.rate();
    flow.status = FlowStatus::event_reached;
    if (next == time || (step > 1 && std::abs(change) <= std::numeric_limits<double>::epsilon() * std::abs(time)))
      return flow;
    if (!std::isfinite(change) || std::abs(next) > options.max_duration) break;
    time = next;
  }
  SegmentFlow none;
  none.message = fmt::format("{} has no zero next to the start of the segment",
                             system.function_name(FunctionKind::event, index.event));
  return none;
}

SegmentFlow integrate_for(const HybridSystem& system, int field, const VectorXd& x0, const VectorXd& par_given,
                          double duration, const FlowOptions& options) {
  const VectorXd par = checked_parameters(system, field, x0, par_given, options);
  require(std::isfinite(duration), "the duration is not finite.");
  CvodesFlow flow(system, field, x0, par, options);
  const Progress progress = flow.advance(duration);
  return result_at(flow, progress == Progress::failed ? FlowStatus::failed : FlowStatus::time_reached);
}

namespace {

using Eigen::VectorXcd;

/// Values and derivatives at a terminal point: f, h_x, h_p, g, g_x, g_p with h_p, g_p by the active parameters.
struct EndPoint {
  VectorXd f, g;
  RowVectorXd hx, hp;
  MatrixXd gx, gp;
  double velocity = 0.0;  // h_x f

  EndPoint(const HybridSystem& system, const IndexVector& index, const VectorXd& x, const VectorXd& par,
           const std::vector<int>& active)
      : f(x.size()), g(x.size()), hx(x.size()), hp(active.size()), gx(x.size(), x.size()), gp(x.size(), active.size()) {
    double h = 0.0;
    system.value(FunctionKind::field, index.field, x.data(), par.data(), f.data());
    system.first(FunctionKind::event, index.event, x.data(), par.data(), active, &h, hx.data(), hp.data());
    system.first(FunctionKind::jump, index.jump, x.data(), par.data(), active, g.data(), gx.data(), gp.data());
    velocity = hx.dot(f);
  }

  /// False at grazing to rounding, and where a function cannot be evaluated.
  bool is_transversal() const { return std::abs(velocity) > level::rounding * hx.cwiseAbs().dot(f.cwiseAbs()); }
};

VectorXcd sorted_eigenvalues(const MatrixXd& m) {
  if (!m.allFinite()) return VectorXcd::Constant(m.rows(), NAN);
  VectorXcd values = eigenvalues(m);
  std::sort(values.begin(), values.end(), [](const auto& a, const auto& b) {
    const double difference = std::abs(a) - std::abs(b);
    return difference != 0.0 ? difference > 0.0 : a.imag() > b.imag();
  });
  return values;
}

/// Adds one segment to a return map that has come to x; moves x to the next start. False with a message on failure.
bool add_segment(const HybridSystem& system, const IndexVector& index, const VectorXd& par, const FlowOptions& options,
                 bool is_instant, VectorXd& x, ReturnMap& map) {
  const std::size_t number = map.segments.size() + 1;
  const SegmentFlow flow = is_instant ? integrate_to_instant(system, index, x, par, options)
                                      : integrate_segment(system, index, x, par, options);
  if (flow.status != FlowStatus::event_reached) {
    map.message = fmt::format("segment {}: {}", number, flow.message);
    return false;
  }
  if (!options.variational) {  // h_x f and functions without derivatives: those of the map with derivatives
    const VectorXd end = jump_at(system, index.jump, flow.end_state.data(), par.data()).image;
    map.segments.push_back({x, flow.end_state, flow.duration, flow.event_velocity, {}, {}});
    map.period += flow.duration;
    x = end;
    return true;
  }
  const EndPoint end(system, index, flow.end_state, par, options.active);
  for (const auto& [kind, number_of] : {std::pair(FunctionKind::event, index.event), {FunctionKind::jump, index.jump}})
    if (!has_finite_derivatives(system, kind, number_of, flow.end_state.data(), par.data())) {
      map.message =
          fmt::format("segment {}: {}", number, no_finite_derivatives(system, kind, number_of, flow.end_state));
      return false;
    }
  if (!end.is_transversal()) {
    map.message = fmt::format("segment {} ends tangentially to the event surface, the map has no derivative", number);
    return false;
  }
  const MatrixXd projection = MatrixXd::Identity(x.size(), x.size()) - end.f * end.hx / end.velocity;
  const MatrixXd segment_derivative = projection * flow.jacobian;
  map.parameter_derivative = end.gx * (projection * flow.parameter_derivative - end.f * end.hp / end.velocity +
                                       segment_derivative * map.parameter_derivative) +
                             end.gp;
  map.derivative = end.gx * segment_derivative * map.derivative;
  map.segments.push_back({x, flow.end_state, flow.duration, end.velocity, flow.jacobian, segment_derivative});
  map.period += flow.duration;
  x = end.g;
  return true;
}

void require_signature(const HybridSystem& system, const Signature& signature) {
  if (signature.empty()) throw UserError("integration: the signature is empty, one index vector at least is needed.");
  for (const IndexVector& index : signature)
    if (index.jump < 1 || index.jump > system.count(FunctionKind::jump))
      throw UserError(fmt::format("integration: jump {} does not exist, {} has 1..{}.", index.jump, system.name(),
                                  system.count(FunctionKind::jump)));
}

}  // namespace

ReturnMap return_map(const HybridSystem& system, const Signature& signature, const VectorXd& x1,
                     const VectorXd& par_given, const FlowOptions& given, const std::vector<bool>& instants) {
  require_signature(system, signature);
  FlowOptions options = given;
  const VectorXd par = full_parameters(system, par_given);

  ReturnMap map;
  map.derivative = MatrixXd::Identity(system.dimension(), system.dimension());
  map.parameter_derivative = MatrixXd::Zero(system.dimension(), static_cast<Eigen::Index>(options.active.size()));
  VectorXd x = x1;
  for (std::size_t s = 0; s < signature.size(); ++s)
    if (!add_segment(system, signature[s], par, options, !instants.empty() && instants[s], x, map)) return map;
  map.end = x;
  if (options.variational) map.multipliers = sorted_eigenvalues(map.derivative);
  map.ok = map.end.allFinite() && map.derivative.allFinite();
  if (!map.ok) map.message = "the last jump cannot be evaluated";
  return map;
}

VectorXd closing_step(const MatrixXd& derivative, const VectorXd& gap, const std::vector<Eigen::Index>& ignorable,
                      const VectorXd& known) {
  const VectorXd sizes = known.unaryExpr(&size_for_tolerance);
  MatrixXd matrix = MatrixXd::Identity(gap.size(), gap.size()) - derivative;
  for (const Eigen::Index k : ignorable) matrix.row(k) = VectorXd::Unit(gap.size(), k).transpose();
  const auto divide = sizes.cwiseInverse().asDiagonal();
  const SingularVectors found = singular_vectors(divide * matrix * sizes.asDiagonal());
  VectorXd along = found.left.transpose() * (divide * gap);
  for (Eigen::Index k = 0; k < along.size(); ++k)
    along(k) = found.sizes(k) <= level::differences * found.sizes(0) ? 0.0 : along(k) / found.sizes(k);
  return sizes.cwiseProduct(found.right * along);
}

PeriodicOrbit shoot(const HybridSystem& system, const Signature& signature, const VectorXd& guess, const VectorXd& par,
                    const ShootingOptions& options) {
  const bool has_sizes = !are_usual(options.flow.sizes);
  const VectorXd sizes = has_sizes ? options.flow.sizes : VectorXd(VectorXd::Ones(guess.size()));
  PeriodicOrbit orbit;
  orbit.start = guess;
  constexpr double next_to_orbit = level::five_digits;
  constexpr Eigen::Index many_states = 24;
  double last_step = INFINITY, step_before = INFINITY;
  FlowOptions flow = options.flow;
  MatrixXd derivative;
  while (true) {
    // Of many states, next to the orbit, as long as steps become ten times smaller, the derivative is that of the first
    // one there; at the orbit it is its own.
    flow.variational = guess.size() < many_states || last_step <= options.tolerance ||
                       !(last_step <= std::min(next_to_orbit, 0.1 * step_before));
    step_before = last_step;
    orbit.map = return_map(system, signature, orbit.start, par, flow, options.instants);
    if (!orbit.map.ok) {
      orbit.message = orbit.map.message;
      return orbit;
    }
    VectorXd residual = orbit.start - orbit.map.end;
    for (const Eigen::Index k : options.ignorable) residual(k) = 0.0;
    orbit.residual = residual.lpNorm<Eigen::Infinity>();
    orbit.converged = last_step <= options.tolerance;
    if (orbit.converged) return orbit;
    if (orbit.iterations == options.max_iterations || !std::isfinite(orbit.residual)) {
      orbit.message = fmt::format("no convergence in {} Newton steps, residual {:.2e}, last step {:.2e}",
                                  orbit.iterations, orbit.residual, last_step);
      return orbit;
    }
    if (flow.variational) derivative = orbit.map.derivative;
    const VectorXd step = closing_step(derivative, -residual, options.ignorable, sizes);
    last_step = step.cwiseQuotient(sizes).lpNorm<Eigen::Infinity>() /
                (1.0 + orbit.start.cwiseQuotient(sizes).lpNorm<Eigen::Infinity>());
    orbit.start += step;
    ++orbit.iterations;
    if (!orbit.start.allFinite()) {
      orbit.message = fmt::format("Newton step {} is not finite: Id - M is singular", orbit.iterations);
      return orbit;
    }
  }
}

}  // namespace tchat
