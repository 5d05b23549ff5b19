#include "continuation/newton_chord.hpp"

#include <cmath>
#include <limits>

#include "base/levels.hpp"

namespace tchat {

namespace {

constexpr double divergence_factor = 20.0;
/// A matrix of a point that is no farther away (relatively) is not made anew: the path follower takes the tangent from
/// it as well.
constexpr double as_good_as_new = level::converged;
/// Residuals below this times 1 + max |u| are rounding.
constexpr double rounding_residual = 200 * std::numeric_limits<double>::epsilon();
/// A correction larger than this multiple of a residual at rounding level says nothing: the matrix is nearly singular.
/// The second one may still be what the first has left.
constexpr double magnified = 1e6;

NewtonStatus failure(Linearization outcome) {
  if (outcome == Linearization::not_finite) return NewtonStatus::not_finite;
  return outcome == Linearization::singular ? NewtonStatus::singular : NewtonStatus::condition_lost;
}

}  // namespace

std::string describe(NewtonStatus status) {
  switch (status) {
    case NewtonStatus::converged:
      return "converged";
    case NewtonStatus::too_many_iterations:
      return "no convergence within ITNW iterations";
    case NewtonStatus::diverging:
      return "the Newton corrections grow";
    case NewtonStatus::not_finite:
      return "a function of the problem is not finite";
    case NewtonStatus::condition_lost:
      return "the critical multiplier of the curve is lost (not found near the last one, or a pair that has become "
             "real)";
    default:
      return "the Newton matrix is singular";
  }
}

bool is_rounding(double residual, const Orbit& x) { return residual < rounding_residual * (1.0 + largest_state(x)); }

double largest_state(const Orbit& x) { return array_functions().range(x.states.data(), x.states.size()).largest; }

OrbitChange change_by(const DefiningSystem& system, const OrbitVector& dx, const Orbit& x, const ArrayRange& range,
                      double largest) {
  const double time = time_size(system, x);
  OrbitChange change{0.0, range.finite ? range.largest / (1.0 + largest) : std::numeric_limits<double>::quiet_NaN()};
  for (int s = 0; s < x.shape.segments; ++s)
    change.parameters = std::max(change.parameters, std::abs(dx.durations(s)) / (time + std::abs(x.duration(s))));
  for (int g = 0; g < system.free_count(); ++g)
    change.parameters = std::max(change.parameters, std::abs(dx.globals(g)) / parameter_size(system, x, g));
  return change;
}

NewtonChord::NewtonChord(BorderedProblem& problem, const NewtonSettings& settings)
    : problem_(problem),
      settings_(settings),
      dx_(problem.condensed().make_vector()),
      residual_(problem.make_residual()),
      linearized_(problem.make_residual_of_ends()) {
  history_.reserve(static_cast<std::size_t>(settings.max_iterations) + 2);
}

NewtonResult NewtonChord::correct(Orbit& x, const OrbitVector& row, double change_along_row) {
  NewtonResult result;
  history_.clear();
  const std::vector<int>& free_parameters = problem_.system().free_parameters();
  const int full_iterations =
      problem_.allows_chord() ? std::max(settings_.full_iterations, 1) : settings_.max_iterations;
  double first_change = 0.0;
  for (int iteration = 1; iteration <= settings_.max_iterations; ++iteration) {
    const bool still_new =
        iteration > 1 && problem_.allows_chord() && result.change_since_factorization <= as_good_as_new;
    const bool full = iteration <= full_iterations && !still_new;
    if (full) {
      const Linearization outcome = problem_.linearize(x, row, linearized_);
      if (outcome != Linearization::ready) {
        result.status = failure(outcome);
        return result;
      }
      result.change_since_factorization = 0.0;
    } else {
      problem_.evaluate(x, residual_);
    }
    result.residual = problem_.residual_size(full ? linearized_ : residual_);
    const double along_row = iteration == 1 ? change_along_row : 0.0;  // then it is so, to rounding
    if (!(full ? problem_.correct(linearized_, row, along_row, dx_) : problem_.solve(residual_, row, along_row, dx_))) {
      result.status = NewtonStatus::singular;
      return result;
    }
    const OrbitChange change = apply(x);
    const double larger = change.larger();
    result.iterations = iteration;
    const double parameter = free_parameters.empty() ? 0.0 : x.par(free_parameters.front() - 1);
    history_.push_back({iteration, parameter, change.parameters, change.states, result.residual});
    if (!std::isfinite(larger)) {
      result.status = NewtonStatus::not_finite;
      return result;
    }
    result.change_since_factorization += larger;
    if (change.parameters <= settings_.tolerance_parameters && change.states < settings_.tolerance_states) {
      result.status = NewtonStatus::converged;
      return result;
    }
    if (iteration == 1) first_change = larger;
    const bool rounding = is_rounding(result.residual, x);
    const bool diverges = iteration > 1 && larger > divergence_factor * first_change;
    const bool settles = iteration == 2 && larger < 0.5 * first_change;
    if (rounding && (diverges || (!settles && larger > magnified * rounding_residual))) {
      advance(x, -1.0, dx_, free_parameters);
      result.status = NewtonStatus::converged;
      return result;
    }
    if (diverges) {
      result.status = NewtonStatus::diverging;
      return result;
    }
    if (iteration > 2 && larger < level::stalled && rounding) {
      result.status = NewtonStatus::converged;
      return result;
    }
  }
  result.status = NewtonStatus::too_many_iterations;
  return result;
}

/// x += dx; the relative sizes of the correction as AUTO measures them.
OrbitChange NewtonChord::apply(Orbit& x) const {
  const std::vector<int>& free_parameters = problem_.system().free_parameters();
  ArrayRange change{}, states{};
  array_functions().add_and_measure(1.0, dx_.states.data(), x.states.data(), x.states.size(), &change, &states);
  advance_parameters(x, 1.0, dx_, free_parameters);
  return change_by(problem_.system(), dx_, x, change, states.largest);
}

}  // namespace tchat
