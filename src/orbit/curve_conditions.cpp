#include "orbit/curve_conditions.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/levels.hpp"
#include "linear/dense_matrix.hpp"
#include "orbit/condensed_system.hpp"

namespace tchat {

namespace {

/// S with one full column and row of the border after it.
SparseLu make_bordered(const CondensedReturnMap& map) {
  std::vector<int> rows = map.rows();
  std::vector<int> columns = map.columns();
  for (int i = 0; i < map.size(); ++i) rows.push_back(i), columns.push_back(map.size());
  for (int i = 0; i < map.size(); ++i) rows.push_back(map.size()), columns.push_back(i);
  return {map.size() + 1, rows, columns};
}

/// A border of unit length in units of `sizes`, along a null vector whose entries times `sizes` have no unit.
void follow(const std::vector<double>& null_vector, const std::vector<double>& sizes, std::vector<double>& border) {
  double squares = 0.0;
  for (std::size_t i = 0; i < border.size(); ++i) {
    border[i] = null_vector[i] * sizes[i] * sizes[i];
    squares += std::pow(null_vector[i] * sizes[i], 2);
  }
  const double length = std::sqrt(squares);
  if (length > 0.0)
    for (double& entry : border) entry /= length;
}

}  // namespace

CriticalMultiplier::CriticalMultiplier(const DefiningSystem& system, const OrbitShape& shape, int multiplier)
    : multiplier_(multiplier),
      map_(system, shape),
      lu_(make_bordered(map_)),
      column_(static_cast<std::size_t>(map_.size())),
      row_(column_.size()),
      row_sizes_(column_.size(), 1.0),
      column_sizes_(column_.size(), 1.0),
      small_v_(column_.size() + 1),
      small_w_(column_.size() + 1),
      rhs_(column_.size() + 1, 0.0),
      v_(shape, system.free_count()),
      gradient_(shape, system.free_count()) {
  rhs_.back() = 1.0;
}

/// Sizes of the rows of S and, inverse, of its unknowns. States and their rows have the size 1 (StateSizes), the row of
/// an event that of its largest entry, and sigma_s is a time.
void CriticalMultiplier::find_sizes(const CondensedSystem& condensed, const Orbit& x) {
  const int n = condensed.shape().dimension, block = 2 * n + 1;
  const double time = time_size(condensed.system(), x);
  for (int i = 0; i < map_.size(); ++i)
    if (i % block == n) row_sizes_[static_cast<std::size_t>(i)] = 0.0;
  for (std::size_t k = 0; k < map_.rows().size(); ++k) {
    double& size = row_sizes_[static_cast<std::size_t>(map_.rows()[k])];
    if (map_.rows()[k] % block == n) size = std::max(size, std::abs(values_[k]));
  }
  for (int i = 0; i < map_.size(); ++i) {
    double& row = row_sizes_[static_cast<std::size_t>(i)];
    if (!(row > 0.0)) row = 1.0;
    column_sizes_[static_cast<std::size_t>(i)] = i % block == 2 * n ? 1.0 / time : 1.0;
  }
}

/// Any border that leaves the matrix regular.
void CriticalMultiplier::begin_border() {
  for (std::size_t i = 0; i < column_.size(); ++i) {
    small_w_[i] = std::sin(1.0 + 0.7 * static_cast<double>(i)) / row_sizes_[i];
    small_v_[i] = std::cos(0.3 + 0.9 * static_cast<double>(i)) / column_sizes_[i];
  }
  follow_null_vectors();
}

void CriticalMultiplier::remember(std::vector<double>& memory) const {
  memory.clear();
  if (!started_) return;
  memory.insert(memory.end(), column_.begin(), column_.end());
  memory.insert(memory.end(), row_.begin(), row_.end());
}

void CriticalMultiplier::recall(const std::vector<double>& memory) {
  started_ = !memory.empty();
  if (!started_) return;
  const auto middle = memory.begin() + static_cast<std::ptrdiff_t>(column_.size());
  column_.assign(memory.begin(), middle);
  row_.assign(middle, memory.end());
}

/// S stands in values_, and the border of the last time may stand behind it.
bool CriticalMultiplier::solve_bordered() {
  values_.resize(map_.rows().size());
  values_.insert(values_.end(), column_.begin(), column_.end());
  values_.insert(values_.end(), row_.begin(), row_.end());
  if (!lu_.factorize(values_)) return false;
  lu_.solve(rhs_.data(), small_v_.data());
  lu_.solve_transposed(rhs_.data(), small_w_.data());
  value_ = small_v_.back();
  return std::isfinite(value_) && std::isfinite(small_w_.front());
}

void CriticalMultiplier::follow_null_vectors() {
  follow(small_w_, row_sizes_, column_);
  follow(small_v_, column_sizes_, row_);
}

bool CriticalMultiplier::put_critical_vectors(CriticalVectors& vectors) const {
  vectors.multiplier = multiplier_;
  vectors.right = Eigen::VectorXd::Map(small_v_.data(), map_.size()).cast<std::complex<double>>();
  vectors.left = Eigen::VectorXd::Map(small_w_.data(), map_.size()).cast<std::complex<double>>();
  return true;
}

bool CriticalMultiplier::evaluate(CondensedSystem& condensed, const Orbit& x) {
  map_.values(condensed, x, multiplier_, values_);
  find_sizes(condensed, x);
  if (!started_) begin_border();
  // The border follows the null vectors; the first time it takes some rounds to find them.
  for (int round = started_ ? 3 : 0; round < 4; ++round) {
    if (!solve_bordered()) return false;
    follow_null_vectors();
  }
  started_ = true;
  gradient_.set_zero();
  condensed.extend(small_v_.data(), v_);
  map_.subtract_derivative(condensed, x, small_w_.data(), std::span(&v_, 1), gradient_);
  const double* last = small_w_.data() + map_.last_connectivity_row();
  multiplicity_ = std::inner_product(last, last + condensed.shape().dimension, small_v_.begin(), 0.0);
  return true;
}

namespace {

/// Newton's matrix for (dV, dL), the columns of dV first, then dL row by row: block k of its rows is column k of
/// S dV + E dV L + E V dL, the rows after them V_last^T dV. The entries follow `CriticalPair::factorize`.
SparseLu make_newton(const CondensedReturnMap& map) {
  const int size = map.size();
  const int n = size - map.last_connectivity_row();
  std::vector<int> rows, columns;
  for (int k = 0; k < 2; ++k) {
    for (std::size_t i = 0; i < map.rows().size(); ++i) {
      rows.push_back(k * size + map.rows()[i]);
      columns.push_back(k * size + map.columns()[i]);
    }
    const int row = k * size + map.last_connectivity_row();
    for (int j = 0; j < 2; ++j)
      for (int a = 0; a < n; ++a) {
        rows.push_back(row + a), columns.push_back(j * size + a);
        rows.push_back(row + a), columns.push_back(2 * size + 2 * j + k);
      }
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < size; ++i) rows.push_back(2 * size + 2 * j + k), columns.push_back(k * size + i);
  }
  return {2 * size + 4, rows, columns};
}

}  // namespace

CriticalPair::CriticalPair(const DefiningSystem& system, const OrbitShape& shape, std::complex<double> multiplier,
                           std::optional<double> cosine)
    : map_(system, shape, 2),
      first_multiplier_(multiplier),
      kept_cosine_(cosine),
      lu_(make_newton(map_)),
      rhs_(2 * map_.size() + 4),
      change_(rhs_.size()),
      pair_(Eigen::Matrix2d::Identity()),
      plane_(map_.size(), 2),
      border_(map_.size(), 2),
      left_pair_(Eigen::Matrix2d::Identity()),
      left_plane_(map_.size(), 2),
      extended_(2, OrbitVector(shape, system.free_count())),
      gradients_(static_cast<std::size_t>(CriticalPair::count()), extended_.front()) {}

void CriticalPair::remember(std::vector<double>& memory) const {
  memory.clear();
  if (!started_) return;
  memory.insert(memory.end(), pair_.data(), pair_.data() + pair_.size());
  memory.insert(memory.end(), plane_.data(), plane_.data() + plane_.size());
}

void CriticalPair::recall(const std::vector<double>& memory) {
  started_ = !memory.empty();
  if (!started_) return;
  pair_ = Eigen::Matrix2d::Map(memory.data());
  plane_ = Plane::Map(memory.data() + pair_.size(), plane_.rows(), 2);
}

std::string CriticalPair::beyond_end() const {
  if (!(std::abs(cosine()) > 1.0 + level::located)) return {};
  return fmt::format(
      "the pair of multipliers is real, with product 1 (neutral saddles, no torus bifurcations): the torus curve has "
      "ended at its {} resonance, before this point",
      cosine() > 0.0 ? "1:1" : "1:2");
}

std::complex<double> CriticalPair::multiplier() const {
  const double discriminant = cosine() * cosine() - pair_.determinant();
  if (discriminant < 0.0) return {cosine(), std::sqrt(-discriminant)};
  const double larger = cosine() + std::copysign(std::sqrt(discriminant), cosine());
  return larger == 0.0 ? 0.0 : pair_.determinant() / larger;
}

/// The columns of V and W times eigenvectors of L and L^T.
bool CriticalPair::put_critical_vectors(CriticalVectors& vectors) const {
  const std::complex<double> mu = multiplier();
  if (!(mu.imag() > 0.0)) return false;
  vectors.multiplier = mu;
  const auto combine = [&](const Plane& plane, double first, std::complex<double> second,
                           Eigen::VectorXcd& combination) {
    combination.resize(plane.rows());
    combination.real() = first * plane.col(0) + second.real() * plane.col(1);
    combination.imag() = second.imag() * plane.col(1);
  };
  combine(plane_, pair_(0, 1), mu - pair_(0, 0), vectors.right);
  combine(left_plane_, left_pair_(1, 0), mu - left_pair_(0, 0), vectors.left);
  return true;
}

/// The plane of the real and imaginary part of the eigenvector next to the first multiplier, by inverse iteration; real
/// parts first, then imaginary ones.
bool CriticalPair::begin() {
  constexpr double beside = level::same;  // the shift is not to be an eigenvalue itself
  constexpr int rounds = 3;
  const std::complex<double> shift = first_multiplier_ * (1.0 + beside);
  const int size = map_.size();
  std::vector<int> rows, columns;
  std::vector<double> entries;
  const auto add = [&](int row, int column, double entry) {
    rows.push_back(row), columns.push_back(column), entries.push_back(entry);
  };
  for (const int part : {0, size})
    for (std::size_t k = 0; k < values_.size(); ++k) add(part + map_.rows()[k], part + map_.columns()[k], values_[k]);
  for (const std::size_t k : map_.factor_positions()) {
    add(map_.rows()[k], map_.columns()[k], shift.real());
    add(map_.rows()[k], size + map_.columns()[k], -shift.imag());
    add(size + map_.rows()[k], map_.columns()[k], shift.imag());
    add(size + map_.rows()[k], size + map_.columns()[k], shift.real());
  }
  SparseLu lu(2 * size, rows, columns);
  if (!lu.factorize(entries)) return false;
  const int first = map_.last_connectivity_row();
  const int n = size - first;
  Eigen::VectorXd v = Eigen::VectorXd::Zero(2 * size);
  for (int i = 0; i < size; ++i) v(i) = std::sin(1.0 + 0.7 * i);
  for (int round = 0; round < rounds; ++round) {
    Eigen::VectorXd rhs = Eigen::VectorXd::Zero(2 * size);
    for (const int part : {0, size}) rhs.segment(part + first, n) = v.segment(part, n);
    lu.solve(rhs.data(), v.data());
    if (!v.allFinite()) return false;
    v.normalize();
  }
  plane_.col(0) = v.head(size);
  plane_.col(1) = v.tail(size);
  pair_.setIdentity();
  if (!orthonormalise()) return false;
  // L fits the last connectivity best.
  pair_.setZero();
  set_right_hand_side();
  Plane wanted(n, 2);
  for (int k = 0; k < 2; ++k) wanted.col(k) = rhs_.segment(k * map_.size() + first, n);
  pair_ = least_squares(plane_.topRows(n), wanted);
  return pair_.allFinite();
}

/// V = Q R becomes Q, L becomes R L R^-1.
bool CriticalPair::orthonormalise() {
  const double first = plane_.col(0).norm();
  plane_.col(0) /= first;
  const double across = plane_.col(0).dot(plane_.col(1));
  plane_.col(1) -= across * plane_.col(0);
  const double second = plane_.col(1).norm();
  plane_.col(1) /= second;
  Eigen::Matrix2d r;
  r << first, across, 0.0, second;
  pair_ = r * pair_ * r.inverse();
  return plane_.allFinite() && pair_.allFinite();
}

/// In the order of `make_newton`.
bool CriticalPair::factorize() {
  const Eigen::Index n = map_.size() - map_.last_connectivity_row();
  matrix_.clear();
  for (int k = 0; k < 2; ++k) {
    matrix_.insert(matrix_.end(), values_.begin(), values_.end());
    for (int j = 0; j < 2; ++j)
      for (Eigen::Index a = 0; a < n; ++a) {
        matrix_.push_back(pair_(j, k));
        matrix_.push_back(plane_(a, j));
      }
    for (int j = 0; j < 2; ++j) matrix_.insert(matrix_.end(), border_.col(j).begin(), border_.col(j).end());
  }
  return lu_.factorize(matrix_);
}

/// -(S V + E V L) and 0: the border stays satisfied.
void CriticalPair::set_right_hand_side() {
  const Eigen::Index size = map_.size();
  const Eigen::Index first = map_.last_connectivity_row();
  rhs_.setZero();
  for (int k = 0; k < 2; ++k) {
    for (std::size_t i = 0; i < values_.size(); ++i)
      rhs_(k * size + map_.rows()[i]) -= values_[i] * plane_(map_.columns()[i], k);
    rhs_.segment(k * size + first, size - first).noalias() -= plane_.topRows(size - first) * pair_.col(k);
  }
}

/// Newton's method; the last factors belong to a plane that differs from the result by less than the tolerance.
bool CriticalPair::find_plane() {
  constexpr int most_iterations = 12;
  constexpr double tolerance = level::orbit;  // of a correction, after which the error is about its square
  constexpr double farthest = 0.5;
  constexpr double beyond_meeting = 1.1;
  const Eigen::Index size = map_.size();
  const Eigen::Matrix2d last = pair_;
  border_ = plane_;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (!factorize()) return false;
    set_right_hand_side();
    lu_.solve(rhs_.data(), change_.data());
    if (!change_.allFinite()) return false;
    plane_ += Plane::Map(change_.data(), size, 2);
    pair_ += Eigen::Matrix2d::Map(change_.data() + 2 * size).transpose();
    if ((pair_ - last).norm() > farthest * (1.0 + last.norm())) return false;
    if (change_.cwiseAbs().maxCoeff() > tolerance * (1.0 + pair_.cwiseAbs().maxCoeff())) continue;
    const double cosine = 0.5 * pair_.trace();
    return cosine * cosine < beyond_meeting * beyond_meeting * pair_.determinant();
  }
  return false;
}

bool CriticalPair::evaluate(CondensedSystem& condensed, const Orbit& x) {
  map_.values(condensed, x, 0.0, values_);
  if (!started_ && !begin()) return false;
  if (!find_plane()) return false;
  started_ = true;
  condensed.extend_both(plane_.col(0).data(), extended_[0], plane_.col(1).data(), extended_[1]);
  const Eigen::Vector4d by_determinant(pair_(1, 1), -pair_(1, 0), -pair_(0, 1), pair_(0, 0));
  const Eigen::Vector4d by_cosine(0.5, 0.0, 0.0, 0.5);
  if (!find_gradient(condensed, x, by_determinant, gradients_.front())) return false;
  left_pair_ = pair_;
  left_plane_ = Plane::Map(change_.data(), map_.size(), 2);
  if (kept_cosine_ && !find_gradient(condensed, x, by_cosine, gradients_.back())) return false;
  return orthonormalise();
}

/// Of a function of L whose derivatives, row by row, are `by_pair`.
bool CriticalPair::find_gradient(CondensedSystem& condensed, const Orbit& x, const Eigen::Vector4d& by_pair,
                                 OrbitVector& gradient) {
  rhs_.setZero();
  rhs_.tail<4>() = by_pair;
  lu_.solve_transposed(rhs_.data(), change_.data());
  if (!change_.allFinite()) return false;
  gradient.set_zero();
  map_.subtract_derivative(condensed, x, change_.data(), extended_, gradient);
  return true;
}

CriticalBranchPoint::CriticalBranchPoint(const DefiningSystem& system, const OrbitShape& shape,
                                         const UnfoldedSystem* unfolded)
    : unfolded_(unfolded),
      map_(system, shape),
      multiplier_(system, shape, 1),
      extended_(shape, system.free_count()),
      gradient_(shape, system.free_count()) {
  if (unfolded_ != nullptr) next_phi_.resize(static_cast<std::size_t>(unfolded_->rows()));
  begin();
}

CriticalBranchPoint::CriticalBranchPoint(const DefiningSystem& system, const OrbitShape& shape)
    : CriticalBranchPoint(system, shape, nullptr) {}

CriticalBranchPoint::CriticalBranchPoint(const UnfoldedSystem& system, const OrbitShape& shape)
    : CriticalBranchPoint(system, shape, &system) {}

/// The label is a branch point in the first parameter; any phi does that is not in the range of F_u.
void CriticalBranchPoint::begin() {
  direction_ = Eigen::VectorXd::Unit(directions(), 0);
  next_direction_ = direction_;
  columns_ = Eigen::MatrixXd::Zero(map_.size() + 1, directions());
  solutions_ = columns_;
  if (unfolded_ == nullptr) return;
  std::vector<double> any(next_phi_.size());
  for (std::size_t r = 0; r < any.size(); ++r)
    any[r] = std::sin(0.8 + 1.9 * static_cast<double>(r)) / std::sqrt(static_cast<double>(any.size()));
  unfolded_->unfold_along(any);
}

void CriticalBranchPoint::remember(std::vector<double>& memory) const {
  multiplier_.remember(memory);
  if (memory.empty()) return;
  memory.insert(memory.end(), next_direction_.begin(), next_direction_.end());
  memory.insert(memory.end(), next_phi_.begin(), next_phi_.end());
}

void CriticalBranchPoint::recall(const std::vector<double>& memory) {
  if (memory.empty()) {
    multiplier_.recall(memory);
    begin();
    return;
  }
  const auto own = static_cast<std::ptrdiff_t>(next_phi_.size()) + next_direction_.size();
  const auto middle = memory.end() - own;
  inner_memory_.assign(memory.begin(), middle);
  multiplier_.recall(inner_memory_);
  std::copy_n(middle, direction_.size(), direction_.begin());
  next_direction_ = direction_;
  std::copy(middle + direction_.size(), memory.end(), next_phi_.begin());
  if (unfolded_ != nullptr) unfolded_->unfold_along(next_phi_);
}

bool CriticalBranchPoint::evaluate(CondensedSystem& condensed, const Orbit& x) {
  if (!multiplier_.evaluate(condensed, x)) return false;
  b_ = unfolded_ != nullptr ? x.par(x.par.layout().unfolding(x.shape.segments) - 1) : 0.0;
  size_ = 1.0 + x.states.cwiseAbs().maxCoeff();
  for (int k = 0; k < directions(); ++k) {
    map_.parameter_column(condensed, x, k, columns_.col(k).data());
    multiplier_.solve_beside(columns_.col(k).data(), solutions_.col(k).data());
  }
  value_ = left_null().dot(columns_.topRows(map_.size()) * direction_);
  const Eigen::VectorXd z = solutions_ * direction_;
  if (!std::isfinite(value_) || !z.allFinite()) return false;
  extended_.globals.setZero();
  extended_.globals.head(directions()) = -direction_;
  gradient_.set_zero();
  condensed.extend(z.data(), extended_);
  map_.subtract_derivative(condensed, x, left_null().data(), std::span(&extended_, 1), gradient_);
  if (unfolded_ != nullptr) choose_next(condensed);
  return true;
}

/// What steps from here take for c, the way in which G changes along the orbits of two parameters, and phi, psi itself.
void CriticalBranchPoint::choose_next(CondensedSystem& condensed) {
  for (int k = 0; k < directions(); ++k) {
    extended_.globals.setZero();
    extended_.globals(k) = 1.0;
    const Eigen::VectorXd along = -solutions_.col(k);
    condensed.extend(along.data(), extended_);
    next_direction_(k) = dot(multiplier_.gradient(), extended_);
  }
  const double change = next_direction_.norm();
  next_direction_ = change > 0.0 ? Eigen::VectorXd(next_direction_ / change) : direction_;

  const int n = condensed.shape().dimension;
  const int block = 2 * n + 1;
  auto to = next_phi_.begin();
  for (int s = 0; s < condensed.shape().segments; ++s) {
    const int rows = unfolded_->coupling_rows(s);  // the last ones of the segment's rows of S
    to = std::copy_n(left_null().data() + (s + 1) * block - rows, rows, to);
  }
  const double norm = Eigen::Map<const Eigen::VectorXd>(next_phi_.data(), unfolded_->rows()).norm();
  for (double& entry : next_phi_) entry /= norm;
}

std::string CriticalBranchPoint::beyond_end() const {
  constexpr double zero = level::visible;  // far more than the asymmetry of a mesh leaves of b
  if (!(std::abs(b_) > zero * size_)) return {};
  return fmt::format(
      "the branch points are branch points no longer (the unfolding parameter is {:.2e}, not 0): what makes the "
      "branches "
      "cross, a symmetry for instance, is broken here",
      b_);
}

BranchPointBreaking branch_point_breaking(const DefiningSystem& system, const Orbit& x) {
  const int parameters = system.free_count();
  const int integrals = system.integral_conditions();
  CondensedSystem condensed(system, x.shape, {parameters + integrals});
  OrbitResidual residual = condensed.make_residual();
  std::vector<OrbitVector> rows(static_cast<std::size_t>(parameters + integrals), condensed.make_vector());
  for (int k = 0; k < parameters; ++k) rows[static_cast<std::size_t>(k)].globals(k) = 1.0;
  system.integral_gradients(x, x, condensed.rule(), residual.integral.data(),
                            std::span(rows).subspan(static_cast<std::size_t>(parameters)));
  CriticalMultiplier multiplier(system, x.shape, 1);
  // Singular or not, the blocks are there.
  if (condensed.linearize(x, rows, residual) == Linearization::not_finite || !multiplier.evaluate(condensed, x))
    return {};
  constexpr double rounding = level::located;  // of the matrix: a smaller column says nothing
  CondensedReturnMap map(system, x.shape);
  std::vector<double> matrix;
  map.values(condensed, x, 1.0, matrix);
  const double least = rounding * Eigen::Map<const Eigen::VectorXd>(matrix.data(), std::ssize(matrix)).norm();
  Eigen::VectorXd column(map.size());
  const Eigen::Map<const Eigen::VectorXd> psi(multiplier.left_null_vector().data(), map.size());
  BranchPointBreaking result{true, {}};
  for (int k = 0; k < parameters; ++k) {
    map.parameter_column(condensed, x, k, column.data());
    column *= parameter_size(system, x, k);
    result.shares.push_back(std::abs(psi.dot(column)) / (psi.norm() * (column.norm() + least)));
  }
  return result;
}

EventCondition::EventCondition(const DefiningSystem& system, const OrbitShape& shape, int segment, int event,
                               bool at_end)
    : system_(system), segment_(segment), event_(event), at_end_(at_end), gradient_(shape, system.free_count()) {
  gradient_.set_zero();
}

bool EventCondition::evaluate(CondensedSystem&, const Orbit& x) {
  const int column = at_end_ ? x.shape.last_node(segment_) : x.shape.first_node(segment_);
  if (column != column_) gradient_.states.col(std::exchange(column_, column)).setZero();
  double* const by_state = gradient_.states.col(column).data();
  system_.system().first(FunctionKind::event, event_, x.states.col(column).data(), x.par.data(),
                         system_.free_parameters(), &value_, by_state, gradient_.globals.data());
  return std::isfinite(value_) && all_finite(by_state, x.shape.dimension) &&
         all_finite(gradient_.globals.data(), system_.free_count());
}

}  // namespace tchat
