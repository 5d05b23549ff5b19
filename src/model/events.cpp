#include "model/events.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "base/levels.hpp"
#include "model/parameter_vector.hpp"
#include "model/scales.hpp"

namespace tchat {

Eigen::RowVectorXd change_of_time(const Eigen::VectorXd& f, const Eigen::VectorXd& gradient, const Eigen::MatrixXd& v) {
  return -(gradient.transpose() * v) / gradient.dot(f);
}

Eigen::MatrixXd project_along_flow(const Eigen::VectorXd& f, const Eigen::VectorXd& gradient,
                                   const Eigen::MatrixXd& v) {
  return v + f * change_of_time(f, gradient, v);
}

double surface_scale(const Eigen::VectorXd& gradient, const double* x, const Eigen::VectorXd& sizes) {
  const Eigen::Map<const Eigen::VectorXd> state(x, gradient.size());
  if (sizes.size() == 0) return gradient.norm() * (1.0 + state.norm());
  return gradient.cwiseAbs().dot(state.cwiseAbs().cwiseMax(sizes));
}

double EventAt::rate_scale(const Eigen::VectorXd& sizes) const {
  const Eigen::VectorXd counted = sizes.unaryExpr(&size_for_tolerance);
  return gradient.cwiseAbs().dot(counted) * f.cwiseQuotient(counted).cwiseAbs().maxCoeff();
}

EventAt event_at(const HybridSystem& system, int event, const double* x, const double* par) {
  EventAt at{0.0, Eigen::VectorXd(system.dimension()), {}};
  system.first(FunctionKind::event, event, x, par, {}, &at.h, at.gradient.data(), nullptr);
  return at;
}

EventAt event_at(const HybridSystem& system, int event, int field, const double* x, const double* par) {
  EventAt at = event_at(system, event, x, par);
  clear_absent(system, field, at.gradient);
  at.f.resize(system.dimension());
  system.value(FunctionKind::field, field, x, par, at.f.data());
  return at;
}

std::optional<Eigen::VectorXd> onto_surface(const HybridSystem& system, int event, int field, Eigen::VectorXd x,
                                            const double* par, const Eigen::VectorXd& given) {
  constexpr int most_steps = 50;
  const Eigen::VectorXd sizes =
      given.size() == 0 ? Eigen::VectorXd::Ones(x.size()).eval() : given.unaryExpr(&size_for_tolerance).eval();
  double last = INFINITY;
  for (int k = 0; k < most_steps; ++k) {
    EventAt at = event_at(system, event, x.data(), par);
    if (field != no_function) clear_absent(system, field, at.gradient);
    const Eigen::VectorXd normal = at.gradient.cwiseProduct(sizes);
    const double square = normal.squaredNorm();
    const double now = std::abs(at.h);
    if (!std::isfinite(now) || !std::isfinite(square) || !(square > 0.0)) return std::nullopt;
    if (now == 0.0 || (now >= last && now <= level::rounding_of_sums * at.scale(x.data(), sizes))) return x;
    x -= sizes.cwiseProduct(normal) * (at.h / square);
    last = now;
  }
  return std::nullopt;
}

Eigen::VectorXd rate_gradient(const HybridSystem& system, const EventAt& at, int event, int field, const double* x,
                              const double* par) {
  const int n = system.dimension();
  Eigen::VectorXd f(n), gradient(n);
  Eigen::MatrixXd fx(n, n);
  double rate = 0.0;
  system.first(FunctionKind::field, field, x, par, {}, f.data(), fx.data(), nullptr);
  // h_xx f is the second derivative of h in the direction f.
  system.second(FunctionKind::event, event, x, par, {}, at.f.data(), &rate, gradient.data(), nullptr);
  gradient += fx.transpose() * at.gradient;
  clear_absent(system, field, gradient);
  return gradient;
}

JumpAt jump_at(const HybridSystem& system, int jump, const double* x, const double* par) {
  const int n = system.dimension();
  JumpAt at{Eigen::VectorXd(n), Eigen::MatrixXd(n, n)};
  system.first(FunctionKind::jump, jump, x, par, {}, at.image.data(), at.derivative.data(), nullptr);
  return at;
}

namespace {

/// The first `states` states; the others are zero.
bool leaves_states(const HybridSystem& system, int k, int states) {
  const int n = system.dimension();
  ParameterVector par(system.layout());
  for (int i = 0; i < system.parameters(); ++i) par(i) = 0.37 + 0.11 * i;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd g(n);
  for (int trial = 0; trial < 2; ++trial) {
    for (int i = 0; i < states; ++i) x(i) = std::sin(1.3 + i + 2.1 * trial);
    system.value(FunctionKind::jump, k, x.data(), par.data(), g.data());
    if (!((g - x).cwiseAbs().maxCoeff() <= level::negligible)) return false;
  }
  return true;
}

}  // namespace

bool is_identity_jump(const HybridSystem& system, int k) { return leaves_states(system, k, system.dimension()); }

bool is_identity_jump(const HybridSystem& system, const IndexVector& segment) {
  return leaves_states(system, segment.jump, system.dimension_of(segment.field));
}

int first_identity_jump(const HybridSystem& system, int field) {
  for (int k = 1; k <= system.count(FunctionKind::jump); ++k)
    if (is_identity_jump(system, {field, no_function, k})) return k;
  return no_function;
}

void clear_absent(const HybridSystem& system, int field, Eigen::VectorXd& states) {
  states.tail(system.dimension() - system.dimension_of(field)).setZero();
}

std::string mode_fault(const HybridSystem& system, const IndexVector& segment, int next) {
  if (!system.has_modes()) return "";
  const int states = system.dimension_of(next);
  const std::string name = system.function_name(FunctionKind::field, next);
  const int set = segment.jump == no_function ? 0 : system.table().jump_dimensions[segment.jump - 1];
  if (set == states) return "";
  if (segment.jump == no_function || is_identity_jump(system, segment)) {
    if (system.dimension_of(segment.field) <= states) return "";
    return fmt::format(
        "the identity cannot lead from field {} ({}) with {} states to field {} ({}) with {}; use a jump "
        "that sets {} states (dimension_after, or `jump NAME to {}`)",
        segment.field, system.function_name(FunctionKind::field, segment.field), system.dimension_of(segment.field),
        next, name, states, states, name);
  }
  return fmt::format(
      "jump {} ({}) sets {} states, and field {} ({}) after it has {}; use a jump that sets {} "
      "(dimension_after, or `jump NAME to {}`)",
      segment.jump, system.function_name(FunctionKind::jump, segment.jump), set, next, name, states, states, name);
}

bool keeps_field(const HybridSystem& system, const IndexVector& v, int field, const double* x, const double* par) {
  const auto next = system.successors(v, x, par).value_or(std::vector<IndexVector>{});
  return std::any_of(next.begin(), next.end(), [&](const IndexVector& w) { return w.field == field; });
}

std::vector<int> relevant_events(const HybridSystem& system, std::span<const IndexVector> following, int field,
                                 const double* x, const double* par) {
  std::set<int> events;
  for (const IndexVector& v : following)
    if (!is_identity_jump(system, v) || !keeps_field(system, v, field, x, par)) events.insert(v.event);
  return {events.begin(), events.end()};
}

SideRate side_rate(const HybridSystem& system, const tchat_sliding& mode, int side, const double* x,
                   const double* par) {
  const EventAt at = event_at(system, mode.surface, side, x, par);
  return {side == mode.plus ? at.rate() : -at.rate(), at.sizes()};
}

bool is_on_surface(const HybridSystem& system, const tchat_sliding& mode, const double* x, const double* par,
                   double tolerance) {
  const EventAt at = event_at(system, mode.surface, x, par);
  return std::abs(at.h) <= tolerance * at.scale(x);
}

namespace {

constexpr double rounding = level::converged;  // of states and event functions, after Newton's method

ParameterVector generic_parameters(const HybridSystem& system) {
  ParameterVector par(system.layout());
  for (int i = 0; i < system.parameters(); ++i) par(i) = 0.37 + 0.11 * i;
  return par;
}

/// A state of the field's mode with h = 0, by Newton's method along the gradient from a generic one.
std::optional<Eigen::VectorXd> state_on_surface(const HybridSystem& system, int event, int field,
                                                const ParameterVector& par, int trial) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(system.dimension());
  for (int i = 0; i < system.dimension_of(field); ++i) x(i) = std::sin(1.3 + i + 2.1 * trial);
  return onto_surface(system, event, field, std::move(x), par.data());
}

/// At one state of the surface of `before`; nothing where it has no finite values.
std::optional<bool> returns_at(const HybridSystem& system, const IndexVector& before, const IndexVector& own,
                               const Eigen::VectorXd& x, const ParameterVector& par) {
  Eigen::VectorXd after(x.size());
  system.value(FunctionKind::jump, before.jump, x.data(), par.data(), after.data());
  const EventAt met = event_at(system, own.event, x.data(), par.data());
  if (!after.allFinite() || !std::isfinite(met.h) || !met.gradient.allFinite()) return std::nullopt;
  const bool stays = (after - x).lpNorm<Eigen::Infinity>() <= rounding * (1.0 + x.lpNorm<Eigen::Infinity>());
  const bool is_same_surface = std::abs(met.h) <= rounding * met.scale(x.data());
  return stays && is_same_surface;
}

}  // namespace

bool is_contact_segment(const HybridSystem& system, const IndexVector& before, const IndexVector& own) {
  constexpr int trials = 6;
  if (before.event == no_function || own.event == no_function || before.jump == no_function) return false;
  if (own.field == before.field) return false;
  const ParameterVector par = generic_parameters(system);
  bool is_found = false;
  for (int trial = 0; trial < trials; ++trial) {
    const std::optional<Eigen::VectorXd> x = state_on_surface(system, before.event, before.field, par, trial);
    const std::optional<bool> returns = x ? returns_at(system, before, own, *x, par) : std::nullopt;
    if (!returns) continue;
    if (!*returns) return false;
    is_found = true;
  }
  return is_found;
}

bool is_contact_segment(const HybridSystem& system, const Signature& signature, int s) {
  const auto m = static_cast<int>(signature.size());
  if (m < 2) return false;
  return is_contact_segment(system, signature[static_cast<std::size_t>((s + m - 1) % m)],
                            signature[static_cast<std::size_t>(s)]);
}

}  // namespace tchat
