#include "bvp/defining_system.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace tchat {

void DefiningSystem::section_gradient(int s, const double* x, const double* par, double* gradient) const {
  double h = 0.0;
  system_.first(FunctionKind::event, signature_[static_cast<std::size_t>(s)].event, x, par, {}, &h, gradient, nullptr);
}

void DefiningSystem::coupling_pattern(int s, CouplingPattern& pattern) const {
  const int conditions = end_conditions(s);
  pattern.end(0, conditions, s);
  pattern.globals(0, conditions);
  pattern.start_components(conditions, (s + 1) % segments());
  pattern.end(conditions, dimension(), s);
  pattern.globals(conditions, dimension());
}

void DefiningSystem::coupling_values(int s, const Orbit& x, double* values) const {
  const double* par = x.par.data();
  end_values(s, x.end(s), par, values);
  double* connection = values + end_conditions(s);
  system_.value(FunctionKind::jump, signature_[static_cast<std::size_t>(s)].jump, x.end(s), par, connection);
  const double* next = x.start((s + 1) % segments());
  for (int a = 0; a < dimension(); ++a) connection[a] = next[a] - connection[a];
}

double* DefiningSystem::coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const {
  const int n = dimension();
  const int q = free_count();
  const int conditions = end_conditions(s);
  const auto rows = static_cast<std::size_t>(std::max(conditions, n));
  value_.resize(rows);
  by_state_.resize(rows * static_cast<std::size_t>(n));
  by_parameter_.resize(rows * static_cast<std::size_t>(q));
  const auto put = [&entries](const std::vector<double>& columns, int row_count, int column_count, double factor) {
    for (int a = 0; a < row_count; ++a)
      for (int b = 0; b < column_count; ++b) *entries++ = factor * columns[static_cast<std::size_t>(b * row_count + a)];
  };
  const double* par = x.par.data();
  end_derivatives(s, x.end(s), par, values, by_state_.data(), by_parameter_.data());
  put(by_state_, conditions, n, 1.0);
  put(by_parameter_, conditions, q, 1.0);

  system_.first(FunctionKind::jump, signature_[static_cast<std::size_t>(s)].jump, x.end(s), par, free_parameters_,
                value_.data(), by_state_.data(), by_parameter_.data());
  const double* next = x.start((s + 1) % segments());
  for (int a = 0; a < n; ++a) values[conditions + a] = next[a] - value_[static_cast<std::size_t>(a)];
  entries = std::fill_n(entries, n, 1.0);
  put(by_state_, n, n, -1.0);
  put(by_parameter_, n, q, -1.0);
  return entries;
}

std::string DefiningSystem::coupling_name(int s, int r) const {
  if (r < end_conditions(s)) return end_condition_name(s, r);
  const int jump = signature_[static_cast<std::size_t>(s)].jump;
  return fmt::format("{} at the start of segment {} minus jump {} ({}) of the end of segment {}",
                     system_.state_name(r - end_conditions(s) + 1), (s + 1) % segments() + 1, jump,
                     system_.function_name(FunctionKind::jump, jump), s + 1);
}

}  // namespace tchat
