#include "continuation/homoclinic_limit.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

#include "linear/dense_matrix.hpp"
#include "orbit/equilibrium_system.hpp"
#include "stability/bifurcation_tests.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;

/// Distances are shares of the states' ranges over the orbit. Where the parameter stands still to 1e-6 an orbit misses
/// the equilibrium of its limit by about as little.
constexpr double at_rest_nearby = 0.01;

struct Equilibrium {
  int field = 1;
  VectorXd state;
  double distance = 0.0;  ///< of the orbit's slowest point
  Eigen::VectorXcd eigenvalues;
};

/// The largest entry of v as a share of the states' ranges; states that do not move are left out.
double scaled_size(const VectorXd& v, const VectorXd& ranges) {
  double size = 0.0;
  for (Eigen::Index i = 0; i < v.size(); ++i)
    if (ranges(i) > 0.0) size = std::max(size, std::abs(v(i)) / ranges(i));
  return size;
}

struct SlowPoint {
  int field = 1;
  VectorXd state;
};

SlowPoint slowest_point(const DefiningSystem& system, const Orbit& x, const VectorXd& ranges) {
  SlowPoint slowest;
  VectorXd f(x.shape.dimension);
  double least = std::numeric_limits<double>::infinity();
  for (int s = 0; s < x.shape.segments; ++s)
    for (int k = 0; k < x.shape.nodes_of(s); ++k) {
      const int field = system.signature()[static_cast<std::size_t>(s)].field;
      system.system().value(FunctionKind::field, field, x.node(s, k), x.par.data(), f.data());
      const double speed = scaled_size(f, ranges);
      if (!(speed < least)) continue;
      least = speed;
      slowest = {field, VectorXd::Map(x.node(s, k), x.shape.dimension)};
    }
  return slowest;
}

std::optional<Equilibrium> near_equilibrium(const DefiningSystem& system, const Orbit& x) {
  const VectorXd ranges = state_ranges(x);
  const SlowPoint start = slowest_point(system, x, ranges);
  if (start.state.size() == 0) return std::nullopt;
  const std::optional<NearbyEquilibrium> found =
      find_equilibrium(system.system(), start.field, start.state, x.par.data(), {});
  if (!found) return std::nullopt;
  const double distance = scaled_size(found->state - start.state, ranges);
  if (!(distance <= at_rest_nearby)) return std::nullopt;
  return Equilibrium{start.field, found->state, distance, eigenvalues(found->jacobian)};
}

std::string eigenvalue_text(const Eigen::VectorXcd& values) {
  std::string text;
  for (const std::complex<double> value : values) {
    text += fmt::format("{}{:.6g}", text.empty() ? "" : ", ", value.real());
    if (value.imag() != 0.0)
      text += fmt::format(" {} {:.6g} i", value.imag() < 0.0 ? '-' : '+', std::abs(value.imag()));
  }
  return text;
}

/// Without an unstable direction an orbit leaves it by an event alone.
bool is_left_by_flow(const Eigen::VectorXcd& values) {
  constexpr double rounding = 1e-9;
  const double largest = values.cwiseAbs().maxCoeff();
  const auto parts = values.real().array();
  return (parts >= -rounding * largest).any() && (parts <= rounding * largest).any();
}

}  // namespace

std::string homoclinic_limit(const DefiningSystem& system, const Orbit& x, const PeriodGrowth& growth,
                             const std::string& parameter_name) {
  const std::optional<Equilibrium> at = near_equilibrium(system, x);
  if (!at) return "";
  return fmt::format(
      "the period grows, from {:.5g} to {:.5g}, while {} stays at {:.10g}, and the orbit comes within {:.1e} of its "
      "size "
      "to an equilibrium of field {} ({}): {}, eigenvalues {}; so the period grows without bound {}",
      growth.from, growth.to, parameter_name, growth.parameter, at->distance, at->field,
      system.system().function_name(FunctionKind::field, at->field), state_text(system.system(), x, at->state.data()),
      eigenvalue_text(at->eigenvalues),
      is_left_by_flow(at->eigenvalues) ? "towards a homoclinic or heteroclinic orbit"
                                       : "towards an orbit that does not leave this equilibrium, which is no saddle");
}

}  // namespace tchat
