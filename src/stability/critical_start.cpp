#include "stability/critical_start.hpp"

#include <Eigen/Eigenvalues>

namespace tchat {

std::optional<CriticalStart> critical_start(const Eigen::MatrixXd& k, double mu_0, std::complex<double> wanted) {
  const Eigen::EigenSolver<Eigen::MatrixXd> right(k), left(k.transpose());
  if (right.info() != Eigen::Success || left.info() != Eigen::Success) return std::nullopt;
  const auto nearest = [&](const Eigen::VectorXcd& values) {
    Eigen::Index at = 0;
    (values.array() - 1.0 / (mu_0 - wanted)).abs().minCoeff(&at);
    return at;
  };
  const Eigen::Index at = nearest(right.eigenvalues());
  constexpr double near = 1e-2;
  CriticalStart found{mu_0 - 1.0 / right.eigenvalues()(at), right.eigenvectors().col(at),
                      left.eigenvectors().col(nearest(left.eigenvalues()))};
  if (!(std::abs(found.multiplier - wanted) < near)) return std::nullopt;
  Eigen::Index largest = 0;
  found.right.cwiseAbs().maxCoeff(&largest);
  found.right *= std::abs(found.right(largest)) / found.right(largest) / found.right.norm();
  found.left /= (found.left.transpose() * found.right).value();
  return found.left.allFinite() ? std::optional(std::move(found)) : std::nullopt;
}

}  // namespace tchat
