#include "run/branch_setup.hpp"

#include <fmt/format.h>

#include <cmath>

#include "bvp/critical_multiplier.hpp"
#include "bvp/critical_pair.hpp"
#include "bvp/periodic_orbit_system.hpp"
#include "files/labelled_solution.hpp"
#include "run/branch_switch.hpp"
#include "setup/problem_setup.hpp"
#include "special_points/point_type.hpp"
#include "stability/floquet_multipliers.hpp"
#include "text/user_error.hpp"

namespace tchat {

namespace {

constexpr int fold = static_cast<int>(PointType::fold);
constexpr int period_doubling = static_cast<int>(PointType::period_doubling);
constexpr int torus = static_cast<int>(PointType::torus);

/// The curve that a label lies on: of its own type, or the one that it was computed on (tens digit).
int curve_through(const SelectedStart& selected) {
  const int tens = std::abs(selected.type) / 10;
  for (const int type : tens > 0 ? std::vector<int>{tens} : selected.types)
    if (type == fold || type == period_doubling || type == torus) return type;
  throw UserError(fmt::format(
      "{}: ISW = 2 follows the curve of a fold (LP), period doubling (PD) or torus bifurcation (TR) in two parameters, "
      "but the run starts "
      "from {}; name such a label, for example IRS=LP1",
      selected.source,
      selected.from_solution ? fmt::format("a label of type {}", type_name(selected.type, selected.kind).empty()
                                                                     ? "none"
                                                                     : type_name(selected.type, selected.kind))
                             : "data"));
}

/// A complex number between two real multipliers that have just met, or are about to.
std::complex<double> double_multiplier(const std::vector<std::complex<double>>& multipliers) {
  constexpr double distance = 0.05;
  for (const auto& a : multipliers)
    for (const auto& b : multipliers)
      if (a.imag() == 0.0 && b.imag() == 0.0 && a.real() < b.real() && b.real() - a.real() < distance &&
          std::abs(a.real() * b.real() - 1.0) < distance * distance)
        return {0.5 * (a.real() + b.real()), 0.5 * distance * distance};
  return 0.0;
}

/// The complex multiplier of the uncorrected start that is nearest to the unit circle; at a 1:1 or 1:2 resonance, where
/// the pair may have become real by rounding, one beside it.
std::complex<double> pair_at(const DefiningSystem& defining, const SelectedStart& selected) {
  const Orbit& x = selected.start.orbit;
  const PeriodicOrbitSystem plain(defining.system(), defining.signature(), {defining.free_parameters().front()});
  CondensedSystem condensed(plain, x.shape, 1);
  OrbitResidual residual = condensed.make_residual();
  std::vector<OrbitVector> row{condensed.make_vector()};
  row.front().globals(0) = 1.0;
  std::complex<double> nearest = 0.0;
  if (condensed.linearize(x, row, residual) == Linearization::ready) {
    const auto multipliers = FloquetSolver(x.shape).compute(condensed, x).values;
    for (const auto& mu : multipliers)
      if (mu.imag() > 0.0 && std::abs(std::abs(mu) - 1.0) < std::abs(std::abs(nearest) - 1.0)) nearest = mu;
    constexpr double on_circle = 1e-3;
    if (std::abs(std::abs(nearest) - 1.0) > on_circle)
      if (const auto meeting = double_multiplier(multipliers); meeting != 0.0) nearest = meeting;
  }
  if (nearest == 0.0)
    throw UserError(fmt::format("{}: label {} has no complex pair of multipliers, so no torus curve begins there",
                                selected.source, selected.label));
  return nearest;
}

std::unique_ptr<OrbitCondition> make_condition(const DefiningSystem& defining, const SelectedStart& selected,
                                               int curve_type) {
  const OrbitShape& shape = selected.start.orbit.shape;
  if (curve_type == torus) return std::make_unique<CriticalPair>(defining, shape, pair_at(defining, selected));
  return std::make_unique<CriticalMultiplier>(defining, shape, curve_type == fold ? 1 : -1);
}

}  // namespace

BranchSetup set_up_branch(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected) {
  if (settings.branch_mode == -1) return switch_branch(system, settings, selected);
  BranchSetup setup{settings, nullptr, nullptr, {}, 0};
  const ProblemType& type = problem_type(settings);
  setup.defining = type.make(system, settings, free_problem_parameters(type, settings));
  const OrbitShape& shape = selected.start.orbit.shape;
  check_memory(shape, setup.defining->free_count());
  std::unique_ptr<OrbitCondition> condition;
  if (settings.branch_mode == 2) {
    setup.curve_type = curve_through(selected);
    condition = make_condition(*setup.defining, selected, setup.curve_type);
  }
  setup.follower =
      std::make_unique<PathFollower>(*setup.defining, shape, weighted_norm(settings), newton_settings(settings),
                                     settings.free_parameters.front(), std::move(condition));
  setup.start = first_point(*setup.follower, *setup.defining, selected, settings);
  return setup;
}

}  // namespace tchat
