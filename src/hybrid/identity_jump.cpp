#include "hybrid/identity_jump.hpp"

#include <cmath>

#include "hybrid/parameter_vector.hpp"

namespace tchat {

bool is_identity_jump(const HybridSystem& system, int k) {
  const int n = system.dimension();
  ParameterVector par = ParameterVector::Zero(parameter_length);
  for (int i = 0; i < system.parameters(); ++i) par(i) = 0.37 + 0.11 * i;
  Eigen::VectorXd x(n);
  Eigen::VectorXd g(n);
  for (int trial = 0; trial < 2; ++trial) {
    for (int i = 0; i < n; ++i) x(i) = std::sin(1.3 + i + 2.1 * trial);
    system.value(FunctionKind::jump, k, x.data(), par.data(), g.data());
    if (!((g - x).cwiseAbs().maxCoeff() <= 1e-12)) return false;
  }
  return true;
}

}  // namespace tchat
