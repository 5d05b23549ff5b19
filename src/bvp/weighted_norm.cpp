#include "bvp/weighted_norm.hpp"

#include "linear_algebra/array_kernel.hpp"

namespace tchat {

WeightedNorm::WeightedNorm(Eigen::VectorXd state_weights, Eigen::VectorXd parameter_weights)
    : state_weights_(std::move(state_weights)), parameter_weights_(std::move(parameter_weights)) {}

WeightedNorm WeightedNorm::unit(int dimension) {
  return {Eigen::VectorXd::Ones(dimension), Eigen::VectorXd::Ones(parameter_length)};
}

void add_mass(const Orbit& x, const CollocationRule& rule, const Eigen::VectorXd& weights, const double* v,
              double* row) {
  const int c = x.shape.collocation;
  const int n = x.shape.dimension;
  for (int j = 0; j < x.shape.intervals; ++j) {
    const double h = x.mesh[static_cast<std::size_t>(j + 1)] - x.mesh[static_cast<std::size_t>(j)];
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(j) * c * n;
    array_functions().add_mass(h, rule.mass.data(), c + 1, weights.data(), n, v + first, row + first);
  }
}

void WeightedNorm::dual(const Orbit& x, const CollocationRule& rule, const std::vector<int>& free_parameters,
                        const OrbitVector& v, OrbitVector& row) const {
  for (int s = 0; s < x.shape.segments; ++s) {
    const int first = s * x.shape.nodes();
    row.states.middleCols(first, x.shape.nodes()).setZero();  // not all at once, to find it in the cache
    add_mass(x, rule, state_weights_, v.states.col(first).data(), row.states.col(first).data());
    row.durations(s) = parameter_weights_(first_duration - 1 + s) * v.durations(s);
  }
  for (std::size_t g = 0; g < free_parameters.size(); ++g) {
    const auto i = static_cast<Eigen::Index>(g);
    row.globals(i) = parameter_weights_(free_parameters[g] - 1) * v.globals(i);
  }
}

}  // namespace tchat
