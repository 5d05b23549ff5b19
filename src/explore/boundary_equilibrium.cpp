#include "explore/boundary_equilibrium.hpp"

#include "files/solution_file_reader.hpp"

namespace tchat {

int other_field_at_rest(const HybridSystem& system, const LabelledSolution& solution, int field) {
  constexpr double at_rest = 1e-6;  // a located point is known to EPSS
  const LabelledSolution own = in_layout(solution, system.layout());
  const int n = system.dimension();
  if (own.states.rows() < n || own.states.cols() < 1) return 0;
  const Eigen::VectorXd x = own.states.col(0).head(n);
  for (int i = 1; i <= system.count(FunctionKind::field); ++i) {
    if (i == field) continue;
    Eigen::VectorXd f(n);
    system.value(FunctionKind::field, i, x.data(), own.parameters.data(), f.data());
    if (f.norm() <= at_rest * (1.0 + x.norm())) return i;
  }
  return 0;
}

}  // namespace tchat
