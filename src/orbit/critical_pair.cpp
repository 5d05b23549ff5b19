#include "orbit/critical_pair.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "linear/dense_matrix.hpp"

namespace tchat {

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
  constexpr double accuracy = 1e-6;  // of a located resonance
  if (!(std::abs(cosine()) > 1.0 + accuracy)) return {};
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
  constexpr double beside = 1e-5;  // the shift is not to be an eigenvalue itself
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
  constexpr double tolerance = 1e-9;  // of a correction, after which the error is about its square
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

}  // namespace tchat
