#include "motion/equilibrium_approach.hpp"

#include <algorithm>
#include <cmath>

#include "linear/dense_matrix.hpp"
#include "orbit/equilibrium_system.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr double rounding = 1e-9;  // of real parts, relative to |f_x|
constexpr std::size_t least_states = 4;
constexpr double no_movement = 1e-3;  // relative to 1 + |x|
constexpr double there = 1e-8;        // distance that integration cannot tell from zero, relative to 1 + |x|
constexpr double at_surface = 1e-6;   // the same from the surface of an event
constexpr double least_fall = 1e-3;   // of distances, relative to the last one

/// An equilibrium whose f_x has no eigenvalue with a positive real part.
std::optional<VectorXd> attracting_equilibrium(const HybridSystem& system, int field, const VectorXd& near,
                                               const VectorXd& par, const std::vector<Index>& ignorable) {
  const std::optional<NearbyEquilibrium> found = find_equilibrium(system, field, near, par.data(), ignorable);
  if (!found) return std::nullopt;
  const bool attracts = (eigenvalues(found->jacobian).real().array() <= rounding * found->jacobian.norm()).all();
  return attracts ? std::optional(found->state) : std::nullopt;
}

bool is_on_surface(const HybridSystem& system, int event, const VectorXd& x, const VectorXd& par) {
  double h = 0.0;
  RowVectorXd gradient(x.size());
  system.first(FunctionKind::event, event, x.data(), par.data(), {}, &h, gradient.data(), nullptr);
  return std::abs(h) <= at_surface * (1.0 + x.norm()) * gradient.norm();
}

/// Of falling distances.
bool fall_to_zero(const std::vector<double>& distances) {
  const std::size_t space = (distances.size() - 1) / 2, last = distances.size() - 1;
  const double end = distances[last];
  const double before = distances[last - 2 * space] - distances[last - space], after = distances[last - space] - end;
  if (!(before + after >= least_fall * end)) return false;
  return after >= before || end - after * after / (before - after) <= 0.5 * end;
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

std::optional<VectorXd> approached_equilibrium(const HybridSystem& system, const IndexVector& index,
                                               const std::vector<VectorXd>& states, std::size_t least,
                                               const VectorXd& par, const std::vector<Index>& ignorable) {
  if (states.size() < least_states) return std::nullopt;
  const std::optional<VectorXd> rest = attracting_equilibrium(system, index.field, states.back(), par, ignorable);
  if (!rest || !is_on_surface(system, index.event, *rest, par)) return std::nullopt;
  const double nothing = there * (1.0 + rest->norm());
  std::vector<double> falling;  // the last distances, as long as each is smaller than the one before it, or nothing
  for (const VectorXd& state : states) {
    VectorXd d = state - *rest;
    for (const Index k : ignorable) d(k) = 0.0;
    if (!falling.empty() && !(d.norm() < falling.back()) && !(d.norm() <= nothing)) falling.clear();
    falling.push_back(d.norm());
  }
  if (falling.size() < std::max(least_states, least)) return std::nullopt;
  return falling.back() <= nothing || fall_to_zero(falling) ? rest : std::nullopt;
}

}  // namespace tchat
