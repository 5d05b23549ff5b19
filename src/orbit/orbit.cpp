#include "orbit/orbit.hpp"

#include <algorithm>
#include <limits>

#include "base/levels.hpp"
#include "linear/array_kernel.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"

namespace tchat {

OwnIntervals::OwnIntervals(const std::vector<int>& counts) {
  std::vector<int> starts{0};
  for (const int count : counts) starts.push_back(starts.back() + count);
  starts_ = std::make_shared<const std::vector<int>>(std::move(starts));
}

OrbitShape OrbitShape::with_own_meshes() const {
  OrbitShape result = *this;
  result.own = OwnIntervals(std::vector<int>(static_cast<std::size_t>(segments), intervals));
  return result;
}

double Orbit::tau(int s, int k) const {
  const int c = shape.collocation;
  const int i = k % c;
  const double* const left = mesh_of(s) + k / c;
  return i == 0 ? *left : *left + (left[1] - *left) * i / c;
}

std::vector<double> Orbit::node_times() const {
  std::vector<double> times(static_cast<std::size_t>(shape.nodes()));
  for (int k = 0; k < shape.nodes(); ++k) times[static_cast<std::size_t>(k)] = tau(k);
  return times;
}

std::vector<double> uniform_mesh(int intervals) {
  std::vector<double> mesh(static_cast<std::size_t>(intervals) + 1);
  for (int j = 0; j <= intervals; ++j) mesh[static_cast<std::size_t>(j)] = static_cast<double>(j) / intervals;
  return mesh;
}

std::vector<double> uniform_mesh(const OrbitShape& shape) {
  if (!shape.own) return uniform_mesh(shape.intervals);
  std::vector<double> mesh;
  for (int s = 0; s < shape.segments; ++s) {
    const std::vector<double> of_segment = uniform_mesh(shape.intervals_of(s));
    mesh.insert(mesh.end(), of_segment.begin(), of_segment.end());
  }
  return mesh;
}

OrbitVector::OrbitVector(const OrbitShape& shape, int global_count)
    : states(Eigen::MatrixXd::Zero(shape.dimension, shape.columns())),
      durations(Eigen::VectorXd::Zero(shape.segments)),
      globals(Eigen::VectorXd::Zero(global_count)) {}

void OrbitVector::set_zero() {
  states.setZero();
  durations.setZero();
  globals.setZero();
}

void OrbitVector::scale(double factor) {
  states *= factor;
  durations *= factor;
  globals *= factor;
}

double dot(const OrbitVector& row, const OrbitVector& v) {
  return array_functions().dot(row.states.data(), v.states.data(), row.states.size()) + row.durations.dot(v.durations) +
         row.globals.dot(v.globals);
}

double dot_of_sizes(const OrbitVector& row, const OrbitVector& v) {
  return row.states.cwiseProduct(v.states).cwiseAbs().sum() + row.durations.cwiseProduct(v.durations).cwiseAbs().sum() +
         row.globals.cwiseProduct(v.globals).cwiseAbs().sum();
}

std::pair<double, double> dot_both(const OrbitVector& row, const OrbitVector& v, const OrbitVector& w) {
  double sums[2];
  array_functions().dot_both(row.states.data(), v.states.data(), w.states.data(), row.states.size(), sums);
  return {sums[0] + row.durations.dot(v.durations) + row.globals.dot(v.globals),
          sums[1] + row.durations.dot(w.durations) + row.globals.dot(w.globals)};
}

void advance(Orbit& x, double step, const OrbitVector& v, const std::vector<int>& free_parameters) {
  array_functions().add(step, v.states.data(), x.states.data(), x.states.size());
  advance_parameters(x, step, v, free_parameters);
}

void advance_parameters(Orbit& x, double step, const OrbitVector& v, const std::vector<int>& free_parameters) {
  for (int s = 0; s < x.shape.segments; ++s) x.duration(s) += step * v.durations(s);
  for (std::size_t g = 0; g < free_parameters.size(); ++g)
    x.par(free_parameters[g] - 1) += step * v.globals(static_cast<Eigen::Index>(g));
}

double dot_difference(const OrbitVector& row, const Orbit& x, const Orbit& base,
                      const std::vector<int>& free_parameters) {
  double sum =
      array_functions().dot_difference(row.states.data(), x.states.data(), base.states.data(), row.states.size());
  for (int s = 0; s < x.shape.segments; ++s) sum += row.durations(s) * (x.duration(s) - base.duration(s));
  for (std::size_t g = 0; g < free_parameters.size(); ++g) {
    const int k = free_parameters[g] - 1;
    sum += row.globals(static_cast<Eigen::Index>(g)) * (x.par(k) - base.par(k));
  }
  return sum;
}

double event_scale(const HybridSystem& system, const Orbit& x, int event) {
  // One state says nothing of the sizes that h has.
  if (x.shape.stored_nodes() == 1) return event_at(system, event, x.end(0), x.par.data()).scale(x.end(0));
  double largest = 0.0;
  for (int s = 0; s < x.shape.segments; ++s)
    for (int k = 0; k < x.shape.nodes_of(s); k += x.shape.collocation)
      largest = std::max(largest, std::abs(system.event(event, x.node(s, k), x.par.data())));
  return largest;
}

Eigen::VectorXd state_sizes(const HybridSystem& system, const Signature& signature, const Orbit& x) {
  return known_sizes(system, signature, x).sizes();
}

StateSizes known_sizes(const HybridSystem& system, const Signature& signature, const Orbit& x,
                       const Eigen::MatrixXd* change) {
  constexpr int parts = 16;
  const double* const par = x.par.data();
  StateSizes sizes(change == nullptr ? x.states : Eigen::MatrixXd(x.states.cwiseAbs() + change->cwiseAbs()));
  if (x.shape.stored_nodes() == 1 && change == nullptr) {
    sizes.add_at_rest(system, signature.front().field, x.start(0), par);
    return sizes;
  }
  for (int s = 0; s < x.shape.segments; ++s) {
    const IndexVector& v = signature[static_cast<std::size_t>(s) % signature.size()];
    const int nodes = x.shape.nodes_of(s);
    for (int k = 0; k < nodes; k += std::max(1, nodes / parts))
      sizes.add(system, FunctionKind::field, v.field, x.node(s, k), par);
    sizes.add(system, FunctionKind::jump, v.jump, x.end(s), par);
    if (v.event != no_function) sizes.add(system, FunctionKind::event, v.event, x.end(s), par);
  }
  return sizes;
}

Eigen::VectorXd state_uncertainty(const Orbit& x) {
  const Eigen::VectorXd sizes = x.states.cwiseAbs().rowwise().maxCoeff();
  const double least = std::max(level::rounding * sizes.maxCoeff(), std::numeric_limits<double>::min());
  return (orbit_accuracy * sizes).cwiseMax(least);
}

double relative_event(const HybridSystem& system, int event, const Eigen::VectorXd& state, const double* par,
                      const Eigen::VectorXd& sizes) {
  const EventAt at = event_at(system, event, state.data(), par);
  const double scale = at.scale(state.data(), sizes);  // 0 where h depends on parameters alone
  return std::abs(at.h) / (scale > 0.0 ? scale : 1.0);
}

}  // namespace tchat
