#include "model/finite_derivatives.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tchat {

std::string no_finite_derivatives(const HybridSystem& system, FunctionKind kind, int index, const Eigen::VectorXd& x) {
  return fmt::format(
      "{} has no finite derivatives at x = ({:.6g}); sqrt, cbrt, hypot and atan2 have none at zero, asin and acos none "
      "at 1 and -1: start elsewhere, or round the function off there, as sqrt(x^2 + 1e-12)",
      system.function_name(kind, index), fmt::join(x.begin(), x.end(), ", "));
}

bool has_finite_derivatives(const HybridSystem& system, FunctionKind kind, int index, const double* x,
                            const double* par) {
  const int rows = system.rows(kind);
  Eigen::VectorXd value(rows);
  Eigen::MatrixXd derivative(rows, system.dimension());
  double no_parameters = 0.0;
  system.value(kind, index, x, par, value.data());
  if (!value.allFinite()) return true;
  system.first(kind, index, x, par, {}, value.data(), derivative.data(), &no_parameters);
  return derivative.allFinite();
}

}  // namespace tchat
