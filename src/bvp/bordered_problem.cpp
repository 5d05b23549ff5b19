#include "bvp/bordered_problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tchat {

BorderedProblem::BorderedProblem(const DefiningSystem& system, const OrbitShape& shape,
                                 std::unique_ptr<OrbitCondition> condition)
    : condensed_(system, shape, condition ? 2 : 1),
      condition_(std::move(condition)),
      rows_(condition_ ? 2 : 1, condensed_.make_vector()),
      response_(condensed_.make_vector()) {
  if (!condition_) return;
  // Any row serves the first time that is not orthogonal to what it stands for.
  OrbitVector& stand_in = rows_[1];
  for (Eigen::Index i = 0; i < stand_in.states.size(); ++i)
    stand_in.states.data()[i] = std::sin(0.5 + 0.61 * static_cast<double>(i));
  stand_in.durations.setConstant(0.7);
  for (Eigen::Index g = 0; g < stand_in.globals.size(); ++g) stand_in.globals(g) = g % 2 == 0 ? 1.0 : -1.3;
}

void BorderedProblem::remember(ConditionMemory& memory) const {
  if (!condition_) return;
  condition_->remember(memory.condition);
  memory.stand_in = rows_[1];
}

void BorderedProblem::recall(const ConditionMemory& memory) {
  if (!condition_) return;
  condition_->recall(memory.condition);
  rows_[1] = memory.stand_in;
}

Linearization BorderedProblem::linearize(const Orbit& x, const OrbitVector& row, OrbitResidual& residual) {
  rows_[0].states = row.states;
  rows_[0].durations = row.durations;
  rows_[0].globals = row.globals;
  const Linearization outcome = condensed_.linearize(x, rows_, residual);
  if (outcome != Linearization::ready || !condition_) return outcome;
  if (!condition_->evaluate(condensed_, x)) return Linearization::condition_lost;
  condensed_.solve(std::array{0.0, 1.0}, response_);
  response_slope_ = dot(condition_->gradient(), response_);
  if (!std::isfinite(response_slope_) || response_slope_ == 0.0) return Linearization::singular;
  const OrbitVector& gradient = condition_->gradient();
  const double size = std::max({gradient.states.cwiseAbs().maxCoeff(), gradient.durations.cwiseAbs().maxCoeff(),
                                gradient.globals.cwiseAbs().maxCoeff()});
  if (std::isfinite(size) && size > 0.0) {
    rows_[1] = gradient;
    rows_[1].scale(1.0 / size);
  }
  return Linearization::ready;
}

void BorderedProblem::solve(const OrbitResidual& residual, double target, OrbitVector& dx) {
  condensed_.solve(residual, std::array{target, 0.0}, dx);
  if (condition_) correct(-condition_->value(), dx);
}

void BorderedProblem::solve(double target, OrbitVector& dx) {
  condensed_.solve(std::array{target, 0.0}, dx);
  if (condition_) correct(0.0, dx);
}

/// Adds what makes grad G . dx the target.
void BorderedProblem::correct(double condition_target, OrbitVector& dx) const {
  const double share = (condition_target - dot(condition_->gradient(), dx)) / response_slope_;
  dx.states += share * response_.states;
  dx.durations += share * response_.durations;
  dx.globals += share * response_.globals;
}

double BorderedProblem::residual_size(const OrbitResidual& residual) const {
  return condition_ ? std::max(residual.largest(), std::abs(condition_->value())) : residual.largest();
}

}  // namespace tchat
