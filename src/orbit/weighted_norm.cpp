#include "orbit/weighted_norm.hpp"

namespace tchat {

WeightedNorm::WeightedNorm(Eigen::VectorXd state_weights, ParameterVector parameter_weights)
    : state_weights_(std::move(state_weights)), parameter_weights_(std::move(parameter_weights)) {}

WeightedNorm WeightedNorm::unit(const OrbitShape& shape) {
  ParameterVector parameters(ParameterLayout(), shape.segments);
  parameters.setOnes();
  return {Eigen::VectorXd::Ones(shape.dimension), std::move(parameters)};
}

MassIntervals mass_intervals(const Orbit& x, const CollocationRule& rule, const Eigen::VectorXd& weights, int s) {
  return {x.mesh_of(s),   x.shape.intervals_of(s), rule.mass.data(), x.shape.collocation + 1,
          weights.data(), x.shape.dimension};
}

double WeightedNorm::dual(const Orbit& x, const CollocationRule& rule, const std::vector<int>& free_parameters,
                          const OrbitVector& v, OrbitVector& row) const {
  GrowingDot product(row.states.data(), v.states.data());
  for (int s = 0; s < x.shape.segments; ++s) {
    const MassIntervals mass = mass_intervals(x, rule, state_weights_, s);
    const int first = x.shape.first_node(s);
    row.states.middleCols(first, x.shape.nodes_of(s)).setZero();  // not all at once, to find it in the cache
    array_functions().add_mass(mass, v.states.col(first).data(), row.states.col(first).data());
    product.grow_to(long{first + x.shape.nodes_of(s)} * x.shape.dimension);
    row.durations(s) = parameter_weights_.duration(s) * v.durations(s);
  }
  for (std::size_t g = 0; g < free_parameters.size(); ++g) {
    const auto i = static_cast<Eigen::Index>(g);
    row.globals(i) = parameter_weights_(free_parameters[g] - 1) * v.globals(i);
  }
  return product.value(row.states.size()) + row.durations.dot(v.durations) + row.globals.dot(v.globals);
}

}  // namespace tchat
