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

/// Estimates of |u^(c+1)| of every component of segment s on every interval: n x N. On a single interval the jump of
/// the c-th derivative is unknown; it is estimated as if the derivative fell to zero over the interval.
Eigen::MatrixXd highest_derivatives(const Orbit& x, const CollocationRule& rule, int s) {
  const int n = x.shape.dimension;
  const int c = x.shape.collocation;
  const int intervals = x.shape.intervals;
  Eigen::MatrixXd level(n, intervals);  // c-th derivatives, constant on each interval
  array_functions().interpolate({rule.highest.data(), 1, c, n, intervals}, x.node(s, 0), level.data(), n);
  for (int j = 0; j < intervals; ++j) {
    const double power = std::pow(length(x.mesh, j), c);
    for (int a = 0; a < n; ++a) level(a, j) /= power;
  }
  if (intervals == 1) return level.cwiseAbs() / length(x.mesh, 0);
  // Of the jumps at the mesh points at the two ends of an interval the mean; where there is one, that one.
  Eigen::MatrixXd result(n, intervals);
  for (int j = 0; j + 1 < intervals; ++j) {
    const double distance = 0.5 * (length(x.mesh, j) + length(x.mesh, j + 1));
    for (int a = 0; a < n; ++a) {
      const double jump = std::abs(level(a, j + 1) - level(a, j)) / distance;
      result(a, j) = j == 0 ? jump : 0.5 * (result(a, j) + jump);
      result(a, j + 1) = jump;
    }
  }
  return result;
}

/// The size of every component on the whole orbit.
Eigen::VectorXd component_sizes(const Orbit& x) {
  const Eigen::VectorXd sizes = x.states.cwiseAbs().rowwise().maxCoeff();
  return sizes.cwiseMax(least_share * sizes.maxCoeff());
}

/// What rounding alone makes of these estimates, n x N. Rounding of size delta at the nodes changes the c-th derivative
/// sum_i highest_i u_i / h^c by up to delta sum_i |highest_i| / h^c = delta (2 c)^c / h^c, its jump between two
/// intervals by twice that, and the jump is divided by h once more:
///
///     2 delta (2 c)^c / h^(c+1),   delta = a few units in the last place of the component.
Eigen::MatrixXd rounding_of_derivatives(const Orbit& x, const CollocationRule& rule, const Eigen::VectorXd& sizes) {
  const double of_a_node = roundings_of_a_node * std::numeric_limits<double>::epsilon();
  const double factor = 2.0 * rule.highest.cwiseAbs().sum();
  Eigen::MatrixXd result(x.shape.dimension, x.shape.intervals);
  for (int j = 0; j < x.shape.intervals; ++j)
    result.col(j) = of_a_node * factor / std::pow(length(x.mesh, j), x.shape.collocation + 1) * sizes;
  return result;
}

/// |u^(c+1)| of all components of all segments that last, one a row, on every interval. Where the estimates of a
/// component are rounding on every interval of a segment (a polynomial of degree c, or one resolved to rounding), it
/// has no row. An estimate of another one counts for at least its rounding, whose (c+1)-th root is proportional to 1 /
/// h: where an error is too small to be seen, the mesh stays.
struct KnownDerivatives {
  Eigen::MatrixXd rows;
  Eigen::VectorXd sizes;  // of the component of each row
};

KnownDerivatives known_derivatives(const Orbit& x, const CollocationRule& rule) {
  const Eigen::VectorXd sizes = component_sizes(x);
  const Eigen::MatrixXd rounding = rounding_of_derivatives(x, rule, sizes);
  const Eigen::Index most = static_cast<Eigen::Index>(x.shape.segments) * x.shape.dimension;
  KnownDerivatives known{Eigen::MatrixXd(most, x.shape.intervals), Eigen::VectorXd(most)};
  Eigen::Index count = 0;
  for (int s = 0; s < x.shape.segments; ++s) {
    if (x.duration(s) == 0.0) continue;
    const Eigen::MatrixXd derivatives = highest_derivatives(x, rule, s);
    for (int k = 0; k < x.shape.dimension; ++k) {
      if ((derivatives.row(k).array() <= rounding.row(k).array()).all()) continue;
      known.rows.row(count) = derivatives.row(k).cwiseMax(rounding.row(k));
      known.sizes(count++) = sizes(k);
    }
  }
  known.rows.conservativeResize(count, Eigen::NoChange);
  known.sizes.conservativeResize(count);
  return known;
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
  const KnownDerivatives known = known_derivatives(x, rule);
  if (known.rows.rows() == 0 || !known.rows.allFinite()) return resampled_mesh(x.mesh, intervals);
  Eigen::VectorXd monitor = known.rows.array().pow(power).matrix().colwise().sum().transpose();
  // Two sweeps of smoothing keep neighbouring intervals comparable; a floor keeps every interval finite.
  for (int sweep = 0; sweep < 2; ++sweep) {
    const Eigen::VectorXd old = monitor;
    for (Eigen::Index j = 1; j + 1 < old.size(); ++j) monitor(j) = 0.25 * (old(j - 1) + 2.0 * old(j) + old(j + 1));
  }
  const std::vector<double> adapted = equal_parts(x.mesh, monitor.cwiseMax(1e-3 * monitor.maxCoeff()), intervals);
  // The sum over components equidistributes none of them by itself. The local error on an interval is the (c+1)-th
  // power of the integral of |u^(c+1)|^(1/(c+1)).
  const std::vector<double> uniform = uniform_mesh(intervals);
  const auto relative = known.sizes.cwiseInverse().asDiagonal() * known.rows;
  const Eigen::VectorXd largest = relative.eval().colwise().maxCoeff().array().pow(power).transpose();
  return largest_share(largest, x.mesh, adapted) <= largest_share(largest, x.mesh, uniform) ? adapted : uniform;
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
  for (int s = 0; s < x.shape.segments; ++s) {
    if (x.duration(s) == 0.0) continue;
    const Eigen::MatrixXd derivatives = highest_derivatives(x, rule, s);
    for (int j = 0; j < x.shape.intervals; ++j)
      worst = std::max(worst, derivatives.col(j).maxCoeff() * std::pow(length(x.mesh, j), c + 1));
  }
  return rule.interpolation * worst / (1.0 + x.states.cwiseAbs().maxCoeff());
}

}  // namespace tchat
