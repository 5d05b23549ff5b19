#include "orbit/nearby_equilibrium.hpp"

#include <algorithm>

#include "linear/dense_matrix.hpp"

namespace tchat {

std::optional<NearbyEquilibrium> find_equilibrium(const HybridSystem& system, int field, const Eigen::VectorXd& near,
                                                  const double* par, const std::vector<Eigen::Index>& ignored) {
  constexpr int most_steps = 20;
  constexpr double converged = 1e-10;  // relative to the sizes of x and of f_x x
  const Eigen::Index n = near.size();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < n; ++i)
    if (std::find(ignored.begin(), ignored.end(), i) == ignored.end()) kept.push_back(i);
  Eigen::VectorXd x = near, f(n);
  Eigen::MatrixXd fx(n, n);
  for (int step = 0; step < most_steps; ++step) {
    system.first(FunctionKind::field, field, x.data(), par, {}, f.data(), fx.data(), nullptr);
    if (!f.allFinite() || !fx.allFinite()) return std::nullopt;
    const Eigen::MatrixXd jacobian = fx(kept, kept);
    Eigen::VectorXd value(jacobian.rows());
    for (Eigen::Index i = 0; i < value.size(); ++i) value(i) = f(kept[static_cast<std::size_t>(i)]);
    const Eigen::VectorXd dx = least_squares(jacobian, -value);
    if (!dx.allFinite()) return std::nullopt;
    for (Eigen::Index i = 0; i < dx.size(); ++i) x(kept[static_cast<std::size_t>(i)]) += dx(i);
    if (dx.norm() > converged * (1.0 + x.norm())) continue;
    // Where f_x is singular the shortest step may leave f as it is.
    if ((jacobian * dx + value).norm() > converged * (1.0 + jacobian.norm() * x.norm())) return std::nullopt;
    return NearbyEquilibrium{x, jacobian};
  }
  return std::nullopt;
}

}  // namespace tchat
