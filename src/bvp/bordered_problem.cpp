#include "bvp/bordered_problem.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linear_algebra/array_kernel.hpp"

namespace tchat {

namespace {

/// work(column) of the states at both ends of each segment.
template <class Work>
void for_ends(const OrbitShape& shape, const Work& work) {
  for (int s = 0; s < shape.segments; ++s) {
    work(s * shape.nodes());
    work((s + 1) * shape.nodes() - 1);
  }
}

}  // namespace

BorderedProblem::BorderedProblem(const DefiningSystem& system, const OrbitShape& shape,
                                 std::unique_ptr<OrbitCondition> condition, std::vector<HeldMonitor> held, int threads)
    : condensed_(
          system, shape,
          {system.integral_conditions() + static_cast<int>(held.size()) + (condition ? condition->count() : 0), 1},
          threads),
      condition_(std::move(condition)),
      held_(std::move(held)),
      row_(condensed_.make_vector()),
      rows_(static_cast<std::size_t>(condensed_.border_rows()), row_),
      border_(rows_.size()),
      unchanged_(static_cast<std::size_t>(system.integral_conditions()) + held_.size(), 0.0),
      responses_(static_cast<std::size_t>(conditions()), condensed_.make_vector()),
      slopes_(conditions()),
      tangent_(condensed_.make_vector()) {
  // Any rows serve the first time that are not orthogonal to what they stand for.
  for (int k = 0; k < conditions(); ++k) {
    OrbitVector& any = stand_in(k);
    for (Eigen::Index i = 0; i < any.states.size(); ++i)
      any.states.data()[i] = std::sin(0.5 + k + (0.61 + 0.27 * k) * static_cast<double>(i));
    any.durations.setConstant(0.7);
    for (Eigen::Index g = 0; g < any.globals.size(); ++g) any.globals(g) = (g + k) % 2 == 0 ? 1.0 : -1.3;
  }
}

void BorderedProblem::remember(ConditionMemory& memory) const {
  if (!condition_) return;
  condition_->remember(memory.condition);
  memory.stand_ins.resize(responses_.size());
  std::copy(rows_.end() - conditions(), rows_.end(), memory.stand_ins.begin());
}

void BorderedProblem::recall(const ConditionMemory& memory) {
  if (!condition_) return;
  condition_->recall(memory.condition);
  std::copy(memory.stand_ins.begin(), memory.stand_ins.end(), rows_.end() - conditions());
}

OrbitResidual BorderedProblem::make_residual() const {
  OrbitResidual residual = condensed_.make_residual();
  residual.integral.resize(unchanged_.size(), 0.0);
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
  tangent_known_ = false;
  row_on_null_vector_.reset();
  row_.states = row.states;
  row_.durations = row.durations;
  row_.globals = row.globals;
  close(row);
  const auto integrals = static_cast<std::size_t>(system().integral_conditions());
  system().integral_gradients(x, reference_, condensed_.rule(), residual.integral.data(),
                              std::span(rows_).subspan(1, integrals));
  for (std::size_t h = 0; h < held_.size(); ++h)
    residual.integral[integrals + h] =
        held_[h].monitor->gradient(x, condensed_.rule(), rows_[1 + integrals + h]) - held_[h].value;
  const Linearization outcome = condensed_.linearize(x, rows_, residual);
  if (outcome != Linearization::ready || !condition_) return outcome;
  if (!condition_->evaluate(condensed_, x)) return Linearization::condition_lost;
  if (!find_responses()) return Linearization::singular;
  follow_gradients();
  return Linearization::ready;
}

/// The first of the border rows: the branch's row at the ends of segments, each of which counts as many times as there
/// are nodes, as these share the weight of a segment.
void BorderedProblem::close(const OrbitVector& row) {
  OrbitVector& closing = rows_.front();
  closing.durations = row.durations;
  closing.globals = row.globals;
  for_ends(condensed_.shape(),
           [&](int column) { closing.states.col(column) = condensed_.shape().nodes() * row.states.col(column); });
}

double BorderedProblem::at_ends(const OrbitVector& row, const OrbitVector& v) const {
  double sum = 0.0;
  for_ends(condensed_.shape(), [&](int column) { sum += row.states.col(column).dot(v.states.col(column)); });
  return condensed_.shape().nodes() * sum + row.durations.dot(v.durations) + row.globals.dot(v.globals);
}

/// The determinant is proportional to the value of the first row on the vector that the others, stand-ins among them,
/// annihilate; that of the closing row is one.
double BorderedProblem::signed_distance() {
  if (!row_on_null_vector_) {
    OrbitVector v = condensed_.make_vector();
    condensed_.null_vector(v);
    row_on_null_vector_ = dot(row_, v);
  }
  return *row_on_null_vector_ < 0.0 ? -condensed_.signed_distance() : condensed_.signed_distance();
}

/// False when they do not reach what the condition asks for.
bool BorderedProblem::find_responses() {
  Slopes slopes(conditions(), conditions());
  for (int k = 0; k < conditions(); ++k) {
    OrbitVector& response = responses_[static_cast<std::size_t>(k)];
    condensed_.solve(border(unchanged_, k), response);
    for (int i = 0; i < conditions(); ++i) slopes(i, k) = dot(condition_->gradient(i), response);
  }
  if (!slopes.allFinite()) return false;
  slopes_.compute(slopes);
  return slopes_.determinant() != 0.0;
}

/// The stand-ins of the next linearisation.
void BorderedProblem::follow_gradients() {
  for (int k = 0; k < conditions(); ++k) {
    const OrbitVector& gradient = condition_->gradient(k);
    const ArrayRange states = array_functions().range(gradient.states.data(), gradient.states.size());
    const double size =
        std::max({states.largest, gradient.durations.cwiseAbs().maxCoeff(), gradient.globals.cwiseAbs().maxCoeff()});
    if (!states.finite || !std::isfinite(size) || !(size > 0.0)) continue;
    stand_in(k) = gradient;
    stand_in(k).scale(1.0 / size);
  }
}

std::span<const double> BorderedProblem::border(const std::vector<double>& integrals, int unit) {
  std::fill(border_.begin(), border_.end(), 0.0);
  std::transform(integrals.begin(), integrals.end(), border_.begin() + 1, [](double value) { return -value; });
  if (unit >= 0) border_[border_.size() - responses_.size() + static_cast<std::size_t>(unit)] = 1.0;
  return border_;
}

void BorderedProblem::solve_across(const OrbitResidual& residual, OrbitVector& dx) {
  condensed_.solve(residual, border(residual.integral), dx);
  add_responses(minus_condition(), dx);
}

bool BorderedProblem::solve(const OrbitResidual& residual, double target, OrbitVector& dx) {
  if (!tangent_known_) {
    condensed_.null_vector(tangent_);
    know_tangent();
  }
  solve_across(residual, dx);
  return put_along(target, dx);
}

bool BorderedProblem::correct(const OrbitResidual& linearized, double target, OrbitVector& dx) {
  condensed_.solve_both(linearized, border(linearized.integral), dx, tangent_);
  know_tangent();
  add_responses(minus_condition(), dx);
  return put_along(target, dx);
}

/// tangent_ is the null vector of the factors.
void BorderedProblem::know_tangent() {
  row_on_null_vector_ = row_along_ = dot(row_, tangent_);
  if (condition_) {
    add_responses(Numbers::Zero(conditions()), tangent_);
    row_along_ = dot(row_, tangent_);
  }
  tangent_known_ = true;
}

/// Changes dx along the tangent until row . dx = target.
bool BorderedProblem::put_along(double target, OrbitVector& dx) const {
  if (row_along_ == 0.0) return false;
  const double along = (target - dot(row_, dx)) / row_along_;
  array_functions().add(along, tangent_.states.data(), dx.states.data(), dx.states.size());
  dx.durations += along * tangent_.durations;
  dx.globals += along * tangent_.globals;
  return true;
}

void BorderedProblem::find_tangent(OrbitVector& dx) {
  if (!tangent_known_) {
    condensed_.null_vector(tangent_);
    know_tangent();
  }
  dx.states.swap(tangent_.states);
  dx.durations.swap(tangent_.durations);
  dx.globals.swap(tangent_.globals);
  tangent_known_ = false;
  if (row_along_ < 0.0) dx.scale(-1.0);
}

BorderedProblem::Numbers BorderedProblem::minus_condition() const {
  Numbers wanted(conditions());
  for (int k = 0; k < conditions(); ++k) wanted(k) = -condition_->value(k);
  return wanted;
}

/// Adds what makes grad G . dx as wanted.
void BorderedProblem::add_responses(Numbers wanted, OrbitVector& dx) const {
  if (!condition_) return;
  for (int k = 0; k < conditions(); ++k) wanted(k) -= dot(condition_->gradient(k), dx);
  const Numbers shares = slopes_.solve(wanted);
  for (int k = 0; k < conditions(); ++k) {
    const OrbitVector& response = responses_[static_cast<std::size_t>(k)];
    array_functions().add(shares(k), response.states.data(), dx.states.data(), dx.states.size());
    dx.durations += shares(k) * response.durations;
    dx.globals += shares(k) * response.globals;
  }
}

double BorderedProblem::residual_size(const OrbitResidual& residual) const {
  double largest = residual.largest();
  for (int k = 0; k < conditions(); ++k) largest = std::max(largest, std::abs(condition_->value(k)));
  return largest;
}

}  // namespace tchat
