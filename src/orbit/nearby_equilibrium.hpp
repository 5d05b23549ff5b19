/// The equilibrium that a state is near, by Newton's method.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "model/hybrid_system.hpp"

namespace tchat {

struct NearbyEquilibrium {
  Eigen::VectorXd state;     ///< n: f_i(x, p) = 0 to rounding
  Eigen::MatrixXd jacobian;  ///< f_x there, without the rows and columns of ignored states
};

/// Of field `field` (from 1); nothing where Newton's method does not converge. Where f_x is singular the step is the
/// shortest one. States that nothing depends on (`ignored`, from 0) keep their values, and may move.
std::optional<NearbyEquilibrium> find_equilibrium(const HybridSystem& system, int field, const Eigen::VectorXd& near,
                                                  const double* par, const std::vector<Eigen::Index>& ignored);

}  // namespace tchat
