#include "run/own_units.hpp"
#include "base/levels.hpp"

#include <algorithm>
#include <cmath>

#include "model/scales.hpp"

namespace tchat {

namespace {

/// States, or changes of them, n to a column.
void divide(Eigen::MatrixXd& states, const Eigen::VectorXd& units) {
  if (states.size() > 0) states = units.cwiseInverse().asDiagonal() * states;
}

std::vector<IndexedValue> own_weights(const RunSettings& settings, const Eigen::VectorXd& sizes,
                                      const Eigen::VectorXd& units) {
  std::vector<IndexedValue> weights;
  for (int k = 1; k <= static_cast<int>(units.size()); ++k) {
    double weight = default_weight(sizes(k - 1));
    for (const IndexedValue& given : settings.state_weights)
      if (given.index == k) weight = given.value;
    weights.push_back({k, weight * units(k - 1) * units(k - 1)});
  }
  return weights;
}

/// A parameter that is small or zero at the start changes by the longest step at most, where nothing else changes.
Eigen::VectorXd parameter_sizes(const RunSettings& settings, const SelectedStart& start) {
  const ParameterVector& par = start.start.orbit.par;
  const double longest = std::max(std::abs(settings.step_max), std::abs(settings.step));
  Eigen::VectorXd sizes(par.layout().first_duration() - 1);
  for (Eigen::Index k = 0; k < sizes.size(); ++k) {
    double weight = 1.0;
    for (const IndexedValue& given : settings.parameter_weights)
      if (given.index == k + 1) weight = given.value;
    sizes(k) = std::max(std::abs(par(k)), longest / (weight > 0.0 ? std::sqrt(weight) : 1.0));
  }
  return sizes;
}

/// The orbit at the end of a branch that ends at a Hopf bifurcation says nothing of the size of other orbits.
bool has_shrunk(const SelectedStart& start) {
  return start.from_solution && start.start.orbit.shape.stored_nodes() > 1 && is_birth_of_orbits(start.type);
}

/// An equilibrium at which derivatives of its rate vanish: they say nothing of the sizes of states.
bool has_zero_eigenvalue(const SelectedStart& start) {
  const std::vector<PointType> types{PointType::equilibrium_fold, PointType::cusp, PointType::bogdanov_takens,
                                     PointType::zero_hopf};
  return start.from_solution && start.start.orbit.shape.stored_nodes() == 1 && is_among(types, label_type(start.type));
}

/// Sets to 1, not known, the sizes of states that are zero but for the amplitude of the orbit, and of smaller ones.
void forget_amplitudes(const Orbit& x, Eigen::VectorXd& sizes) {
  const auto range = [&](Eigen::Index k) { return x.states.row(k).maxCoeff() - x.states.row(k).minCoeff(); };
  double largest = 0.0;
  for (Eigen::Index k = 0; k < sizes.size(); ++k)
    if (range(k) > 0.5 * x.states.row(k).cwiseAbs().maxCoeff()) largest = std::max(largest, range(k));
  for (Eigen::Index k = 0; k < sizes.size(); ++k)
    if (sizes(k) <= largest) sizes(k) = 1.0;
}

/// The weight that a state has in the norm says in which unit its changes are looked at.
void take_sizes_from_weights(const RunSettings& settings, const std::vector<bool>& known, Eigen::VectorXd& sizes) {
  for (const IndexedValue& given : settings.state_weights)
    if (given.value > 0.0 && !known[static_cast<std::size_t>(given.index - 1)])
      sizes(given.index - 1) = 1.0 / std::sqrt(given.value);
}

OwnUnits in_units_of_sizes(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start,
                           const Eigen::VectorXd& sizes) {
  const Eigen::VectorXd units = units_of(sizes);
  OwnUnits own{std::make_unique<ScaledProblem>(system, Scales{units, parameter_sizes(settings, start)}),
               start,
               settings,
               {},
               sizes};
  own.settings.state_weights = own_weights(settings, sizes, units);
  if (units == Eigen::VectorXd::Ones(units.size())) return own;
  own.units = units;
  divide(own.start.start.orbit.states, units);
  if (own.start.start.direction) divide(own.start.start.direction->states, units);
  if (own.start.second) divide(own.start.second->states, units);
  return own;
}

/// The largest change along the tangent of what has a size, as a share of that; `moves`: of states in units of sizes.
double fastest(const DefiningSystem& system, const PathPoint& point, const Eigen::VectorXd& moves,
               const std::vector<bool>& known) {
  double result = 0.0;
  for (Eigen::Index k = 0; k < moves.size(); ++k)
    if (known[static_cast<std::size_t>(k)]) result = std::max(result, moves(k));
  for (int g = 0; g < system.free_count(); ++g)
    result = std::max(result, std::abs(point.tangent.globals(g)) / parameter_size(system, point.orbit, g));
  const double time = time_size(system, point.orbit);
  return std::max(result, point.tangent.durations.cwiseAbs().maxCoeff() / time);
}

/// Which states move along the tangent of an equilibrium, as far as the rates of states with a size tell: their terms
/// cancel there. What is no visible part of any that do is what rounding makes of a state that stays.
std::vector<bool> moving_at_rest(const HybridSystem& system, const DefiningSystem& defining, const PathPoint& point,
                                 std::vector<bool> moves) {
  constexpr double cancelled = 0.01, least_share = level::tolerance;
  const Eigen::Index n = system.dimension();
  Eigen::VectorXd f(n);
  Eigen::MatrixXd by_state(n, n), by_parameter(n, defining.free_count());
  system.first(FunctionKind::field, defining.signature().front().field, point.orbit.states.data(),
               point.orbit.par.data(), defining.free_parameters(), f.data(), by_state.data(), by_parameter.data());
  Eigen::MatrixXd terms(n, n + defining.free_count());
  terms << by_state * point.tangent.states.col(0).asDiagonal(),
      by_parameter * point.tangent.globals.head(defining.free_count()).asDiagonal();
  for (std::vector<bool> before; before != moves;) {
    before = moves;
    for (Eigen::Index j = 0; j < n; ++j) {
      const double sum = terms.row(j).cwiseAbs().sum();
      if (!moves[static_cast<std::size_t>(j)] || !(std::abs(terms.row(j).sum()) <= cancelled * sum)) continue;
      for (Eigen::Index i = 0; i < n; ++i)
        if (std::abs(terms(j, i)) > least_share * sum) moves[static_cast<std::size_t>(i)] = true;
    }
  }
  return moves;
}

}  // namespace

OwnUnits in_own_units(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start) {
  const StateSizes of_orbit = known_sizes(system, settings.signature(), start.start.orbit);
  Eigen::VectorXd sizes = of_orbit.sizes(!has_zero_eigenvalue(start));
  take_sizes_from_weights(settings, of_orbit.known(), sizes);
  if (has_shrunk(start)) forget_amplitudes(start.start.orbit, sizes);
  return in_units_of_sizes(system, settings, start, sizes);
}

std::optional<OwnUnits> in_units_along(const HybridSystem& system, const RunSettings& settings,
                                       const SelectedStart& start, const OwnUnits& own, const DefiningSystem& defining,
                                       const PathPoint& first) {
  constexpr double far = 8.0;
  const Eigen::VectorXd units = units_of_states(own.system());
  const PathPoint point = in_users_units(first, units);
  const auto signature = settings.signature();
  const std::vector<bool> known = known_sizes(system, signature, point.orbit).known();
  const Eigen::VectorXd moves = point.tangent.states.cwiseAbs().rowwise().maxCoeff();
  const double rate = fastest(defining, first, moves.cwiseQuotient(own.sizes), known);
  if (!(rate > 0.0) || std::find(known.begin(), known.end(), false) == known.end()) return std::nullopt;
  const Eigen::MatrixXd change = point.tangent.states / rate;
  const bool is_at_rest = point.orbit.shape.stored_nodes() == 1;
  const std::vector<bool> moving = is_at_rest ? moving_at_rest(system, defining, point, known)
                                              : known_sizes(system, signature, point.orbit, &change).known(known);
  Eigen::VectorXd sizes = own.sizes;
  bool is_other = false;
  for (Eigen::Index k = 0; k < sizes.size(); ++k) {
    if (known[static_cast<std::size_t>(k)] || !moving[static_cast<std::size_t>(k)]) continue;
    const double found = point.orbit.states.row(k).cwiseAbs().maxCoeff() + moves(k) / rate;
    is_other = is_other || std::max(found / sizes(k), sizes(k) / found) > far;
    sizes(k) = found;
  }
  if (!is_other) return std::nullopt;
  return in_units_of_sizes(system, settings, start, sizes);
}

PathPoint in_users_units(const PathPoint& point, const Eigen::VectorXd& units) {
  PathPoint result{point.orbit, point.tangent, {}, {}};
  result.orbit.states = units.asDiagonal() * point.orbit.states;
  if (point.tangent.states.size() > 0) result.tangent.states = units.asDiagonal() * point.tangent.states;
  return result;
}

}  // namespace tchat
