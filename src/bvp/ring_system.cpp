#include "bvp/ring_system.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bvp/evaluation_failure.hpp"

namespace tchat {

void RingSystem::coupling_pattern(int s, CouplingPattern& pattern) const {
  const int conditions = end_conditions(s);
  pattern.end(0, conditions, s);
  pattern.globals(0, conditions);
  pattern.start_components(conditions, (s + 1) % segments());
  pattern.end(conditions, dimension(), s);
  pattern.globals(conditions, dimension());
}

void RingSystem::coupling_values(int s, const Orbit& x, double* values) const {
  const double* par = x.par.data();
  end_values(s, x.end(s), par, values);
  double* connection = values + end_conditions(s);
  system().value(FunctionKind::jump, signature()[static_cast<std::size_t>(s)].jump, x.end(s), par, connection);
  const double* next = x.start((s + 1) % segments());
  for (int a = 0; a < dimension(); ++a) connection[a] = next[a] - connection[a];
}

double* RingSystem::coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const {
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

  system().first(FunctionKind::jump, signature()[static_cast<std::size_t>(s)].jump, x.end(s), par, free_parameters(),
                 value_.data(), by_state_.data(), by_parameter_.data());
  const double* next = x.start((s + 1) % segments());
  for (int a = 0; a < n; ++a) values[conditions + a] = next[a] - value_[static_cast<std::size_t>(a)];
  entries = std::fill_n(entries, n, 1.0);
  put(by_state_, n, n, -1.0);
  put(by_parameter_, n, q, -1.0);
  return entries;
}

std::string RingSystem::coupling_name(int s, int r) const {
  if (r < end_conditions(s)) return end_condition_name(s, r);
  const int jump = signature()[static_cast<std::size_t>(s)].jump;
  return fmt::format("{} at the start of segment {} minus jump {} ({}) of the end of segment {}",
                     system().state_name(r - end_conditions(s) + 1), (s + 1) % segments() + 1, jump,
                     system().function_name(FunctionKind::jump, jump), s + 1);
}

std::string RingSystem::coupling_failure(int s, const Orbit& x) const {
  const IndexVector& v = signature()[static_cast<std::size_t>(s)];
  const double* par = x.par.data();
  const std::string event =
      has_event(s) ? function_failure(*this, FunctionKind::event, v.event, s, 1.0, x.end(s), par) : "";
  return !event.empty() ? event : function_failure(*this, FunctionKind::jump, v.jump, s, 1.0, x.end(s), par);
}

}  // namespace tchat
