#include "kinds/torus_pair.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/user_error.hpp"
#include "orbit/bordered_problem.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "run/branch_setup.hpp"
#include "run/orbit_start.hpp"
#include "settings/point_type.hpp"
#include "stability/floquet_multipliers.hpp"

namespace tchat {

namespace {

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

}  // namespace

std::complex<double> pair_at(const DefiningSystem& defining, const SelectedStart& selected) {
  const Orbit& x = selected.start.orbit;
  const PeriodicOrbitSystem plain(defining.system(), defining.signature(), {defining.free_parameters().front()});
  BorderedProblem problem(plain, x.shape, nullptr);
  OrbitResidual residual = problem.make_residual();
  OrbitVector row = problem.condensed().make_vector();
  row.globals(0) = 1.0;
  problem.set_reference(x);
  std::complex<double> nearest = 0.0;
  if (problem.linearize(x, row, residual) == Linearization::ready) {
    const auto multipliers = FloquetSolver(x.shape).compute(problem.condensed(), x).values;
    for (const auto& mu : multipliers)
      if (mu.imag() > 0.0 && std::abs(std::abs(mu) - 1.0) < std::abs(std::abs(nearest) - 1.0)) nearest = mu;
    constexpr double on_circle = 1e-3;
    if (std::abs(std::abs(nearest) - 1.0) > on_circle)
      if (const auto meeting = double_multiplier(multipliers); meeting != 0.0) nearest = meeting;
  }
  if (nearest == 0.0)
    throw NoCurveError(fmt::format("{}: label {} has no complex pair of multipliers, so no torus curve begins there",
                                   selected.source, selected.label));
  return nearest;
}

double fixed_cosine(const DefiningSystem& defining, const SelectedStart& start) {
  const auto is = [&start](PointType type) {
    const int number = basic_type(start.type);
    return number == static_cast<int>(type);
  };
  if (is(PointType::resonance_1) || is(PointType::resonance_2))
    throw UserError(
        fmt::format("{}: at label {}, a 1:1 or 1:2 resonance, the pair of multipliers is a double one and has no angle "
                    "to keep; start from a label TR, R3 or R4, or one of the torus curve (IRS=TR1)",
                    start.source, start.label));
  if (is(PointType::resonance_3)) return -0.5;
  if (is(PointType::resonance_4)) return 0.0;
  return std::cos(std::arg(pair_at(defining, start)));
}

}  // namespace tchat
