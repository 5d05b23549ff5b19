#include "orbit/hopf_pair.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "linear/dense_matrix.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/defining_system.hpp"

namespace tchat {

HopfPair::HopfPair(const DefiningSystem& system, const OrbitShape& shape, std::optional<double> omega)
    : system_(system),
      first_omega_(omega),
      jacobian_(shape.dimension, shape.dimension),
      by_state_(shape.dimension, shape.dimension),
      by_parameter_(shape.dimension, system.free_count()),
      field_(shape.dimension),
      direction_(static_cast<std::size_t>(shape.dimension + system.free_count()), 0.0),
      pair_(Eigen::Matrix2d::Zero()),
      plane_(shape.dimension, 2),
      gradient_(shape, system.free_count()) {}

void HopfPair::remember(std::vector<double>& memory) const {
  memory.clear();
  if (!started_) return;
  memory.insert(memory.end(), pair_.data(), pair_.data() + pair_.size());
  memory.insert(memory.end(), plane_.data(), plane_.data() + plane_.size());
}

void HopfPair::recall(const std::vector<double>& memory) {
  started_ = !memory.empty();
  if (!started_) return;
  std::copy_n(memory.begin(), pair_.size(), pair_.data());
  std::copy_n(memory.begin() + pair_.size(), plane_.size(), plane_.data());
}

std::string HopfPair::beyond_end() const {
  return square() < 0.0 ? "the pair of eigenvalues has become real: a curve of Hopf bifurcations ends, and neutral "
                          "saddles follow"
                        : "";
}

/// At a double eigenvalue 0, which rounding may have made two real ones: the plane that f_x f_x maps to nearly nothing.
bool HopfPair::begin_at_double_zero() {
  constexpr double nearly_zero = 1e-4;
  const auto beyond = [size = nearly_zero * jacobian_.norm()](const auto& value) { return std::abs(value) > size; };
  const Eigen::VectorXcd values = eigenvalues(jacobian_);
  if (values.size() - std::count_if(values.begin(), values.end(), beyond) != 2) return false;
  const Eigen::MatrixXd square = jacobian_ * jacobian_;
  plane_ = Eigen::JacobiSVD<Eigen::MatrixXd>(square, Eigen::ComputeFullV).matrixV().rightCols<2>();
  pair_ = plane_.transpose() * jacobian_ * plane_;
  return started_ = true;
}

/// The plane of the eigenvector of the chosen pair.
bool HopfPair::begin() {
  constexpr double about_critical = 0.1;
  const auto distance = [this](const std::complex<double>& value) {
    return first_omega_ ? std::abs(value - std::complex<double>(0.0, *first_omega_))
                        : std::abs(value.real() / value.imag());
  };
  const Eigen::VectorXcd values = eigenvalues(jacobian_);
  const std::complex<double>* nearest = nullptr;
  for (const auto& value : values)
    if (value.imag() > 0.0 && (nearest == nullptr || distance(value) < distance(*nearest))) nearest = &value;
  const bool is_critical = nearest != nullptr && std::abs(nearest->real()) < about_critical * nearest->imag();
  if (!is_critical && begin_at_double_zero()) return true;
  if (nearest == nullptr) return false;
  const std::complex<double> chosen = *nearest;
  const Eigen::VectorXcd vector = eigenvector(jacobian_, chosen);
  plane_.col(0) = vector.real();
  plane_.col(1) = vector.imag();
  // f_x (u + i v) = (a + i b) (u + i v)
  pair_ << chosen.real(), chosen.imag(), -chosen.imag(), chosen.real();
  orthonormalise();
  started_ = true;
  return plane_.allFinite();
}

/// V = Q R: Q for V, R L R^-1 for L.
void HopfPair::orthonormalise() {
  Eigen::Matrix2d r = Eigen::Matrix2d::Zero();
  r(0, 0) = plane_.col(0).norm();
  plane_.col(0) /= r(0, 0);
  r(0, 1) = plane_.col(0).dot(plane_.col(1));
  plane_.col(1) -= r(0, 1) * plane_.col(0);
  r(1, 1) = plane_.col(1).norm();
  plane_.col(1) /= r(1, 1);
  Eigen::Matrix2d inverse;
  inverse << 1.0 / r(0, 0), -r(0, 1) / (r(0, 0) * r(1, 1)), 0.0, 1.0 / r(1, 1);
  pair_ = r * pair_ * inverse;
}

/// Of (V, L), both column by column.
Eigen::MatrixXd HopfPair::newton_matrix(const Plane& border) const {
  const Eigen::Index n = plane_.rows();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(2 * n + 4, 2 * n + 4);
  for (int k = 0; k < 2; ++k) {
    matrix.block(k * n, k * n, n, n) = jacobian_;
    for (int j = 0; j < 2; ++j) {
      matrix.block(k * n, j * n, n, n).diagonal().array() -= pair_(j, k);
      matrix.block(k * n, 2 * n + 2 * k + j, n, 1) = -plane_.col(j);
    }
    matrix.block(2 * n + 2 * k, k * n, 2, n) = border.transpose();
  }
  return matrix;
}

bool HopfPair::find_plane() {
  constexpr int most_iterations = 12;
  constexpr double tolerance = 1e-13;
  const Eigen::Index n = plane_.rows();
  const Plane border = plane_;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    Eigen::VectorXd defect(2 * n + 4);
    const Plane rest = jacobian_ * plane_ - plane_ * pair_;
    const Eigen::Matrix2d distance = border.transpose() * plane_ - Eigen::Matrix2d::Identity();
    defect << rest.col(0), rest.col(1), distance.col(0), distance.col(1);
    const Eigen::VectorXd change = solve(newton_matrix(border), -defect);
    if (!change.allFinite()) return false;
    plane_.col(0) += change.segment(0, n);
    plane_.col(1) += change.segment(n, n);
    pair_.col(0) += change.segment(2 * n, 2);
    pair_.col(1) += change.segment(2 * n + 2, 2);
    const double size = change.head(2 * n).norm() + change.tail(4).norm() / (1.0 + pair_.norm());
    if (size < tolerance) return true;
    if (size < 1e-6 && iteration + 1 == most_iterations) return true;
  }
  return false;
}

/// -w^T (d f_x) v.
void HopfPair::add_gradient(const Orbit& x, const Eigen::VectorXd& v, const Eigen::VectorXd& w) {
  std::copy(v.begin(), v.end(), direction_.begin());
  system_.system().second(FunctionKind::field, system_.signature().front().field, x.end(0), x.par.data(),
                          system_.free_parameters(), direction_.data(), field_.data(), by_state_.data(),
                          by_parameter_.data());
  gradient_.states.col(gradient_.states.cols() - 1) -= by_state_.transpose() * w;
  gradient_.globals -= by_parameter_.transpose() * w;
}

bool HopfPair::evaluate(CondensedSystem&, const Orbit& x) {
  const Eigen::Index n = plane_.rows();
  system_.system().first(FunctionKind::field, system_.signature().front().field, x.end(0), x.par.data(), {},
                         field_.data(), jacobian_.data(), nullptr);
  if (!jacobian_.allFinite() || (!started_ && !begin()) || !find_plane()) return false;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * n + 4);
  right(2 * n) = 1.0;
  right(2 * n + 3) = 1.0;
  const Eigen::VectorXd w = solve(newton_matrix(plane_).transpose(), right);
  gradient_.set_zero();
  for (int k = 0; k < 2; ++k) add_gradient(x, plane_.col(k), w.segment(k * n, n));
  orthonormalise();
  return gradient_.states.allFinite() && gradient_.globals.allFinite();
}

}  // namespace tchat
