#include "attractor/equilibrium_approach.hpp"

#include <algorithm>
#include <cmath>

#include "bvp/nearby_equilibrium.hpp"
#include "linear_algebra/dense_matrix.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double rounding = 1e-9;  // of real parts, relative to |f_x|
constexpr std::size_t least_states = 4;
constexpr double no_movement = 1e-3;  // relative to 1 + |x|
constexpr double there = 1e-8;        // distance that integration cannot tell from zero, relative to 1 + |x|

/// An equilibrium whose f_x has no eigenvalue with a positive real part.
std::optional<VectorXd> attracting_equilibrium(const HybridSystem& system, int field, const VectorXd& near,
                                               const VectorXd& par, const std::vector<Index>& ignorable) {
  const std::optional<NearbyEquilibrium> found = find_equilibrium(system, field, near, par.data(), ignorable);
  if (!found) return std::nullopt;
  const bool attracts = (eigenvalues(found->jacobian).real().array() <= rounding * found->jacobian.norm()).all();
  return attracts ? std::optional(found->state) : std::nullopt;
}

}  // namespace

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
