#include "orbit/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/levels.hpp"
#include "base/messages.hpp"

namespace tchat {

std::string user_function_name(const HybridSystem& system, int k) {
  const tchat_problem& table = system.table();
  const bool named = table.user_value_names != nullptr && table.user_value_names[k - 1] != nullptr;
  return named ? table.user_value_names[k - 1] : fmt::format("PVLS({})", k);
}

std::optional<Quantity> find_quantity(const HybridSystem& system, const std::string& name) {
  for (int k = 1; k <= system.dimension(); ++k)
    if (name == system.state_name(k) || name == fmt::format("U({})", k)) return Quantity{Quantity::Kind::state, k};
  for (int k = 1; k <= system.table().user_values; ++k)
    if (name == user_function_name(system, k) || name == fmt::format("PVLS({})", k))
      return Quantity{Quantity::Kind::user_function, k};
  for (int k = 1; k <= system.count(FunctionKind::event); ++k)
    if (name == system.function_name(FunctionKind::event, k) || name == fmt::format("h{}", k))
      return Quantity{Quantity::Kind::event, k};
  return std::nullopt;
}

std::string state_in_monitor(const HybridSystem& system, int k) {
  const std::string name = system.state_name(k);
  return name.find_first_of(" \t(),") == std::string::npos ? name : fmt::format("U({})", k);
}

std::string quantity_list(const HybridSystem& system) {
  std::string list;
  for (int k = 1; k <= system.dimension(); ++k) list += (k > 1 ? ", " : "") + system.state_name(k);
  for (int k = 1; k <= system.table().user_values; ++k) list += ", " + user_function_name(system, k);
  if (system.count(FunctionKind::event) > 0)
    list += fmt::format(", h1{}", system.count(FunctionKind::event) > 1
                                      ? fmt::format(" to h{}", system.count(FunctionKind::event))
                                      : "");
  return list;
}

Quantity conserved_quantity(const HybridSystem& system, const std::string& name) {
  if (const std::optional<Quantity> quantity = find_quantity(system, name)) return *quantity;
  throw UserError(fmt::format("CONSERVED = {}: problem {} has no function of that name; it has {}", name, system.name(),
                              quantity_list(system)));
}

QuantityFunction::QuantityFunction(const HybridSystem& system, Quantity quantity, std::vector<int> active)
    : system_(&system), quantity_(quantity), active_(std::move(active)) {
  if (quantity_.kind != Quantity::Kind::user_function) return;
  values_.resize(static_cast<std::size_t>(system.table().user_values));
  state_.resize(static_cast<std::size_t>(system.dimension()));
  par_.resize(static_cast<std::size_t>(system.layout().room()));
}

double QuantityFunction::value(const double* x, const double* par) const {
  switch (quantity_.kind) {
    case Quantity::Kind::state:
      return system_->unit_of(quantity_.index) * x[quantity_.index - 1];
    case Quantity::Kind::event:
      return system_->event(quantity_.index, x, par);
    default:
      system_->table().user_value(system_->table().self, x, par, values_.data());
      return values_[static_cast<std::size_t>(quantity_.index - 1)];
  }
}

double QuantityFunction::first(const double* x, const double* par, double* by_state, double* by_parameter) const {
  const int n = system_->dimension();
  if (quantity_.kind == Quantity::Kind::event) {
    double h = 0.0;
    system_->first(FunctionKind::event, quantity_.index, x, par, active_, &h, by_state, by_parameter);
    return h;
  }
  std::fill_n(by_state, n, 0.0);
  std::fill_n(by_parameter, active_.size(), 0.0);
  if (quantity_.kind == Quantity::Kind::state) {
    by_state[quantity_.index - 1] = system_->unit_of(quantity_.index);
    return value(x, par);
  }
  std::copy_n(x, n, state_.begin());
  std::copy_n(par, par_.size(), par_.begin());
  for (int a = 0; a < n; ++a)
    by_state[a] = by_difference(state_[static_cast<std::size_t>(a)], state_.data(), par_.data());
  for (std::size_t k = 0; k < active_.size(); ++k)
    by_parameter[k] = static_cast<std::size_t>(active_[k]) > par_.size()  // none that a function of the problem reads
                          ? 0.0
                          : by_difference(par_[static_cast<std::size_t>(active_[k] - 1)], state_.data(), par_.data());
  return value(x, par);
}

/// A function may change on the scale of a small variable itself: where formulas of two orders differ much, with a step
/// that is small against it, unless rounding is more than that then.
double QuantityFunction::by_difference(double& variable, const double* x, const double* par) const {
  constexpr double much = level::visible;  // the error of the better one is about the square
  constexpr double rounding = std::numeric_limits<double>::epsilon();
  const double here = variable;
  struct Difference {
    double derivative, uncertainty;
  };
  const auto with_step = [&](double step) {
    const auto at = [&](double steps) {
      variable = here + steps * step;
      return value(x, par);
    };
    const double near = at(1.0) - at(-1.0);
    const double far = at(2.0) - at(-2.0);
    const double size = std::abs(at(2.0)) + std::abs(at(-2.0));
    variable = here;
    const double derivative = (8.0 * near - far) / (12.0 * step);
    return Difference{derivative, std::abs(derivative - near / (2.0 * step)) + rounding * size / step};
  };
  const Difference usual = with_step(1e-3 * (1.0 + std::abs(here)));
  if (usual.uncertainty <= much * std::abs(usual.derivative) || here == 0.0) return usual.derivative;
  const Difference small = with_step(1e-3 * std::abs(here));
  return small.uncertainty < usual.uncertainty || !std::isfinite(usual.uncertainty) ? small.derivative
                                                                                    : usual.derivative;
}

}  // namespace tchat
