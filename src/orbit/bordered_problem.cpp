#include "orbit/bordered_problem.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "linear/array_kernel.hpp"
#include "linear/dense_matrix.hpp"
#include "orbit/monitor.hpp"

namespace tchat {

namespace {

/// The columns of the states at both ends of segment s.
std::array<int, 2> end_columns(const OrbitShape& shape, int s) { return {shape.first_node(s), shape.last_node(s)}; }

/// Orthogonal to all rows: their vector product.
template <class Rows>
auto vector_product(const Rows& rows) {
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, Rows::MaxColsAtCompileTime, 1> result(rows.cols());
  if (rows.rows() == 0)
    result << 1.0;
  else if (rows.rows() == 1)
    result << rows(0, 1), -rows(0, 0);
  else if (rows.rows() == 2)
    result = Eigen::Vector3d(rows.row(0).transpose()).cross(Eigen::Vector3d(rows.row(1).transpose()));
  else
    for (Eigen::Index j = 0; j < rows.cols(); ++j) {
      Eigen::MatrixXd others(rows.rows(), rows.rows());
      others << rows.leftCols(j), rows.rightCols(rows.cols() - 1 - j);
      result(j) = (j % 2 == 0 ? 1.0 : -1.0) * PivotedLu(others).determinant();
    }
  return result;
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
      closing_(condensed_.make_end_vector()),
      gradients_(static_cast<std::size_t>(system.integral_conditions()) + held_.size(), condensed_.make_vector()),
      border_(static_cast<std::size_t>(1 + conditions()) + gradients_.size()),
      null_vectors_(static_cast<std::size_t>(1 + conditions()), condensed_.make_vector()),
      slopes_(conditions(), conditions() + 1),
      along_(conditions() + 1) {
  if (condition_) tangent_ = condensed_.make_vector();
}

void BorderedProblem::remember(ConditionMemory& memory) const {
  if (condition_) condition_->remember(memory);
}

void BorderedProblem::recall(const ConditionMemory& memory) {
  if (condition_) condition_->recall(memory);
}

OrbitResidual BorderedProblem::make_residual() const {
  OrbitResidual residual = condensed_.make_residual();
  residual.integral.resize(gradients_.size(), 0.0);
  return residual;
}

OrbitResidual BorderedProblem::make_residual_of_ends() const {
  OrbitResidual residual = condensed_.make_residual_of_ends();
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
  outcome_ = Linearization::not_finite;
  null_vectors_known_ = false;
  row_along_.reset();
  if (!condition_) close(x.shape, row);
  const auto integrals = static_cast<std::size_t>(system().integral_conditions());
  system().integral_gradients(x, reference_, condensed_.rule(), residual.integral.data(),
                              std::span(gradients_).first(integrals));
  for (std::size_t h = 0; h < held_.size(); ++h)
    residual.integral[integrals + h] =
        held_[h].monitor->gradient(x, condensed_.rule(), gradients_[integrals + h]) - held_[h].value;
  outcome_ = condensed_.linearize(x, {&closing_, condition_ ? 0U : 1U}, gradients_, residual);
  if (outcome_ == Linearization::ready && condition_ && !condition_->evaluate(condensed_, x))
    outcome_ = Linearization::condition_lost;
  return outcome_;
}

/// A row at the ends of segments, each of which counts as many times as there are nodes, as these share the weight of a
/// segment.
void BorderedProblem::close(const OrbitShape& shape, const OrbitVector& row) {
  double* value = closing_.data();
  for (int s = 0; s < shape.segments; ++s) {
    for (const int column : end_columns(shape, s))
      for (int a = 0; a < shape.dimension; ++a) *value++ = shape.mean_nodes() * row.states(a, column);
    *value++ = row.durations(s);
  }
  std::copy(row.globals.begin(), row.globals.end(), value);
}

double BorderedProblem::at_ends(const OrbitShape& shape, const OrbitVector& row, const OrbitVector& v) {
  double sum = 0.0;
  for (int s = 0; s < shape.segments; ++s)
    for (const int column : end_columns(shape, s)) sum += row.states.col(column).dot(v.states.col(column));
  return shape.mean_nodes() * sum + row.durations.dot(v.durations) + row.globals.dot(v.globals);
}

/// The determinant with row and gradients is that with the closing rows, whose values on the null vectors are those of
/// the unit matrix, times that of all rows on Z.
double BorderedProblem::signed_distance(const OrbitVector& row) {
  if (outcome_ == Linearization::singular) return 0.0;
  if (outcome_ != Linearization::ready) return std::numeric_limits<double>::quiet_NaN();
  const double sign = tangent_sign(row);
  double distance = condensed_.signed_distance();
  if (condition_) distance *= along_.norm();
  for (int k = 0; k < conditions(); ++k) distance /= size_on_null_vectors(condition_->gradient(k));
  return sign * distance;
}

BorderedProblem::Numbers BorderedProblem::on_null_vectors(const OrbitVector& row) const {
  Numbers values(conditions() + 1);
  for (int j = 0; j <= conditions(); ++j) values(j) = dot(row, null_vectors_[static_cast<std::size_t>(j)]);
  return values;
}

/// The largest length that row . Z may have with these sizes of its terms; not zero.
double BorderedProblem::size_on_null_vectors(const OrbitVector& row) const {
  double sum = std::numeric_limits<double>::min();
  for (const OrbitVector& z : null_vectors_) sum += dot_of_sizes(row, z) * dot_of_sizes(row, z);
  return std::sqrt(sum);
}

CondensedSystem::Singularity BorderedProblem::singularity(const OrbitVector& row) {
  CondensedSystem::Singularity result = condensed_.singularity();
  if (outcome_ != Linearization::ready || !condition_) return result;
  if (!null_vectors_known_) find_null_vectors();
  Eigen::MatrixXd rows(conditions() + 1, conditions() + 1);
  rows.row(0) = on_null_vectors(row).transpose() / size_on_null_vectors(row);
  for (int k = 0; k < conditions(); ++k)
    rows.row(1 + k) = slopes_.row(k) / size_on_null_vectors(condition_->gradient(k));
  if (!rows.allFinite()) return result;
  const SingularVectors vectors = singular_vectors(rows);
  const double reciprocal = vectors.sizes.minCoeff() / vectors.sizes.maxCoeff();
  if (!(reciprocal < result.reciprocal_condition)) return result;
  OrbitVector direction = condensed_.make_vector();
  combine_null_vectors(vectors.right.rightCols<1>(), direction);
  return {reciprocal, direction};
}

std::span<const double> BorderedProblem::border(const std::vector<double>& integrals) {
  const auto general = border_.end() - static_cast<std::ptrdiff_t>(gradients_.size());
  std::transform(integrals.begin(), integrals.end(), general, [](double value) { return -value; });
  return border_;
}

void BorderedProblem::solve_across(const OrbitResidual& residual, OrbitVector& dx) {
  assert(allows_chord());
  condensed_.solve(residual, border(residual.integral), dx);
}

bool BorderedProblem::solve(const OrbitResidual& residual, const OrbitVector& row, double target, OrbitVector& dx) {
  if (!null_vectors_known_) find_null_vectors();
  condensed_.solve(residual, border(residual.integral), dx);
  return put_on_branch(row, target, dx);
}

bool BorderedProblem::correct(const OrbitResidual& linearized, const OrbitVector& row, double target, OrbitVector& dx) {
  condensed_.solve_with_null_vectors(linearized, border(linearized.integral), dx, null_vectors_);
  measure_null_vectors();
  return put_on_branch(row, target, dx);
}

void BorderedProblem::find_null_vectors() {
  for (int k = 0; k <= conditions(); ++k) condensed_.null_vector(null_vectors_[static_cast<std::size_t>(k)], k);
  measure_null_vectors();
}

/// What gradients say of them.
void BorderedProblem::measure_null_vectors() {
  for (int k = 0; k < conditions(); ++k) slopes_.row(k) = on_null_vectors(condition_->gradient(k)).transpose();
  along_ = vector_product(slopes_);
  null_vectors_known_ = true;
}

double BorderedProblem::tangent_sign(const OrbitVector& row) {
  if (!null_vectors_known_) find_null_vectors();
  if (!row_along_) row_along_ = on_null_vectors(row).dot(along_);
  return *row_along_ < 0.0 ? -1.0 : 1.0;
}

/// The shares of null vectors that make grad G . (dx + Z b) = -G, with none along the tangent.
BorderedProblem::Numbers BorderedProblem::across(const OrbitVector& dx) const {
  Numbers shares = Numbers::Zero(conditions() + 1);
  for (int k = 0; k < conditions(); ++k) {
    const double wanted = -condition_->value(k) - dot(condition_->gradient(k), dx);
    shares += wanted / along_.squaredNorm() * dual_slope(k);
  }
  return shares;
}

/// |a|^2 times the vector that row k of grad G . Z has the value one on, and the other rows, and a, zero.
BorderedProblem::Numbers BorderedProblem::dual_slope(int k) const {
  if (conditions() == 1) return slopes_.row(0).transpose();
  if (conditions() > 2) {
    Eigen::MatrixXd all(conditions() + 1, conditions() + 1);
    all << slopes_, along_.transpose();
    return along_.squaredNorm() * tchat::solve(all, Eigen::VectorXd::Unit(conditions() + 1, k));
  }
  const Eigen::Vector3d a = along_;
  const Eigen::Vector3d other = slopes_.row(1 - k).transpose();
  return k == 0 ? Numbers(other.cross(a)) : Numbers(a.cross(other));
}

/// Adds what meets the condition, and makes row . dx = target; false when the row is exactly orthogonal to the tangent,
/// or there is none.
bool BorderedProblem::put_on_branch(const OrbitVector& row, double target, OrbitVector& dx) {
  Numbers row_slopes(conditions() + 1);
  double row_dx = 0.0;
  std::tie(row_dx, row_slopes(0)) = dot_both(row, dx, null_vectors_.front());
  for (int k = 1; k <= conditions(); ++k) row_slopes(k) = dot(row, null_vectors_[static_cast<std::size_t>(k)]);
  row_along_ = row_slopes.dot(along_);
  if (*row_along_ == 0.0 || !std::isfinite(*row_along_)) return false;
  Numbers shares = across(dx);
  shares += (target - row_dx - row_slopes.dot(shares)) / *row_along_ * along_;
  add_null_vectors(shares, dx);
  return true;
}

void BorderedProblem::add_null_vectors(const Numbers& shares, OrbitVector& dx) const {
  for (std::size_t j = 0; j < null_vectors_.size(); ++j) {
    const double share = shares(static_cast<Eigen::Index>(j));
    const OrbitVector& z = null_vectors_[j];
    array_functions().add(share, z.states.data(), dx.states.data(), dx.states.size());
    dx.durations += share * z.durations;
    dx.globals += share * z.globals;
  }
}

void BorderedProblem::combine_null_vectors(const Numbers& shares, OrbitVector& v) const {
  std::array<const double*, most_null_vectors> states{};
  std::transform(null_vectors_.begin(), null_vectors_.end(), states.begin(),
                 [](const OrbitVector& z) { return z.states.data(); });
  array_functions().combine(states.data(), shares.data(), static_cast<int>(shares.size()), v.states.data(),
                            v.states.size());
  v.durations.setZero();
  v.globals.setZero();
  for (Eigen::Index j = 0; j < shares.size(); ++j) {
    v.durations += shares(j) * null_vectors_[static_cast<std::size_t>(j)].durations;
    v.globals += shares(j) * null_vectors_[static_cast<std::size_t>(j)].globals;
  }
}

/// Without a condition the first null vector is the tangent.
const OrbitVector& BorderedProblem::tangent() {
  if (!null_vectors_known_) find_null_vectors();
  if (!condition_) return null_vectors_.front();
  combine_null_vectors(along_, tangent_);
  return tangent_;
}

double BorderedProblem::residual_size(const OrbitResidual& residual) const {
  double largest = residual.largest();
  for (int k = 0; k < conditions(); ++k) largest = std::max(largest, std::abs(condition_->value(k)));
  return largest;
}

}  // namespace tchat
