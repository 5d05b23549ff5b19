#include "orbit/equilibrium_system.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>

#include "linear/dense_matrix.hpp"
#include "orbit/coupling.hpp"

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

namespace {

/// [f_x f_p; t^T] with rows divided by |r| + (1 + |x| + |p|) |dr/ds|, as in singular_distance().
Eigen::MatrixXd bordered_by_tangent(const DefiningSystem& system, const Orbit& x, const OrbitVector& tangent) {
  const int n = system.dimension();
  const HybridSystem& problem = system.system();
  const int field = system.signature().front().field;
  const std::vector<int>& free = system.free_parameters();
  const double* state = x.end(0);
  Eigen::VectorXd t(n + 1);
  t << tangent.states.col(0), tangent.globals(0);
  t.normalize();
  Eigen::VectorXd f(n);
  Eigen::MatrixXd rows(n, n + 1);
  Eigen::MatrixXd slopes(n, n + 1);  // d rows / ds
  problem.first(FunctionKind::field, field, state, x.par.data(), free, f.data(), rows.data(), rows.col(n).data());
  problem.second(FunctionKind::field, field, state, x.par.data(), free, t.data(), f.data(), slopes.data(),
                 slopes.col(n).data());
  const double size = 1.0 + Eigen::Map<const Eigen::VectorXd>(state, n).norm() + std::abs(x.par(free.front() - 1));
  Eigen::MatrixXd matrix(n + 1, n + 1);
  matrix << rows, t.transpose();
  for (int a = 0; a < n; ++a)
    if (const double scale = rows.row(a).norm() + size * slopes.row(a).norm(); scale > 0.0) matrix.row(a) /= scale;
  return matrix;
}

}  // namespace

std::optional<double> EquilibriumSystem::singular_distance(const Orbit& x, const OrbitVector& tangent) const {
  const Eigen::MatrixXd matrix = bordered_by_tangent(*this, x, tangent);
  if (!matrix.allFinite()) return 0.0;
  const PivotedLu lu(matrix);
  int sign = lu.parity();
  for (const double pivot : lu.pivots()) sign *= pivot > 0.0 ? 1 : pivot < 0.0 ? -1 : 0;
  return sign * least_singular_value(matrix.cast<std::complex<double>>());
}

bool EquilibriumSystem::find_crossing_branch(const Orbit& x, const OrbitVector& tangent, OrbitVector& direction) const {
  const int n = dimension();
  const Eigen::MatrixXd matrix = bordered_by_tangent(*this, x, tangent);
  const Eigen::VectorXd v = eigenvector(matrix.transpose() * matrix, 0.0).real().normalized();
  direction.set_zero();
  direction.states = v.head(n).replicate(1, direction.states.cols());
  direction.globals(0) = v(n);
  return true;
}

}  // namespace tchat
