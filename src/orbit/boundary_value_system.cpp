#include "orbit/boundary_value_system.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "orbit/collocation_rule.hpp"
#include "orbit/defining_system.hpp"

namespace tchat {

namespace {

std::size_t size(int count) { return static_cast<std::size_t>(count); }

}  // namespace

BoundaryValueSystem::BoundaryValueSystem(const HybridSystem& system, Signature signature,
                                         std::vector<int> free_parameters, std::vector<bool> free_durations)
    : DefiningSystem(system, std::move(signature), std::move(free_parameters)),
      free_durations_(std::move(free_durations)),
      starts_(size(dimension() * segments())),
      ends_(starts_.size()),
      by_starts_(size(system.boundary_conditions()) * starts_.size()),
      by_ends_(by_starts_.size()),
      state_(size(dimension())),
      q_(size(integral_conditions())),
      q_by_state_(q_.size() * state_.size()),
      q_by_parameter_(q_.size() * size(segments() + free_count())) {
  for (int s = 0; s < segments(); ++s) active_.push_back(layout().duration(s));
  active_.insert(active_.end(), this->free_parameters().begin(), this->free_parameters().end());
  by_parameter_.resize(size(system.boundary_conditions()) * active_.size());
}

OrbitEnds BoundaryValueSystem::ends_of(const Orbit& x) const {
  for (int s = 0; s < segments(); ++s) {
    std::copy_n(x.start(s), dimension(), &starts_[size(s * dimension())]);
    std::copy_n(x.end(s), dimension(), &ends_[size(s * dimension())]);
  }
  return {segments(), starts_.data(), ends_.data(), x.par.data()};
}

void BoundaryValueSystem::coupling_pattern(int s, CouplingPattern& pattern) const {
  if (kept_rows(s) > 0) pattern.duration(0, 1, s);
  const int count = boundary_rows(s);
  if (count == 0) return;
  for (int t = 0; t < segments(); ++t) {
    pattern.start(kept_rows(s), count, t);
    pattern.end(kept_rows(s), count, t);
    pattern.duration(kept_rows(s), count, t);
  }
  pattern.globals(kept_rows(s), count);
}

void BoundaryValueSystem::coupling_values(int s, const Orbit& x, double* values) const {
  values = std::fill_n(values, kept_rows(s), 0.0);
  if (boundary_rows(s) > 0) system().boundary(ends_of(x), values);
}

double* BoundaryValueSystem::coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const {
  values = std::fill_n(values, kept_rows(s), 0.0);
  entries = std::fill_n(entries, kept_rows(s), 1.0);
  const int count = boundary_rows(s);
  if (count == 0) return entries;
  const int n = dimension();
  system().boundary_first(ends_of(x), active_, values, by_starts_.data(), by_ends_.data(), by_parameter_.data());
  const auto put = [&entries, count](const std::vector<double>& by_columns, int column, int columns) {
    for (int a = 0; a < count; ++a)
      for (int b = 0; b < columns; ++b) *entries++ = by_columns[size((column + b) * count + a)];
  };
  for (int t = 0; t < segments(); ++t) {
    put(by_starts_, t * n, n);
    put(by_ends_, t * n, n);
    put(by_parameter_, t, 1);
  }
  put(by_parameter_, segments(), free_count());
  return entries;
}

std::string BoundaryValueSystem::coupling_name(int s, int r) const {
  if (r < kept_rows(s)) return fmt::format("the duration of segment {}, which is kept", s + 1);
  return fmt::format("boundary condition {}", r - kept_rows(s) + 1);
}

std::string BoundaryValueSystem::coupling_failure(int s, const Orbit& x) const {
  std::vector<double> values(size(coupling_rows(s)));
  std::vector<double> entries(size(boundary_rows(s)) * (2 * starts_.size() + active_.size()) + 1);
  coupling_derivatives(s, x, values.data(), entries.data());
  for (int r = 0; r < coupling_rows(s); ++r)
    if (!all_finite(&values[size(r)], 1))
      return fmt::format("{} is not finite, or asks for more than the {} segment{} of the orbit", coupling_name(s, r),
                         segments(), segments() == 1 ? "" : "s");
  const bool finite = all_finite(entries.data(), static_cast<int>(entries.size()));
  return finite ? "" : "a derivative of the boundary conditions is not finite";
}

void BoundaryValueSystem::integral_values(const Orbit& x, const Orbit&, const CollocationRule& rule,
                                          double* values) const {
  std::fill_n(values, integral_conditions(), 0.0);
  if (integral_conditions() == 0) return;
  for (int s = 0; s < segments(); ++s)
    for_each_gauss_point(x, rule, s, [&](int j, int g, double, double weight) {
      interpolate(x, rule, s, j, g, state_.data());
      system().value(FunctionKind::integrand, s + 1, state_.data(), x.par.data(), q_.data());
      for (std::size_t r = 0; r < q_.size(); ++r) values[r] += x.duration(s) * weight * q_[r];
    });
}

/// With I = T sum w q(sum_i l_i u_i, T, p): by u_i T w l_i q_x, by T sum w q + T w q_T, by p T w q_p.
void BoundaryValueSystem::integral_gradients(const Orbit& x, const Orbit&, const CollocationRule& rule, double* values,
                                             std::span<OrbitVector> rows) const {
  const int n = dimension();
  const std::size_t count = q_.size();
  if (count == 0) return;
  std::fill_n(values, count, 0.0);
  for (OrbitVector& row : rows) row.set_zero();
  for (int s = 0; s < segments(); ++s)
    for_each_gauss_point(x, rule, s, [&](int j, int g, double, double weight) {
      interpolate(x, rule, s, j, g, state_.data());
      system().first(FunctionKind::integrand, s + 1, state_.data(), x.par.data(), active_, q_.data(),
                     q_by_state_.data(), q_by_parameter_.data());
      const double scale = x.duration(s) * weight;
      const int column = x.shape.first_node(s) + j * x.shape.collocation;
      for (std::size_t r = 0; r < count; ++r) {
        values[r] += scale * q_[r];
        rows[r].durations(s) += weight * q_[r];
        for (int i = 0; i <= rule.points(); ++i)
          for (int a = 0; a < n; ++a)
            rows[r].states(a, column + i) += scale * rule.value(g, i) * q_by_state_[size(a) * count + r];
        const auto by_parameter = [&](int k) { return scale * q_by_parameter_[size(k) * count + r]; };
        for (int t = 0; t < segments(); ++t) rows[r].durations(t) += by_parameter(t);
        for (int k = 0; k < free_count(); ++k) rows[r].globals(k) += by_parameter(segments() + k);
      }
    });
}

std::string BoundaryValueSystem::integral_name(int r) const { return fmt::format("integral condition {}", r + 1); }

std::string BoundaryValueSystem::integral_failure(int s, double tau, const double* x, const double* par) const {
  return integral_conditions() == 0 ? "" : function_failure(*this, FunctionKind::integrand, s + 1, s, tau, x, par);
}

}  // namespace tchat
