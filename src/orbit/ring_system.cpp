#include "orbit/ring_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/events.hpp"

namespace tchat {

SurfaceRate::SurfaceRate(int dimension, int free_count)
    : hx(dimension),
      hp(free_count),
      rate_x(dimension),
      rate_p(free_count),
      f_(dimension),
      direction_(Eigen::VectorXd::Zero(dimension + free_count)),
      fx_(dimension, dimension),
      fp_(dimension, free_count) {}

void SurfaceRate::evaluate(const HybridSystem& system, const IndexVector& v, const double* x, const double* par,
                           const std::vector<int>& free_parameters) {
  system.first(FunctionKind::field, v.field, x, par, free_parameters, f_.data(), fx_.data(), fp_.data());
  system.first(FunctionKind::event, v.event, x, par, free_parameters, &h, hx.data(), hp.data());
  // d (h_x f) = h_xx f + h_x f_x: the first part is the second derivative in the direction (f, 0).
  direction_.head(f_.size()) = f_;
  system.second(FunctionKind::event, v.event, x, par, free_parameters, direction_.data(), &rate, rate_x.data(),
                rate_p.data());
  for (Eigen::Index b = 0; b < hx.size(); ++b) rate_x(b) += fx_.col(b).dot(hx);
  for (Eigen::Index k = 0; k < hp.size(); ++k) rate_p(k) += fp_.col(k).dot(hx);
  clear_absent(system, v.field, hx);
  clear_absent(system, v.field, rate_x);
}

namespace {

/// Of the period. A shorter contact takes the mean of h_x f as that of both ends, wrong by T^2 / 12 times its second
/// derivative; in a longer one rounding of h is divided by T. Both are some 1e-10 of h_x f here.
constexpr double short_contact = 3e-6;

bool is_short(const Orbit& x, int s) { return std::abs(x.duration(s)) <= short_contact * std::abs(x.period()); }

}  // namespace

ContactRow::ContactRow(int dimension, int free_count) : start_(dimension, free_count), end_(dimension, free_count) {}

double ContactRow::value(const HybridSystem& system, const IndexVector& v, const Orbit& x, int s,
                         const std::vector<int>& free_parameters) {
  const double* par = x.par.data();
  if (!is_short(x, s))
    return (system.event(v.event, x.end(s), par) - system.event(v.event, x.start(s), par)) / x.duration(s);
  start_.evaluate(system, v, x.start(s), par, free_parameters);
  end_.evaluate(system, v, x.end(s), par, free_parameters);
  return 0.5 * (start_.rate + end_.rate);
}

double* ContactRow::derivatives(const HybridSystem& system, const IndexVector& v, const Orbit& x, int s,
                                const std::vector<int>& free_parameters, double& value, double* entries) {
  const double* par = x.par.data();
  const auto put = [&entries](double first, const Eigen::VectorXd& a, double second, const Eigen::VectorXd& b) {
    for (Eigen::Index k = 0; k < a.size(); ++k) *entries++ = first * a(k) + second * b(k);
  };
  const auto put_one = [&](double factor, const Eigen::VectorXd& a) { put(factor, a, 0.0, a); };
  if (is_short(x, s)) {
    start_.evaluate(system, v, x.start(s), par, free_parameters);
    end_.evaluate(system, v, x.end(s), par, free_parameters);
    value = 0.5 * (start_.rate + end_.rate);
    put_one(0.5, start_.rate_x);
    put_one(0.5, end_.rate_x);
    *entries++ = 0.0;
    put(0.5, start_.rate_p, 0.5, end_.rate_p);
    return entries;
  }
  const auto evaluate = [&](SurfaceRate& at, const double* state) {
    system.first(FunctionKind::event, v.event, state, par, free_parameters, &at.h, at.hx.data(), at.hp.data());
  };
  evaluate(start_, x.start(s));
  evaluate(end_, x.end(s));
  const double inverse = 1.0 / x.duration(s);
  value = (end_.h - start_.h) * inverse;
  put_one(-inverse, start_.hx);
  put_one(inverse, end_.hx);
  *entries++ = -value * inverse;
  put(-inverse, start_.hp, inverse, end_.hp);
  return entries;
}

RingSystem::RingSystem(const HybridSystem& system, Signature signature, std::vector<int> free_parameters)
    : DefiningSystem(system, std::move(signature), std::move(free_parameters)),
      contact_row_(dimension(), free_count()),
      units_(static_cast<std::size_t>(segments())) {}

double RingSystem::unit_of_end(int s, int r) const {
  const std::vector<double>& units = units_[static_cast<std::size_t>(s)];
  return units.empty() ? 1.0 : units[static_cast<std::size_t>(r)];
}

void RingSystem::find_units(int s, const Orbit& x) const {
  std::vector<double>& units = units_[static_cast<std::size_t>(s)];
  const int count = end_conditions(s);
  if (!units.empty() || count == 0) return;
  std::vector<double> values(static_cast<std::size_t>(count));
  Eigen::MatrixXd by_state(count, dimension()), by_parameter(count, free_count());
  end_derivatives(s, x.end(s), x.par.data(), values.data(), by_state.data(), by_parameter.data());
  for (int r = 0; r < count; ++r) {
    const double largest = by_state.row(r).cwiseAbs().maxCoeff();
    const bool has_size = largest > 0.0 && std::isfinite(largest);
    units.push_back(has_size ? std::exp2(std::round(std::log2(largest))) : 1.0);
  }
}

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
  find_units(s, x);
  if (is_divided(s, x))
    values[0] = contact_row_.value(system(), v, x, s, free_parameters());
  else
    end_values(s, x.end(s), par, values);
  for (int r = 0; r < end_conditions(s); ++r) values[r] /= unit_of_end(s, r);
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
  find_units(s, x);
  if (is_divided(s, x)) {
    double* const begin = entries;
    entries = contact_row_.derivatives(system(), signature()[static_cast<std::size_t>(s)], x, s, free_parameters(),
                                       values[0], entries);
    std::for_each(begin, entries, [unit = unit_of_end(s, 0)](double& entry) { entry /= unit; });
  } else {
    const int count = end_conditions(s);
    end_derivatives(s, x.end(s), x.par.data(), values, by_state_.data(), by_parameter_.data());
    for (int k = 0; k < count * dimension(); ++k) by_state_[static_cast<std::size_t>(k)] /= unit_of_end(s, k % count);
    for (int k = 0; k < count * free_count(); ++k)
      by_parameter_[static_cast<std::size_t>(k)] /= unit_of_end(s, k % count);
    if (is_contact(s)) entries = std::fill_n(entries, dimension(), 0.0);  // by the start
    put(by_state_, count, dimension(), 1.0, entries);
    if (is_contact(s)) *entries++ = 0.0;  // by the duration
    put(by_parameter_, count, free_count(), 1.0, entries);
  }
  for (int r = 0; r < end_conditions(s); ++r) values[r] /= unit_of_end(s, r);
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

UnfoldedSystem::UnfoldedSystem(std::unique_ptr<DefiningSystem> ring)
    : DefiningSystem(ring->system(), ring->signature(), ring->free_parameters()), ring_(std::move(ring)) {
  std::ptrdiff_t rows = 0;
  for (int s = 0; s < segments(); ++s) {
    first_rows_.push_back(rows);
    rows += ring_->coupling_rows(s);
  }
  direction_.assign(static_cast<std::size_t>(rows), 0.0);
}

void UnfoldedSystem::coupling_pattern(int s, CouplingPattern& pattern) const {
  ring_->coupling_pattern(s, pattern);
  pattern.global(0, coupling_rows(s), free_count() - 1);
}

void UnfoldedSystem::add(int s, const Orbit& x, double* values) const {
  const double b = x.par(layout().unfolding(segments()) - 1);
  for (int r = 0; r < coupling_rows(s); ++r) values[r] += b * direction_of(s)[r];
}

void UnfoldedSystem::coupling_values(int s, const Orbit& x, double* values) const {
  ring_->coupling_values(s, x, values);
  add(s, x, values);
}

double* UnfoldedSystem::coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const {
  entries = ring_->coupling_derivatives(s, x, values, entries);
  add(s, x, values);
  return std::copy_n(direction_of(s), coupling_rows(s), entries);
}

}  // namespace tchat
