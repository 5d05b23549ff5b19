#include "model/identity_jump.hpp"

#include <cmath>

#include "model/parameter_vector.hpp"

namespace tchat {

namespace {

/// The first `states` states; the others are zero.
bool leaves_states(const HybridSystem& system, int k, int states) {
  const int n = system.dimension();
  ParameterVector par(system.layout());
  for (int i = 0; i < system.parameters(); ++i) par(i) = 0.37 + 0.11 * i;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd g(n);
  for (int trial = 0; trial < 2; ++trial) {
    for (int i = 0; i < states; ++i) x(i) = std::sin(1.3 + i + 2.1 * trial);
    system.value(FunctionKind::jump, k, x.data(), par.data(), g.data());
    if (!((g - x).cwiseAbs().maxCoeff() <= 1e-12)) return false;
  }
  return true;
}

}  // namespace

bool is_identity_jump(const HybridSystem& system, int k) { return leaves_states(system, k, system.dimension()); }

bool is_identity_jump(const HybridSystem& system, const IndexVector& segment) {
  return leaves_states(system, segment.jump, system.dimension_of(segment.field));
}

int first_identity_jump(const HybridSystem& system, int field) {
  for (int k = 1; k <= system.count(FunctionKind::jump); ++k)
    if (is_identity_jump(system, {field, no_function, k})) return k;
  return no_function;
}

}  // namespace tchat
