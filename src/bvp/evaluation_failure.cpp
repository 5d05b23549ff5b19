#include "bvp/evaluation_failure.hpp"

#include <fmt/format.h>

#include <vector>

namespace tchat {

namespace {

bool is_finite_at(const DefiningSystem& defining, FunctionKind kind, int index, const double* x, const double* par) {
  const int n = defining.dimension();
  const int rows = defining.system().rows(kind);
  const int free = defining.free_count();
  std::vector<double> value(static_cast<std::size_t>(rows));
  std::vector<double> by_state(static_cast<std::size_t>(rows * n));
  std::vector<double> by_parameter(static_cast<std::size_t>(rows * free) + 1);
  defining.system().first(kind, index, x, par, defining.free_parameters(), value.data(), by_state.data(),
                          by_parameter.data());
  return all_finite(value.data(), rows) && all_finite(by_state.data(), rows * n) &&
         all_finite(by_parameter.data(), rows * free);
}

std::string place(const HybridSystem& system, FunctionKind kind, int index, int s, double tau, const double* x) {
  const char* kinds[] = {"vector field", "event function", "jump function", "integrand"};
  std::string state;
  for (int k = 1; k <= system.dimension(); ++k)
    state += fmt::format("{}{} = {:.6g}", k > 1 ? ", " : "", system.state_name(k), x[k - 1]);
  return fmt::format("{} {} ({}) or a derivative of it is not finite on segment {} at tau = {:.6g}, {}",
                     kinds[static_cast<int>(kind)], index, system.function_name(kind, index), s + 1, tau, state);
}

}  // namespace

std::string function_failure(const DefiningSystem& defining, FunctionKind kind, int index, int s, double tau,
                             const double* x, const double* par) {
  return is_finite_at(defining, kind, index, x, par) ? "" : place(defining.system(), kind, index, s, tau, x);
}

std::string evaluation_failure(const DefiningSystem& defining, const CollocationRule& rule, const Orbit& x) {
  const double* par = x.par.data();
  const int c = x.shape.collocation;
  for (int s = 0; s < x.shape.segments; ++s) {
    const IndexVector& v = defining.signature()[static_cast<std::size_t>(s)];
    for (int j = 0; j < x.shape.intervals; ++j) {
      const auto nodes = x.states.middleCols(s * x.shape.nodes() + j * c, c + 1);
      const double left = x.mesh[static_cast<std::size_t>(j)];
      const double h = x.mesh[static_cast<std::size_t>(j + 1)] - left;
      for (int g = 0; g < c; ++g) {
        const Eigen::VectorXd point = nodes * rule.value.row(g).transpose();
        const double tau = left + h * rule.gauss(g);
        const std::string field = function_failure(defining, FunctionKind::field, v.field, s, tau, point.data(), par);
        if (!field.empty()) return field;
        const std::string integrand = defining.integral_failure(s, tau, point.data(), par);
        if (!integrand.empty()) return integrand;
      }
    }
    if (const std::string ends = defining.coupling_failure(s, x); !ends.empty()) return ends;
  }
  return "";
}

}  // namespace tchat
