#include "attractor/equilibrium_approach.hpp"

#include <algorithm>
#include <cmath>

#include "linear_algebra/dense_matrix.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int most_steps = 20;
constexpr double converged_step = 1e-10;  // relative to 1 + |x|
constexpr double rounding = 1e-9;         // of real parts, relative to |f_x|
constexpr std::size_t least_states = 4;
constexpr double no_movement = 1e-3;  // relative to 1 + |x|
constexpr double there = 1e-8;        // distance that integration cannot tell from zero, relative to 1 + |x|

}  // namespace

std::optional<VectorXd> attracting_equilibrium(const HybridSystem& system, int field, const VectorXd& near,
                                               const VectorXd& par, const std::vector<Index>& ignorable) {
  const Index n = near.size();
  std::vector<Index> kept;
  for (Index i = 0; i < n; ++i)
    if (std::find(ignorable.begin(), ignorable.end(), i) == ignorable.end()) kept.push_back(i);
  VectorXd x = near, f(n);
  MatrixXd fx(n, n);
  double no_parameters = 0.0;
  for (int step = 0; step < most_steps; ++step) {
    system.first(FunctionKind::field, field, x.data(), par.data(), {}, f.data(), fx.data(), &no_parameters);
    if (!f.allFinite() || !fx.allFinite()) return std::nullopt;
    const MatrixXd matrix = fx(kept, kept);
    VectorXd value(matrix.rows());
    for (Index i = 0; i < value.size(); ++i) value(i) = f(kept[static_cast<std::size_t>(i)]);
    const VectorXd dx = -solve_with_complete_pivoting(matrix, value);
    if (!dx.allFinite()) return std::nullopt;
    for (Index i = 0; i < dx.size(); ++i) x(kept[static_cast<std::size_t>(i)]) += dx(i);
    if (dx.norm() > converged_step * (1.0 + x.norm())) continue;
    if (value.norm() > 1e-6 * (matrix.norm() + 1.0) * (1.0 + x.norm())) return std::nullopt;
    if ((eigenvalues(matrix).real().array() > rounding * matrix.norm()).any()) return std::nullopt;
    return x;
  }
  return std::nullopt;
}

std::optional<VectorXd> reached_equilibrium(const HybridSystem& system, const SimulatedSegment& last,
                                            const VectorXd& par, const std::vector<Index>& ignorable) {
  const int field = last.mode.field();
  VectorXd f(last.end.size());
  system.value(FunctionKind::field, field, last.end.data(), par.data(), f.data());
  for (const Index k : ignorable) f(k) = 0.0;
  if (!(f.norm() * last.duration <= no_movement * (1.0 + last.end.norm()))) return std::nullopt;
  return attracting_equilibrium(system, field, last.end, par, ignorable);
}

std::optional<VectorXd> approached_equilibrium(const HybridSystem& system, int field,
                                               const std::vector<VectorXd>& states, const VectorXd& par,
                                               const std::vector<Index>& ignorable) {
  if (states.size() < least_states) return std::nullopt;
  const std::optional<VectorXd> rest = attracting_equilibrium(system, field, states.back(), par, ignorable);
  if (!rest) return std::nullopt;
  double before = INFINITY;
  for (const VectorXd& state : states) {
    VectorXd d = state - *rest;
    for (const Index k : ignorable) d(k) = 0.0;
    if (!(d.norm() < before) && !(d.norm() <= there * (1.0 + rest->norm()))) return std::nullopt;
    before = d.norm();
  }
  return rest;
}

}  // namespace tchat
