#include "bvp/mesh_adaptation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "bvp/with_dimension.hpp"

namespace tchat {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

double length(const std::vector<double>& mesh, int j) { return mesh[index(j + 1)] - mesh[index(j)]; }

/// Estimates of |u^(c+1)| of every component of segment s on every interval: n x N. On a single interval no jump of the
/// c-th derivative tells of the next one: it is taken for as large as one that falls to zero over the interval.
Eigen::MatrixXd highest_derivatives(const Orbit& x, const CollocationRule& rule, int s) {
  const OrbitShape& shape = x.shape;
  const int c = shape.collocation;
  const int intervals = shape.intervals;
  Eigen::MatrixXd level(shape.dimension, intervals);  // c-th derivatives, constant on each interval
  for (int j = 0; j < intervals; ++j) {
    const auto nodes = x.states.middleCols(s * shape.nodes() + j * c, c + 1);
    level.col(j) = nodes * rule.highest / std::pow(length(x.mesh, j), c);
  }
  if (intervals == 1) return level.cwiseAbs() / length(x.mesh, 0);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(shape.dimension, intervals);
  Eigen::MatrixXd jump(shape.dimension, intervals - 1);  // at interior mesh points
  for (int j = 0; j + 1 < intervals; ++j)
    jump.col(j) = (level.col(j + 1) - level.col(j)).cwiseAbs() / (0.5 * (length(x.mesh, j) + length(x.mesh, j + 1)));
  result.col(0) = jump.col(0);
  result.col(intervals - 1) = jump.col(intervals - 2);
  for (int j = 1; j + 1 < intervals; ++j) result.col(j) = 0.5 * (jump.col(j - 1) + jump.col(j));
  return result;
}

}  // namespace

std::vector<double> equal_parts(const std::vector<double>& mesh, const Eigen::VectorXd& density, int parts) {
  const int intervals = static_cast<int>(mesh.size()) - 1;
  std::vector<double> cumulative(mesh.size(), 0.0);
  for (int j = 0; j < intervals; ++j) cumulative[index(j + 1)] = cumulative[index(j)] + density(j) * length(mesh, j);
  std::vector<double> result(index(parts + 1));
  int j = 0;
  for (int k = 1; k < parts; ++k) {
    const double wanted = cumulative.back() * k / parts;
    while (j < intervals - 1 && cumulative[index(j + 1)] < wanted) ++j;
    const double share = (wanted - cumulative[index(j)]) / (cumulative[index(j + 1)] - cumulative[index(j)]);
    result[index(k)] = mesh[index(j)] + share * length(mesh, j);
  }
  result.front() = 0.0;
  result.back() = 1.0;
  return result;
}

std::vector<double> equidistributed_mesh(const Orbit& x, const CollocationRule& rule, int intervals) {
  const double power = 1.0 / (x.shape.collocation + 1);
  // Derivatives below this count as zero, so that a constant solution keeps a uniform mesh.
  const double negligible = 1e-7;
  Eigen::VectorXd monitor = Eigen::VectorXd::Zero(x.shape.intervals);
  for (int s = 0; s < x.shape.segments; ++s) {
    if (x.duration(s) == 0.0) continue;
    const Eigen::MatrixXd derivatives = highest_derivatives(x, rule, s);
    if (derivatives.maxCoeff() < negligible) continue;
    monitor += derivatives.array().pow(power).matrix().colwise().sum().transpose();
  }
  const double peak = monitor.size() > 0 ? monitor.maxCoeff() : 0.0;
  if (!(peak > 0.0) || !std::isfinite(peak)) {
    monitor.setOnes();
  } else {
    // Two sweeps of smoothing keep neighbouring intervals comparable; a floor keeps every interval finite.
    for (int sweep = 0; sweep < 2; ++sweep) {
      const Eigen::VectorXd old = monitor;
      for (Eigen::Index j = 1; j + 1 < old.size(); ++j) monitor(j) = 0.25 * (old(j - 1) + 2.0 * old(j) + old(j + 1));
    }
    monitor = monitor.cwiseMax(1e-3 * peak);
  }
  return equal_parts(x.mesh, monitor, intervals);
}

std::vector<double> resampled_mesh(const std::vector<double>& mesh, int intervals) {
  const int old = static_cast<int>(mesh.size()) - 1;
  if (old == intervals) return mesh;
  Eigen::VectorXd density(old);
  for (int j = 0; j < old; ++j) density(j) = 1.0 / length(mesh, j);
  return equal_parts(mesh, density, intervals);
}

MeshTransfer::MeshTransfer(const OrbitShape& from, const std::vector<double>& from_mesh, const OrbitShape& to,
                           const std::vector<double>& to_mesh, const CollocationRule& rule)
    : from_(from), to_(to), first_(index(to.nodes())), weights_(from.collocation + 1, to.nodes()) {
  assert(rule.points() == from.collocation);
  int j = 0;
  for (int k = 0; k < to.nodes(); ++k) {
    const int interval = std::min(k / to.collocation, to.intervals - 1);
    const double share = static_cast<double>(k - interval * to.collocation) / to.collocation;
    const double tau = to_mesh[index(interval)] + share * length(to_mesh, interval);
    while (j + 1 < from.intervals && from_mesh[index(j + 1)] <= tau) ++j;
    first_[index(k)] = j * from.collocation;
    rule.basis((tau - from_mesh[index(j)]) / length(from_mesh, j), weights_.col(k).data(), nullptr);
  }
}

Eigen::MatrixXd MeshTransfer::operator()(const Eigen::MatrixXd& states) const {
  Eigen::MatrixXd result(to_.dimension, to_.columns());
  with_dimension(to_.dimension, [&](auto n) {
    const int last = from_.collocation;
    double* value = result.data();
    for (int s = 0; s < to_.segments; ++s)
      for (int k = 0; k < to_.nodes(); ++k, value += n) {
        const double* nodes = states.col(s * from_.nodes() + first_[index(k)]).data();
        const double* weights = weights_.col(k).data();
        for (int a = 0; a < n; ++a) value[a] = weights[0] * nodes[a];
        for (int i = 1; i <= last; ++i)
          for (int a = 0; a < n; ++a) value[a] += weights[i] * nodes[i * n + a];
      }
  });
  return result;
}

Eigen::MatrixXd interpolate_states(const Eigen::MatrixXd& states, const OrbitShape& from,
                                   const std::vector<double>& from_mesh, const OrbitShape& to,
                                   const std::vector<double>& to_mesh) {
  return MeshTransfer(from, from_mesh, to, to_mesh, CollocationRule(from.collocation))(states);
}

double estimated_error(const Orbit& x, const CollocationRule& rule) {
  const int c = x.shape.collocation;
  double worst = 0.0;
  for (int s = 0; s < x.shape.segments; ++s) {
    if (x.duration(s) == 0.0) continue;
    const Eigen::MatrixXd derivatives = highest_derivatives(x, rule, s);
    for (int j = 0; j < x.shape.intervals; ++j)
      worst = std::max(worst, derivatives.col(j).maxCoeff() * std::pow(length(x.mesh, j), c + 1));
  }
  return rule.interpolation * worst / (1.0 + x.states.cwiseAbs().maxCoeff());
}

}  // namespace tchat
