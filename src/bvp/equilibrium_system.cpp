#include "bvp/equilibrium_system.hpp"

#include <fmt/format.h>

namespace tchat {

EquilibriumSystem::EquilibriumSystem(const HybridSystem& system, Signature signature, std::vector<int> free_parameters)
    : DefiningSystem(system, std::move(signature), std::move(free_parameters)),
      by_state_(static_cast<std::size_t>(dimension() * dimension())),
      by_parameter_(static_cast<std::size_t>(dimension() * free_count())) {}

void EquilibriumSystem::coupling_pattern(int s, CouplingPattern& pattern) const {
  pattern.duration(0, 1, s);
  pattern.end(1, dimension(), s);
  pattern.globals(1, dimension());
}

void EquilibriumSystem::coupling_values(int s, const Orbit& x, double* values) const {
  *values++ = x.duration(s);
  system().value(FunctionKind::field, field(), x.end(s), x.par.data(), values);
}

double* EquilibriumSystem::coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const {
  const int n = dimension();
  *values++ = x.duration(s);
  *entries++ = 1.0;
  system().first(FunctionKind::field, field(), x.end(s), x.par.data(), free_parameters(), values, by_state_.data(),
                 by_parameter_.data());
  const auto put = [&](const std::vector<double>& by_columns, int columns) {
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < columns; ++b) *entries++ = by_columns[static_cast<std::size_t>(b * n + a)];
  };
  put(by_state_, n);
  put(by_parameter_, free_count());
  return entries;
}

std::string EquilibriumSystem::coupling_name(int, int r) const {
  return r == 0 ? "the duration, which is 0" : fmt::format("rate of {}", system().state_name(r));
}

std::string EquilibriumSystem::coupling_failure(int s, const Orbit& x) const {
  const std::string name = system().function_name(FunctionKind::field, field());
  std::vector<double> values(static_cast<std::size_t>(coupling_rows(s)));
  std::vector<double> entries(1 + by_state_.size() + by_parameter_.size());
  coupling_derivatives(s, x, values.data(), entries.data());
  for (int r = 0; r < coupling_rows(s); ++r)
    if (!all_finite(&values[static_cast<std::size_t>(r)], 1))
      return fmt::format("the {} by field {} ({}) is not finite", coupling_name(s, r), field(), name);
  const bool finite = all_finite(entries.data(), static_cast<int>(entries.size()));
  return finite ? "" : fmt::format("a derivative of field {} ({}) is not finite", field(), name);
}

}  // namespace tchat
