#include "model/contact_segment.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "model/event_at.hpp"
#include "model/parameter_vector.hpp"

namespace tchat {

namespace {

constexpr double rounding = 1e-10;  // of states and event functions, after Newton's method

ParameterVector generic_parameters(const HybridSystem& system) {
  ParameterVector par(system.layout());
  for (int i = 0; i < system.parameters(); ++i) par(i) = 0.37 + 0.11 * i;
  return par;
}

/// A state of the field's mode with h = 0, by Newton's method along the gradient from a generic one.
std::optional<Eigen::VectorXd> state_on_surface(const HybridSystem& system, int event, int field,
                                                const ParameterVector& par, int trial) {
  constexpr int most_iterations = 50;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(system.dimension());
  for (int i = 0; i < system.dimension_of(field); ++i) x(i) = std::sin(1.3 + i + 2.1 * trial);
  for (int k = 0; k < most_iterations; ++k) {
    const EventAt at = event_at(system, event, field, x.data(), par.data());
    const double square = at.gradient.squaredNorm();
    if (!std::isfinite(at.h) || !std::isfinite(square) || square == 0.0) return std::nullopt;
    if (std::abs(at.h) <= 1e-3 * rounding * at.scale(x.data())) return x;
    x -= at.h / square * at.gradient;
  }
  return std::nullopt;
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
