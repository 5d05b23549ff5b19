#include "orbit/ring_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "orbit/coupling.hpp"
#include "orbit/evaluation_failure.hpp"

namespace tchat {

RingSystem::RingSystem(const HybridSystem& system, Signature signature, std::vector<int> free_parameters)
    : DefiningSystem(system, std::move(signature), std::move(free_parameters)),
      contact_row_(dimension(), free_count()) {}

bool RingSystem::is_divided(int s, const Orbit& x) const {
  constexpr double long_enough = 0.1;  // of the longest
  if (!is_contact(s)) return false;
  double longest = 0.0;
  for (int k = 0; k < segments(); ++k) {
    if (!is_contact(k)) return true;
    longest = std::max(longest, std::abs(x.duration(k)));
  }
  int kept = 0;
  while (std::abs(x.duration(kept)) < long_enough * longest) ++kept;
  return s != kept;
}

void RingSystem::coupling_pattern(int s, CouplingPattern& pattern) const {
  const int conditions = end_conditions(s);
  if (is_contact(s)) pattern.start(0, conditions, s);
  pattern.end(0, conditions, s);
  if (is_contact(s)) pattern.duration(0, conditions, s);
  pattern.globals(0, conditions);
  target_pattern(s, conditions, pattern);
  pattern.end(conditions, dimension(), s);
  pattern.globals(conditions, dimension());
}

void RingSystem::target_pattern(int s, int row, CouplingPattern& pattern) const {
  pattern.start_components(row, (s + 1) % segments());
}

void RingSystem::target_value(int s, const Orbit& x, double* target) const {
  std::copy_n(x.start((s + 1) % segments()), dimension(), target);
}

double* RingSystem::target_derivatives(int, const Orbit&, double* entries) const {
  return std::fill_n(entries, dimension(), 1.0);
}

std::string RingSystem::target_name(int s) const {
  return fmt::format("at the start of segment {}", (s + 1) % segments() + 1);
}

void RingSystem::coupling_values(int s, const Orbit& x, double* values) const {
  const double* par = x.par.data();
  const IndexVector& v = signature()[static_cast<std::size_t>(s)];
  if (is_divided(s, x))
    values[0] = contact_row_.value(system(), v, x, s, free_parameters());
  else
    end_values(s, x.end(s), par, values);
  double* connection = values + end_conditions(s);
  value_.resize(static_cast<std::size_t>(std::max(end_conditions(s), dimension())));
  system().value(FunctionKind::jump, v.jump, x.end(s), par, value_.data());
  clear_absent(s, value_.data(), 1);
  target_value(s, x, connection);
  for (int a = 0; a < dimension(); ++a) connection[a] -= value_[static_cast<std::size_t>(a)];
}

/// Columns of derivatives, row by row.
void RingSystem::put(const std::vector<double>& columns, int row_count, int column_count, double factor,
                     double*& entries) const {
  for (int a = 0; a < row_count; ++a)
    for (int b = 0; b < column_count; ++b) *entries++ = factor * columns[static_cast<std::size_t>(b * row_count + a)];
}

double* RingSystem::end_rows(int s, const Orbit& x, double* values, double* entries) const {
  if (is_divided(s, x))
    return contact_row_.derivatives(system(), signature()[static_cast<std::size_t>(s)], x, s, free_parameters(),
                                    values[0], entries);
  end_derivatives(s, x.end(s), x.par.data(), values, by_state_.data(), by_parameter_.data());
  if (is_contact(s)) entries = std::fill_n(entries, dimension(), 0.0);  // by the start
  put(by_state_, end_conditions(s), dimension(), 1.0, entries);
  if (is_contact(s)) *entries++ = 0.0;  // by the duration
  put(by_parameter_, end_conditions(s), free_count(), 1.0, entries);
  return entries;
}

double* RingSystem::coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const {
  const int n = dimension();
  const int q = free_count();
  const int conditions = end_conditions(s);
  const auto rows = static_cast<std::size_t>(std::max(conditions, n));
  value_.resize(rows);
  by_state_.resize(rows * static_cast<std::size_t>(n));
  by_parameter_.resize(rows * static_cast<std::size_t>(q));
  entries = end_rows(s, x, values, entries);

  system().first(FunctionKind::jump, signature()[static_cast<std::size_t>(s)].jump, x.end(s), x.par.data(),
                 free_parameters(), value_.data(), by_state_.data(), by_parameter_.data());
  clear_absent(s, value_.data(), 1);
  clear_absent(s, by_state_.data(), n);
  clear_absent(s, by_parameter_.data(), q);
  target_value(s, x, values + conditions);
  for (int a = 0; a < n; ++a) values[conditions + a] -= value_[static_cast<std::size_t>(a)];
  entries = target_derivatives(s, x, entries);
  put(by_state_, n, n, -1.0, entries);
  put(by_parameter_, n, q, -1.0, entries);
  return entries;
}

std::string RingSystem::coupling_name(int s, int r) const {
  if (r < end_conditions(s)) return end_condition_name(s, r);
  const int jump = signature()[static_cast<std::size_t>(s)].jump;
  return fmt::format("{} {} minus jump {} ({}) of the end of segment {}",
                     system().state_name(r - end_conditions(s) + 1), target_name(s), jump,
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
