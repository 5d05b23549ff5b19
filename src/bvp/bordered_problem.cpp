#include "bvp/bordered_problem.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "linear_algebra/array_kernel.hpp"

namespace tchat {

BorderedProblem::BorderedProblem(const DefiningSystem& system, const OrbitShape& shape,
                                 std::unique_ptr<OrbitCondition> condition, std::vector<HeldMonitor> held, int threads)
    : condensed_(system, shape, system.integral_conditions() + static_cast<int>(held.size()), threads),
      condition_(std::move(condition)),
      held_(std::move(held)),
      rows_(static_cast<std::size_t>(condensed_.border_rows()), condensed_.make_vector()),
      border_(rows_.size()),
      row_(condensed_.make_vector()),
      particular_(row_),
      null_vectors_(static_cast<std::size_t>(condensed_.null_vectors()), row_) {
  assert(condensed_.null_vectors() == 1 + (condition_ ? condition_->count() : 0));
}

void BorderedProblem::remember(ConditionMemory& memory) const {
  if (condition_) condition_->remember(memory);
}

void BorderedProblem::recall(const ConditionMemory& memory) {
  if (condition_) condition_->recall(memory);
}

OrbitResidual BorderedProblem::make_residual() const {
  OrbitResidual residual = condensed_.make_residual();
  residual.integral.resize(rows_.size(), 0.0);
  return residual;
}

void BorderedProblem::set_reference(const Orbit& x) {
  if (system().integral_conditions() == 0) return;
  reference_.shape = x.shape;
  reference_.mesh = x.mesh;
  reference_.states = x.states;
  reference_.par = x.par;
}

void BorderedProblem::evaluate(const Orbit& x, OrbitResidual& residual) {
  condensed_.evaluate(x, residual);
  system().integral_values(x, reference_, condensed_.rule(), residual.integral.data());
  double* rest = residual.integral.data() + system().integral_conditions();
  for (const HeldMonitor& held : held_) *rest++ = held.monitor->value(x, condensed_.rule()) - held.value;
}

Linearization BorderedProblem::linearize(const Orbit& x, const OrbitVector& row, OrbitResidual& residual) {
  row_.states = row.states;
  row_.durations = row.durations;
  row_.globals = row.globals;
  const auto integrals = static_cast<std::size_t>(system().integral_conditions());
  system().integral_gradients(x, reference_, condensed_.rule(), residual.integral.data(),
                              std::span(rows_).first(integrals));
  for (std::size_t h = 0; h < held_.size(); ++h)
    residual.integral[integrals + h] =
        held_[h].monitor->gradient(x, condensed_.rule(), rows_[integrals + h]) - held_[h].value;
  const Linearization outcome = condensed_.linearize(x, rows_, residual);
  if (outcome != Linearization::ready) return outcome;
  if (condition_ && !condition_->evaluate(condensed_, x)) return Linearization::condition_lost;
  condensed_.solve_all(residual, border(residual.integral), particular_, null_vectors_);
  return find_slopes() ? Linearization::ready : Linearization::singular;
}

/// False when the rows do not tell null vectors apart.
bool BorderedProblem::find_slopes() {
  const int count = condensed_.null_vectors();
  slopes_.resize(count, count);
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < count; ++k) slopes_(i, k) = dot(late_row(i), null_vectors_[static_cast<std::size_t>(k)]);
  if (!slopes_.allFinite()) return false;
  slopes_lu_.compute(slopes_);
  return slopes_lu_.determinant() != 0.0;
}

std::span<const double> BorderedProblem::border(const std::vector<double>& integrals) {
  std::transform(integrals.begin(), integrals.end(), border_.begin(), [](double value) { return -value; });
  return border_;
}

void BorderedProblem::correction(double target, OrbitVector& dx) const {
  Numbers wanted(condensed_.null_vectors());
  wanted(0) = target;
  for (int k = 1; k < wanted.size(); ++k) wanted(k) = -condition_->value(k - 1);
  for (int k = 0; k < wanted.size(); ++k) wanted(k) -= dot(late_row(k), particular_);
  combine(1.0, wanted, dx);
}

void BorderedProblem::chord(const OrbitResidual& residual, const OrbitVector& row, double target, OrbitVector& dx) {
  condensed_.solve(residual, border(residual.integral), dx);
  const OrbitVector& v = null_vectors_.front();
  const double along = (target - dot(row, dx)) / dot(row, v);
  array_functions().add(along, v.states.data(), dx.states.data(), dx.states.size());
  dx.durations += along * v.durations;
  dx.globals += along * v.globals;
}

void BorderedProblem::tangent(OrbitVector& dx) const { combine(0.0, Numbers::Unit(condensed_.null_vectors(), 0), dx); }

/// So much of the particular solution, and null vectors on which the late rows have the values `wanted`.
void BorderedProblem::combine(double particular, const Numbers& wanted, OrbitVector& dx) const {
  std::array<const double*, 1 + most_rows> states{particular_.states.data()};
  std::array<double, 1 + most_rows> factors{particular};
  const Numbers shares = slopes_lu_.solve(wanted);
  dx.durations = particular * particular_.durations;
  dx.globals = particular * particular_.globals;
  for (int k = 0; k < shares.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    states[at + 1] = null_vectors_[at].states.data();
    factors[at + 1] = shares(k);
    dx.durations += shares(k) * null_vectors_[at].durations;
    dx.globals += shares(k) * null_vectors_[at].globals;
  }
  const int left_out = particular == 0.0 ? 1 : 0;
  array_functions().combine(states.data() + left_out, factors.data() + left_out,
                            1 - left_out + static_cast<int>(shares.size()), dx.states.data(), dx.states.size());
}

double BorderedProblem::signed_distance() const {
  const double sign = slopes_lu_.determinant() < 0.0 ? -1.0 : 1.0;
  return sign * condensed_.signed_distance() * std::abs(slopes_.rowwise().normalized().determinant());
}

double BorderedProblem::residual_size(const OrbitResidual& residual) const {
  double largest = residual.largest();
  for (int k = 1; k < condensed_.null_vectors(); ++k) largest = std::max(largest, std::abs(condition_->value(k - 1)));
  return largest;
}

}  // namespace tchat
