#include "bvp/bordered_problem.hpp"

#include <algorithm>
#include <cmath>

namespace tchat {

BorderedProblem::BorderedProblem(const DefiningSystem& system, const OrbitShape& shape,
                                 std::unique_ptr<OrbitCondition> condition)
    : condensed_(system, shape, 1 + system.integral_conditions() + (condition ? 1 : 0)),
      condition_(std::move(condition)),
      rows_(static_cast<std::size_t>(condensed_.border_rows()), condensed_.make_vector()),
      border_(rows_.size()),
      unchanged_(static_cast<std::size_t>(system.integral_conditions()), 0.0),
      response_(condensed_.make_vector()) {
  if (!condition_) return;
  // Any row serves the first time that is not orthogonal to what it stands for.
  OrbitVector& any = stand_in();
  for (Eigen::Index i = 0; i < any.states.size(); ++i)
    any.states.data()[i] = std::sin(0.5 + 0.61 * static_cast<double>(i));
  any.durations.setConstant(0.7);
  for (Eigen::Index g = 0; g < any.globals.size(); ++g) any.globals(g) = g % 2 == 0 ? 1.0 : -1.3;
}

void BorderedProblem::remember(ConditionMemory& memory) const {
  if (!condition_) return;
  condition_->remember(memory.condition);
  memory.stand_in = stand_in();
}

void BorderedProblem::recall(const ConditionMemory& memory) {
  if (!condition_) return;
  condition_->recall(memory.condition);
  stand_in() = memory.stand_in;
}

void BorderedProblem::set_reference(const Orbit& x) {
  if (unchanged_.empty()) return;
  reference_.shape = x.shape;
  reference_.mesh = x.mesh;
  reference_.states = x.states;
  reference_.par = x.par;
}

void BorderedProblem::evaluate(const Orbit& x, OrbitResidual& residual) {
  condensed_.evaluate(x, residual);
  system().integral_values(x, reference_, condensed_.rule(), residual.integral.data());
}

Linearization BorderedProblem::linearize(const Orbit& x, const OrbitVector& row, OrbitResidual& residual) {
  rows_[0].states = row.states;
  rows_[0].durations = row.durations;
  rows_[0].globals = row.globals;
  system().integral_gradients(x, reference_, condensed_.rule(), residual.integral.data(),
                              std::span(rows_).subspan(1, residual.integral.size()));
  const Linearization outcome = condensed_.linearize(x, rows_, residual);
  if (outcome != Linearization::ready || !condition_) return outcome;
  if (!condition_->evaluate(condensed_, x)) return Linearization::condition_lost;
  condensed_.solve(border(0.0, unchanged_, 1.0), response_);
  response_slope_ = dot(condition_->gradient(), response_);
  if (!std::isfinite(response_slope_) || response_slope_ == 0.0) return Linearization::singular;
  const OrbitVector& gradient = condition_->gradient();
  const double size = std::max({gradient.states.cwiseAbs().maxCoeff(), gradient.durations.cwiseAbs().maxCoeff(),
                                gradient.globals.cwiseAbs().maxCoeff()});
  if (std::isfinite(size) && size > 0.0) {
    stand_in() = gradient;
    stand_in().scale(1.0 / size);
  }
  return Linearization::ready;
}

std::span<const double> BorderedProblem::border(double branch, const std::vector<double>& integrals, double stand_in) {
  border_.back() = stand_in;  // where there is none, the branch's row or an integral's, set below
  border_.front() = branch;
  std::transform(integrals.begin(), integrals.end(), border_.begin() + 1, [](double value) { return -value; });
  return border_;
}

void BorderedProblem::solve(const OrbitResidual& residual, double target, OrbitVector& dx) {
  condensed_.solve(residual, border(target, residual.integral, 0.0), dx);
  if (condition_) correct(-condition_->value(), dx);
}

void BorderedProblem::solve(double target, OrbitVector& dx) {
  condensed_.solve(border(target, unchanged_, 0.0), dx);
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
