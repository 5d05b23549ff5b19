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
          {system.integral_conditions() + static_cast<int>(held.size()), 1 + (condition ? condition->count() : 0)},
          threads),
      condition_(std::move(condition)),
      held_(std::move(held)),
      row_(condensed_.make_vector()),
      closing_(static_cast<std::size_t>(1 + conditions()), condensed_.make_end_vector()),
      next_stand_in_(closing_.front()),
      gradients_(static_cast<std::size_t>(system.integral_conditions()) + held_.size(), row_),
      border_(closing_.size() + gradients_.size()),
      responses_(static_cast<std::size_t>(conditions()), row_),
      slopes_(conditions()),
      tangent_(condensed_.make_vector()) {
  // Any rows serve the first time that are not orthogonal to what they stand for.
  for (int k = 0; k < conditions(); ++k)
    for (std::size_t i = 0; i < stand_in(k).size(); ++i)
      stand_in(k)[i] = std::sin(0.5 + k + (0.61 + 0.27 * k) * static_cast<double>(i));
}

void BorderedProblem::remember(ConditionMemory& memory) const {
  if (!condition_) return;
  condition_->remember(memory.condition);
  memory.stand_ins.resize(responses_.size());
  std::copy(closing_.begin() + 1, closing_.end(), memory.stand_ins.begin());
}

void BorderedProblem::recall(const ConditionMemory& memory) {
  if (!condition_) return;
  condition_->recall(memory.condition);
  std::copy(memory.stand_ins.begin(), memory.stand_ins.end(), closing_.begin() + 1);
}

OrbitResidual BorderedProblem::make_residual() const {
  OrbitResidual residual = condensed_.make_residual();
  residual.integral.resize(gradients_.size(), 0.0);
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
  row_along_.reset();
  row_.states = row.states;
  row_.durations = row.durations;
  row_.globals = row.globals;
  close(row, closing_.front());
  const auto integrals = static_cast<std::size_t>(system().integral_conditions());
  system().integral_gradients(x, reference_, condensed_.rule(), residual.integral.data(),
                              std::span(gradients_).first(integrals));
  for (std::size_t h = 0; h < held_.size(); ++h)
    residual.integral[integrals + h] =
        held_[h].monitor->gradient(x, condensed_.rule(), gradients_[integrals + h]) - held_[h].value;
  const Linearization outcome = condensed_.linearize(x, closing_, gradients_, residual);
  if (outcome != Linearization::ready || !condition_) return outcome;
  if (!condition_->evaluate(condensed_, x)) return Linearization::condition_lost;
  if (!find_responses()) return Linearization::singular;
  follow_gradients();
  return Linearization::ready;
}

/// A row at the ends of segments, each of which counts as many times as there are nodes, as these share the weight of a
/// segment.
void BorderedProblem::close(const OrbitVector& row, EndVector& closing) const {
  const OrbitShape& shape = condensed_.shape();
  double* value = closing.data();
  for (int s = 0; s < shape.segments; ++s) {
    for (const int column : {s * shape.nodes(), (s + 1) * shape.nodes() - 1})
      for (int a = 0; a < shape.dimension; ++a) *value++ = shape.nodes() * row.states(a, column);
    *value++ = row.durations(s);
  }
  std::copy(row.globals.begin(), row.globals.end(), value);
}

double BorderedProblem::at_ends(const OrbitVector& row, const OrbitVector& v) const {
  double sum = 0.0;
  for_ends(condensed_.shape(), [&](int column) { sum += row.states.col(column).dot(v.states.col(column)); });
  return condensed_.shape().nodes() * sum + row.durations.dot(v.durations) + row.globals.dot(v.globals);
}

/// The determinant is proportional to the value of the branch's row on the vector that all others annihilate; that of
/// the closing row is one. With the gradients in place of their stand-ins it is larger by the determinant of slopes_.
double BorderedProblem::signed_distance() {
  if (!row_along_) know_tangent();
  const double distance = condensed_.signed_distance() * slope_cosine();
  return *row_along_ < 0.0 ? -distance : distance;
}

/// The determinant of slopes_ for gradients and responses of length one; 1 without a condition.
double BorderedProblem::slope_cosine() const {
  if (!condition_) return 1.0;
  double cosine = slopes_.determinant();
  for (int k = 0; k < conditions(); ++k) {
    const OrbitVector& response = responses_[static_cast<std::size_t>(k)];
    const OrbitVector& gradient = condition_->gradient(k);
    cosine /= std::sqrt(dot(response, response) * dot(gradient, gradient));
  }
  return cosine;
}

/// False when they do not reach what the condition asks for.
bool BorderedProblem::find_responses() {
  Slopes slopes(conditions(), conditions());
  for (int k = 0; k < conditions(); ++k) {
    OrbitVector& response = responses_[static_cast<std::size_t>(k)];
    condensed_.null_vector(response, 1 + k);
    for (int i = 0; i < conditions(); ++i) slopes(i, k) = dot(condition_->gradient(i), response);
  }
  if (!slopes.allFinite()) return false;
  slopes_.compute(slopes);
  return slopes_.determinant() != 0.0;
}

/// The stand-ins of the next linearisation.
void BorderedProblem::follow_gradients() {
  for (int k = 0; k < conditions(); ++k) {
    EndVector& ends = next_stand_in_;
    close(condition_->gradient(k), ends);
    const ArrayRange range = array_functions().range(ends.data(), static_cast<long>(ends.size()));
    if (!range.finite || !(range.largest > 0.0)) continue;
    for (double& entry : ends) entry /= range.largest;
    stand_in(k).swap(ends);
  }
}

std::span<const double> BorderedProblem::border(const std::vector<double>& integrals) {
  const auto general = border_.begin() + static_cast<std::ptrdiff_t>(closing_.size());
  std::transform(integrals.begin(), integrals.end(), general, [](double value) { return -value; });
  return border_;
}

void BorderedProblem::solve_across(const OrbitResidual& residual, OrbitVector& dx) {
  condensed_.solve(residual, border(residual.integral), dx);
  add_responses(minus_condition(), dx);
}

bool BorderedProblem::solve(const OrbitResidual& residual, double target, OrbitVector& dx) {
  if (!tangent_known_) know_tangent();
  solve_across(residual, dx);
  return put_along(target, dx);
}

bool BorderedProblem::correct(const OrbitResidual& linearized, double target, OrbitVector& dx) {
  condensed_.solve_both(linearized, border(linearized.integral), dx, tangent_);
  complete_tangent();
  add_responses(minus_condition(), dx);
  return put_along(target, dx);
}

void BorderedProblem::know_tangent() {
  condensed_.null_vector(tangent_);
  complete_tangent();
}

/// tangent_ is the null vector of the factors.
void BorderedProblem::complete_tangent() {
  add_responses(Numbers::Zero(conditions()), tangent_);
  row_along_ = dot(row_, tangent_);
  tangent_known_ = true;
}

/// Changes dx along the tangent until row . dx = target.
bool BorderedProblem::put_along(double target, OrbitVector& dx) const {
  if (*row_along_ == 0.0) return false;
  const double along = (target - dot(row_, dx)) / *row_along_;
  array_functions().add(along, tangent_.states.data(), dx.states.data(), dx.states.size());
  dx.durations += along * tangent_.durations;
  dx.globals += along * tangent_.globals;
  return true;
}

void BorderedProblem::find_tangent(OrbitVector& dx) {
  if (!tangent_known_) know_tangent();
  dx.states.swap(tangent_.states);
  dx.durations.swap(tangent_.durations);
  dx.globals.swap(tangent_.globals);
  tangent_known_ = false;
  if (*row_along_ < 0.0) dx.scale(-1.0);
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
