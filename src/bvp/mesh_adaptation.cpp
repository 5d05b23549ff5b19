#include "bvp/mesh_adaptation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "linear_algebra/array_kernel.hpp"

namespace tchat {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

double length(const std::vector<double>& mesh, int j) { return mesh[index(j + 1)] - mesh[index(j)]; }

/// A node's value is known to a few roundings of its component: those of its own sum and of the equations behind it.
constexpr double roundings_of_a_node = 4.0;
/// Equations couple a component with larger ones, whose roundings reach it: none is taken for smaller than this share
/// of the largest.
constexpr double least_share = 1e-3;

double power(double base, int exponent) {
  double result = base;
  for (int k = 1; k < exponent; ++k) result *= base;
  return result;
}

/// Estimates of |u^(c+1)| of every component of segment s on every interval: n x N. On a single interval the jump of
/// the c-th derivative is unknown; it is estimated as if the derivative fell to zero over the interval. `level` is
/// scratch.
void find_highest_derivatives(const Orbit& x, const CollocationRule& rule, int s, Eigen::MatrixXd& level,
                              Eigen::MatrixXd& result) {
  const int n = x.shape.dimension;
  const int c = x.shape.collocation;
  const int intervals = x.shape.intervals;
  level.resize(n, intervals);  // c-th derivatives, constant on each interval
  result.resize(n, intervals);
  array_functions().interpolate({rule.highest.data(), 1, c, n, intervals}, x.node(s, 0), level.data(), n);
  for (int j = 0; j < intervals; ++j) {
    const double scale = power(length(x.mesh, j), c);
    for (int a = 0; a < n; ++a) level(a, j) /= scale;
  }
  if (intervals == 1) {
    result = level.cwiseAbs() / length(x.mesh, 0);
    return;
  }
  // Of the jumps at the mesh points at the two ends of an interval the mean; where there is one, that one.
  for (int j = 0; j + 1 < intervals; ++j) {
    const double distance = 0.5 * (length(x.mesh, j) + length(x.mesh, j + 1));
    for (int a = 0; a < n; ++a) {
      const double jump = std::abs(level(a, j + 1) - level(a, j)) / distance;
      result(a, j) = j == 0 ? jump : 0.5 * (result(a, j) + jump);
      result(a, j + 1) = jump;
    }
  }
}

/// The size of every component on the whole orbit.
void find_component_sizes(const Orbit& x, Eigen::VectorXd& sizes) {
  const int n = x.shape.dimension;
  sizes.setZero(n);
  for (Eigen::Index k = 0; k < x.states.cols(); ++k)
    for (int a = 0; a < n; ++a) sizes(a) = std::max(sizes(a), std::abs(x.states(a, k)));
  const double least = least_share * sizes.maxCoeff();
  for (double& size : sizes) size = std::max(size, least);
}

/// What rounding alone makes of these estimates, n x N. Rounding of size delta at the nodes changes the c-th derivative
/// sum_i highest_i u_i / h^c by up to delta sum_i |highest_i| / h^c = delta (2 c)^c / h^c, its jump between two
/// intervals by twice that, and the jump is divided by h once more:
///
///     2 delta (2 c)^c / h^(c+1),   delta = a few units in the last place of the component.
void find_rounding(const Orbit& x, const CollocationRule& rule, const Eigen::VectorXd& sizes, Eigen::MatrixXd& result) {
  const double of_a_node = roundings_of_a_node * std::numeric_limits<double>::epsilon();
  const double factor = 2.0 * rule.highest.cwiseAbs().sum();
  result.resize(x.shape.dimension, x.shape.intervals);
  for (int j = 0; j < x.shape.intervals; ++j)
    result.col(j) = of_a_node * factor / power(length(x.mesh, j), x.shape.collocation + 1) * sizes;
}

/// The largest integral of a density, constant on each interval of `old`, over an interval of `mesh`.
double largest_share(const Eigen::VectorXd& density, const std::vector<double>& old, const std::vector<double>& mesh) {
  double largest = 0.0;
  int j = 0;
  for (std::size_t i = 0; i + 1 < mesh.size(); ++i) {
    double share = 0.0;
    for (double from = mesh[i]; from < mesh[i + 1];) {
      while (j + 1 < density.size() && old[index(j + 1)] <= from) ++j;
      const double to = j + 1 < density.size() ? std::min(mesh[i + 1], old[index(j + 1)]) : mesh[i + 1];
      share += density(j) * (to - from);
      from = to;
    }
    largest = std::max(largest, share);
  }
  return largest;
}

/// equal_parts() into `result`; `cumulative` is scratch.
void split(const std::vector<double>& mesh, const Eigen::VectorXd& density, int parts, std::vector<double>& cumulative,
           std::vector<double>& result) {
  const int intervals = static_cast<int>(mesh.size()) - 1;
  cumulative.assign(mesh.size(), 0.0);
  for (int j = 0; j < intervals; ++j) cumulative[index(j + 1)] = cumulative[index(j)] + density(j) * length(mesh, j);
  result.resize(index(parts + 1));
  int j = 0;
  for (int k = 1; k < parts; ++k) {
    const double wanted = cumulative.back() * k / parts;
    while (j < intervals - 1 && cumulative[index(j + 1)] < wanted) ++j;
    const double share = (wanted - cumulative[index(j)]) / (cumulative[index(j + 1)] - cumulative[index(j)]);
    result[index(k)] = mesh[index(j)] + share * length(mesh, j);
  }
  result.front() = 0.0;
  result.back() = 1.0;
}

}  // namespace

std::vector<double> equal_parts(const std::vector<double>& mesh, const Eigen::VectorXd& density, int parts) {
  std::vector<double> cumulative, result;
  split(mesh, density, parts, cumulative, result);
  return result;
}

/// |u^(c+1)| of all components of all segments that last. Where the estimates of a component are rounding on every
/// interval of a segment (a polynomial of degree c, or one resolved to rounding), it does not count. An estimate of
/// another one counts for at least its rounding, whose (c+1)-th root is proportional to 1 / h: where an error is too
/// small to be seen, the mesh stays.
void MeshEquidistribution::add_segment(const Orbit& x) {
  const double root = 1.0 / (x.shape.collocation + 1);
  for (int k = 0; k < x.shape.dimension; ++k) {
    if ((derivatives_.row(k).array() <= rounding_.row(k).array()).all()) continue;
    ++known_;
    for (int j = 0; j < x.shape.intervals; ++j) {
      const double derivative = std::max(derivatives_(k, j), rounding_(k, j));
      monitor_(j) += std::pow(derivative, root);
      largest_(j) = std::max(largest_(j), derivative / sizes_(k));
    }
  }
}

/// False where no derivative is known.
bool MeshEquidistribution::find_monitor(const Orbit& x, const CollocationRule& rule) {
  find_component_sizes(x, sizes_);
  find_rounding(x, rule, sizes_, rounding_);
  monitor_.setZero(x.shape.intervals);
  largest_.setZero(x.shape.intervals);
  known_ = 0;
  for (int s = 0; s < x.shape.segments; ++s) {
    if (x.duration(s) == 0.0) continue;
    find_highest_derivatives(x, rule, s, level_, derivatives_);
    add_segment(x);
  }
  return known_ > 0 && array_functions().range(monitor_.data(), monitor_.size()).finite;
}

/// Two sweeps keep neighbouring intervals comparable; a floor keeps every interval finite.
void MeshEquidistribution::smooth_monitor() {
  for (int sweep = 0; sweep < 2; ++sweep) {
    smoothed_ = monitor_;
    for (Eigen::Index j = 1; j + 1 < monitor_.size(); ++j)
      smoothed_(j) = 0.25 * (monitor_(j - 1) + 2.0 * monitor_(j) + monitor_(j + 1));
    monitor_.swap(smoothed_);
  }
  const double least = 1e-3 * monitor_.maxCoeff();
  for (double& value : monitor_) value = std::max(value, least);
}

const std::vector<double>& MeshEquidistribution::mesh(const Orbit& x, const CollocationRule& rule, int intervals) {
  if (!find_monitor(x, rule)) return adapted_ = resampled_mesh(x.mesh, intervals);
  smooth_monitor();
  split(x.mesh, monitor_, intervals, cumulative_, adapted_);
  // The sum over components equidistributes none of them by itself. The local error on an interval is the (c+1)-th
  // power of the integral of |u^(c+1)|^(1/(c+1)).
  for (double& value : largest_) value = std::pow(value, 1.0 / (x.shape.collocation + 1));
  if (uniform_.size() != index(intervals + 1)) uniform_ = uniform_mesh(intervals);
  const bool is_better = largest_share(largest_, x.mesh, adapted_) <= largest_share(largest_, x.mesh, uniform_);
  return is_better ? adapted_ : uniform_;
}

std::vector<double> equidistributed_mesh(const Orbit& x, const CollocationRule& rule, int intervals) {
  return MeshEquidistribution().mesh(x, rule, intervals);
}

std::vector<double> resampled_mesh(const std::vector<double>& mesh, int intervals) {
  const int old = static_cast<int>(mesh.size()) - 1;
  if (old == intervals) return mesh;
  Eigen::VectorXd density(old);
  for (int j = 0; j < old; ++j) density(j) = 1.0 / length(mesh, j);
  return equal_parts(mesh, density, intervals);
}

MeshTransfer::MeshTransfer(const OrbitShape& from, const std::vector<double>& from_mesh, const OrbitShape& to,
                           const std::vector<double>& to_mesh, const CollocationRule& rule) {
  set(from, from_mesh, to, to_mesh, rule);
}

void MeshTransfer::set(const OrbitShape& from, const std::vector<double>& from_mesh, const OrbitShape& to,
                       const std::vector<double>& to_mesh, const CollocationRule& rule) {
  assert(rule.points() == from.collocation);
  from_ = from;
  to_ = to;
  first_.resize(index(to.nodes()));
  weights_.resize(from.collocation + 1, to.nodes());
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

void MeshTransfer::operator()(const Eigen::MatrixXd& states, Eigen::MatrixXd& result) const {
  result.resize(to_.dimension, to_.columns());
  const NodeCombinations combinations{weights_.data(), first_.data(), to_.nodes(), from_.collocation, to_.dimension};
  for (int s = 0; s < to_.segments; ++s)
    array_functions().combine_nodes(combinations, states.col(s * from_.nodes()).data(),
                                    result.col(s * to_.nodes()).data());
}

Eigen::MatrixXd MeshTransfer::operator()(const Eigen::MatrixXd& states) const {
  Eigen::MatrixXd result;
  (*this)(states, result);
  return result;
}

Eigen::MatrixXd interpolate_states(const Eigen::MatrixXd& states, const OrbitShape& from,
                                   const std::vector<double>& from_mesh, const OrbitShape& to,
                                   const std::vector<double>& to_mesh) {
  return MeshTransfer(from, from_mesh, to, to_mesh, CollocationRule(from.collocation))(states);
}

double estimated_interpolation_error(const Orbit& x, const CollocationRule& rule) {
  const int c = x.shape.collocation;
  double worst = 0.0;
  Eigen::MatrixXd level, derivatives;
  for (int s = 0; s < x.shape.segments; ++s) {
    if (x.duration(s) == 0.0) continue;
    find_highest_derivatives(x, rule, s, level, derivatives);
    for (int j = 0; j < x.shape.intervals; ++j)
      worst = std::max(worst, derivatives.col(j).maxCoeff() * power(length(x.mesh, j), c + 1));
  }
  return rule.interpolation * worst / (1.0 + x.states.cwiseAbs().maxCoeff());
}

}  // namespace tchat
