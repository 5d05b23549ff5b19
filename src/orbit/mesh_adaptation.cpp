#include "orbit/mesh_adaptation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/levels.hpp"
#include "linear/array_kernel.hpp"

namespace tchat {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

using Mesh = std::span<const double>;

Mesh mesh_of(const OrbitShape& shape, const std::vector<double>& mesh, int s) {
  return Mesh(mesh).subspan(index(shape.first_mesh_point(s)), index(shape.intervals_of(s) + 1));
}

Mesh mesh_of(const Orbit& x, int s) { return mesh_of(x.shape, x.mesh, s); }

double length(Mesh mesh, int j) { return mesh[index(j + 1)] - mesh[index(j)]; }

/// How many meshes there are: of each segment, or of all.
int patterns(const OrbitShape& shape) { return shape.own ? shape.segments : 1; }

/// A node's value is known to a few roundings of its component: those of its own sum and of the equations behind it.
constexpr double roundings_of_a_node = 4.0;
/// Equations couple a component with larger ones, whose roundings reach it: none is taken for smaller than this share
/// of the largest.
constexpr double least_share = 1e-3;

/// Density of intervals where nothing happens, as a share of the largest; what takes so many of the intervals at most.
constexpr double least_density = 1e-3, most_idle = 0.5;

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
  const int intervals = x.shape.intervals_of(s);
  const Mesh mesh = mesh_of(x, s);
  level.resize(n, intervals);  // c-th derivatives, constant on each interval
  result.resize(n, intervals);
  array_functions().interpolate({rule.highest.data(), 1, c, n, intervals}, x.node(s, 0), level.data(), n);
  for (int j = 0; j < intervals; ++j) {
    const double scale = power(length(mesh, j), c);
    for (int a = 0; a < n; ++a) level(a, j) /= scale;
  }
  if (intervals == 1) {
    result = level.cwiseAbs() / length(mesh, 0);
    return;
  }
  // Of the jumps at the mesh points at the two ends of an interval the mean; where there is one, that one.
  for (int j = 0; j + 1 < intervals; ++j) {
    const double distance = 0.5 * (length(mesh, j) + length(mesh, j + 1));
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

/// What rounding alone makes of these estimates on the mesh of segment s, n x N. Rounding of size delta at the nodes
/// changes the c-th derivative sum_i highest_i u_i / h^c by up to delta sum_i |highest_i| / h^c = delta (2 c)^c / h^c,
/// its jump between two intervals by twice that, and the jump is divided by h once more:
///
///     2 delta (2 c)^c / h^(c+1),   delta = a few units in the last place of the component.
void find_rounding(const Orbit& x, const CollocationRule& rule, int s, const Eigen::VectorXd& sizes,
                   Eigen::MatrixXd& result) {
  const Mesh mesh = mesh_of(x, s);
  const double of_a_node = roundings_of_a_node * std::numeric_limits<double>::epsilon();
  const double factor = 2.0 * rule.highest.cwiseAbs().sum();
  result.resize(x.shape.dimension, x.shape.intervals_of(s));
  for (int j = 0; j < x.shape.intervals_of(s); ++j)
    result.col(j) = of_a_node * factor / power(length(mesh, j), x.shape.collocation + 1) * sizes;
}

/// The largest integral of a density, constant on each interval of `old`, over an interval of `mesh`.
double largest_share(const Eigen::VectorXd& density, Mesh old, Mesh mesh) {
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
void split(Mesh mesh, const Eigen::VectorXd& density, int parts, std::vector<double>& cumulative,
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

std::vector<double> equal_parts(Mesh mesh, const Eigen::VectorXd& density, int parts) {
  std::vector<double> cumulative, result;
  split(mesh, density, parts, cumulative, result);
  return result;
}

/// |u^(c+1) / size of u| of all components of all segments that last. Where the estimates of a component are rounding
/// on every interval of a segment (a polynomial of degree c, or one resolved to rounding), it does not count. An
/// estimate of another one counts for at least its rounding, whose (c+1)-th root is proportional to 1 / h: where an
/// error is too small to be seen, the mesh stays.
void MeshEquidistribution::Monitor::add_segment(const OrbitShape& shape, const Eigen::VectorXd& sizes) {
  const double root = 1.0 / (shape.collocation + 1);
  for (int k = 0; k < shape.dimension; ++k) {
    if (is_rounding(k)) continue;
    ++known;
    for (Eigen::Index j = 0; j < values.size(); ++j) {
      const double derivative = std::max(derivatives(k, j), rounding(k, j)) / sizes(k);
      values(j) += std::pow(derivative, root);
      largest(j) = std::max(largest(j), derivative);
    }
  }
}

/// Two sweeps keep neighbouring intervals comparable. A floor keeps every interval finite, and takes few of the
/// intervals, however sharp the orbit is.
void MeshEquidistribution::Monitor::smooth(std::span<const double> mesh) {
  for (int sweep = 0; sweep < 2; ++sweep) {
    smoothed = values;
    for (Eigen::Index j = 1; j + 1 < values.size(); ++j)
      smoothed(j) = 0.25 * (values(j - 1) + 2.0 * values(j) + values(j + 1));
    values.swap(smoothed);
  }
  double mean = 0.0;
  for (int j = 0; j < values.size(); ++j) mean += values(j) * length(mesh, j);
  const double least = std::min(least_density * values.maxCoeff(), most_idle * mean);
  for (double& value : values) value = std::max(value, least);
}

/// That of segment `pattern`, or of all on their mesh in common. False where no derivative is known.
bool MeshEquidistribution::find_monitor(const Orbit& x, const CollocationRule& rule, int pattern) {
  Monitor& monitor = monitors_[index(pattern)];
  find_rounding(x, rule, pattern, sizes_, monitor.rounding);
  monitor.values.setZero(x.shape.intervals_of(pattern));
  monitor.largest.setZero(x.shape.intervals_of(pattern));
  monitor.known = 0;
  for (int s = pattern; s < x.shape.segments; s += patterns(x.shape)) {
    if (x.duration(s) == 0.0) continue;
    find_highest_derivatives(x, rule, s, monitor.level, monitor.derivatives);
    monitor.add_segment(x.shape, sizes_);
  }
  return monitor.known > 0 && array_functions().range(monitor.values.data(), monitor.values.size()).finite;
}

/// The integral of |u^(c+1) / size of u|^(1/(c+1)) over segment s, summed over components; 0 where none is known.
double MeshEquidistribution::need(const Orbit& x, const CollocationRule& rule, int s) {
  if (x.duration(s) == 0.0) return 0.0;
  Monitor& monitor = monitors_[index(s)];
  find_rounding(x, rule, s, sizes_, monitor.rounding);
  find_highest_derivatives(x, rule, s, monitor.level, monitor.derivatives);
  const Mesh mesh = mesh_of(x, s);
  const double root = 1.0 / (x.shape.collocation + 1);
  double sum = 0.0;
  for (int k = 0; k < x.shape.dimension; ++k)
    for (int j = 0; j < x.shape.intervals_of(s) && !monitor.is_rounding(k); ++j)
      sum += length(mesh, j) * std::pow(std::max(monitor.derivatives(k, j), monitor.rounding(k, j)) / sizes_(k), root);
  return sum;
}

void deal_out(const Eigen::VectorXd& needs, int total, int least, std::vector<int>& counts) {
  const auto segments = static_cast<int>(needs.size());
  least = std::min(least, total / segments);
  const int rest = total - least * segments;
  const double sum = needs.sum();
  counts.resize(index(segments));
  // What is dealt out as far as a segment is rounded, so that the sum is right.
  double needed = 0.0;
  int dealt = 0;
  for (int s = 0; s < segments; ++s) {
    needed += needs(s);
    const int as_far = s + 1 == segments ? rest : std::min(rest, static_cast<int>(std::round(rest * (needed / sum))));
    counts[index(s)] = least + as_far - dealt;
    dealt = as_far;
  }
}

/// How many intervals each segment is to have: as many as before where that is nearly right.
void MeshEquidistribution::deal_out(const Orbit& x, const CollocationRule& rule, int intervals) {
  shape_ = resized(x.shape, intervals);
  needs_.resize(x.shape.segments);
  for (int s = 0; s < x.shape.segments; ++s) needs_(s) = need(x, rule, s);
  if (!(needs_.sum() > 0.0) || !std::isfinite(needs_.sum())) return;
  tchat::deal_out(needs_, shape_.total_intervals(), least_own_intervals, counts_);
  bool are_enough = true;
  for (int s = 0; s < x.shape.segments; ++s) {
    const int has = shape_.intervals_of(s);
    are_enough = are_enough && counts_[index(s)] <= has + 1 + has / 8;
  }
  if (!are_enough) shape_.own = OwnIntervals(counts_);
}

void MeshEquidistribution::put_mesh(const Orbit& x, const CollocationRule& rule, int pattern) {
  const int intervals = shape_.intervals_of(pattern);
  const Mesh old = mesh_of(x, pattern);
  const auto put = [&](const std::vector<double>& mesh) {
    std::copy(mesh.begin(), mesh.end(), mesh_.begin() + shape_.first_mesh_point(pattern));
  };
  if (!find_monitor(x, rule, pattern)) return put(resampled_mesh(old, intervals));
  Monitor& monitor = monitors_[index(pattern)];
  monitor.smooth(old);
  split(old, monitor.values, intervals, monitor.cumulative, monitor.adapted);
  // The sum over components equidistributes none of them by itself. The local error on an interval is the (c+1)-th
  // power of the integral of |u^(c+1)|^(1/(c+1)).
  for (double& value : monitor.largest) value = std::pow(value, 1.0 / (x.shape.collocation + 1));
  if (monitor.uniform.size() != index(intervals + 1)) monitor.uniform = uniform_mesh(intervals);
  const bool is_better =
      largest_share(monitor.largest, old, monitor.adapted) <= largest_share(monitor.largest, old, monitor.uniform);
  put(is_better ? monitor.adapted : monitor.uniform);
}

const std::vector<double>& MeshEquidistribution::mesh(const Orbit& x, const CollocationRule& rule, int intervals) {
  find_component_sizes(x, sizes_);
  monitors_.resize(index(patterns(x.shape)));
  if (x.shape.own)
    deal_out(x, rule, intervals);
  else
    shape_ = resized(x.shape, intervals);
  mesh_.resize(index(shape_.mesh_points()));
  for (int pattern = 0; pattern < patterns(shape_); ++pattern) put_mesh(x, rule, pattern);
  return mesh_;
}

std::vector<double> equidistributed_mesh(const Orbit& x, const CollocationRule& rule, int intervals) {
  return MeshEquidistribution().mesh(x, rule, intervals);
}

std::vector<double> resampled_mesh(Mesh mesh, int intervals) {
  const int old = static_cast<int>(mesh.size()) - 1;
  if (old == intervals) return {mesh.begin(), mesh.end()};
  Eigen::VectorXd density(old);
  for (int j = 0; j < old; ++j) density(j) = 1.0 / length(mesh, j);
  return equal_parts(mesh, density, intervals);
}

std::vector<double> resampled_mesh(const OrbitShape& from, const std::vector<double>& mesh, const OrbitShape& to) {
  assert(static_cast<bool>(from.own) == static_cast<bool>(to.own));
  std::vector<double> result;
  for (int pattern = 0; pattern < patterns(to); ++pattern) {
    const std::vector<double> part = resampled_mesh(mesh_of(from, mesh, pattern), to.intervals_of(pattern));
    result.insert(result.end(), part.begin(), part.end());
  }
  return result;
}

OrbitShape resized(const OrbitShape& shape, int intervals) {
  if (shape.intervals == intervals) return shape;
  OrbitShape result = shape;
  result.intervals = intervals;
  if (!shape.own) return result;
  Eigen::VectorXd needs(shape.segments);
  for (int s = 0; s < shape.segments; ++s) needs(s) = shape.intervals_of(s);
  std::vector<int> counts;
  deal_out(needs, result.total_intervals(), least_own_intervals, counts);
  result.own = OwnIntervals(counts);
  return result;
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
  const int segments = differs_by_segment() ? to.segments : 1;
  first_.resize(index(segments == 1 ? to.nodes_of(0) : to.columns()));
  weights_.resize(from.collocation + 1, static_cast<Eigen::Index>(first_.size()));
  for (int s = 0; s < segments; ++s) set_segment(mesh_of(from, from_mesh, s), mesh_of(to, to_mesh, s), s, rule);
}

void MeshTransfer::set_segment(Mesh from, Mesh to, int s, const CollocationRule& rule) {
  const auto from_intervals = static_cast<int>(from.size()) - 1;
  const auto to_intervals = static_cast<int>(to.size()) - 1;
  const int begin = to_.first_node(s);
  int j = 0;
  for (int k = 0; k < to_.nodes_of(s); ++k) {
    const int interval = std::min(k / to_.collocation, to_intervals - 1);
    const double share = static_cast<double>(k - interval * to_.collocation) / to_.collocation;
    const double tau = to[index(interval)] + share * length(to, interval);
    while (j + 1 < from_intervals && from[index(j + 1)] <= tau) ++j;
    first_[index(begin + k)] = j * from_.collocation;
    rule.basis((tau - from[index(j)]) / length(from, j), weights_.col(begin + k).data(), nullptr);
  }
}

void MeshTransfer::operator()(const Eigen::MatrixXd& states, Eigen::MatrixXd& result) const {
  result.resize(to_.dimension, to_.columns());
  for (int s = 0; s < to_.segments; ++s) {
    const int begin = differs_by_segment() ? to_.first_node(s) : 0;
    const NodeCombinations combinations{weights_.col(begin).data(), first_.data() + begin, to_.nodes_of(s),
                                        from_.collocation, to_.dimension};
    array_functions().combine_nodes(combinations, states.col(from_.first_node(s)).data(),
                                    result.col(to_.first_node(s)).data());
  }
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
    for (int j = 0; j < x.shape.intervals_of(s); ++j)
      worst = std::max(worst, derivatives.col(j).maxCoeff() * power(length(mesh_of(x, s), j), c + 1));
  }
  return rule.interpolation * worst / (1.0 + x.states.cwiseAbs().maxCoeff());
}

namespace {

std::size_t index(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }

constexpr double rounding_of_times = level::rounding;

/// The largest of the segments' densities, intervals per unit of tau, on each interval of `grid`, which has the points
/// of all meshes.
Eigen::VectorXd largest_densities(const OrbitShape& own, const std::vector<double>& own_mesh,
                                  const std::vector<double>& grid) {
  Eigen::VectorXd densities = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(grid.size()) - 1);
  for (int s = 0; s < own.segments; ++s) {
    const double* point = own_mesh.data() + own.first_mesh_point(s);
    for (Eigen::Index j = 0; j < densities.size(); ++j) {
      while (point[1] <= grid[index(j)]) ++point;
      densities(j) = std::max(densities(j), 1.0 / (point[1] - point[0]));
    }
  }
  return densities;
}

/// A number of nodes of a segment in common, at the times `tau`, that a polynomial of degree c on [left, right] passes
/// through: c + 1 of those in the interval, as far apart as they are.
class Samples {
 public:
  Samples(const std::vector<double>& tau, int c, double left, double right) : c_(c) {
    const auto count = static_cast<std::ptrdiff_t>(tau.size());
    auto first = std::lower_bound(tau.begin(), tau.end(), left - rounding_of_times) - tau.begin();
    auto last = std::upper_bound(tau.begin(), tau.end(), right + rounding_of_times) - tau.begin() - 1;
    while (last - first < c) {  // of no mesh that mesh_in_common() makes
      if (first > 0) --first;
      if (last - first < c && last + 1 < count) ++last;
    }
    for (int i = 0; i <= c; ++i) {
      nodes_.push_back(first + (last - first) * i / c);
      places_.push_back((tau[index(nodes_.back())] - left) / (right - left));
    }
  }

  /// The polynomial at `place` in [0, 1] of the interval, of states whose nodes are columns from `begin` on.
  Eigen::VectorXd at(double place, const Eigen::MatrixXd& states, std::ptrdiff_t begin) const {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(states.rows());
    for (int i = 0; i <= c_; ++i) {
      double weight = 1.0;
      for (int k = 0; k <= c_; ++k)
        if (k != i) weight *= (place - places_[index(k)]) / (places_[index(i)] - places_[index(k)]);
      result += weight * states.col(begin + nodes_[index(i)]);
    }
    return result;
  }

 private:
  int c_;
  std::vector<std::ptrdiff_t> nodes_;
  std::vector<double> places_;
};

}  // namespace

Orbit with_own_meshes(Orbit x) {
  x.shape = x.shape.with_own_meshes();
  const std::vector<double> mesh = x.mesh;
  for (int s = 1; s < x.shape.segments; ++s) x.mesh.insert(x.mesh.end(), mesh.begin(), mesh.end());
  return x;
}

bool have_one_mesh(const OrbitShape& shape, const std::vector<double>& mesh) {
  for (int s = 1; s < shape.segments && shape.own; ++s) {
    const double* const first = mesh.data();
    const double* const other = mesh.data() + shape.first_mesh_point(s);
    if (shape.intervals_of(s) != shape.intervals_of(0) || !std::equal(first, first + shape.intervals_of(0) + 1, other))
      return false;
  }
  return true;
}

std::vector<double> mesh_in_common(const OrbitShape& own, const std::vector<double>& own_mesh) {
  if (have_one_mesh(own, own_mesh)) return {own_mesh.begin(), own_mesh.begin() + own.intervals + 1};
  // An interval that has c (1 + 1/c) intervals between nodes has c + 1 nodes; more, the better the samples lie.
  constexpr double finer = 1.5;
  std::vector<double> grid = own_mesh;
  std::sort(grid.begin(), grid.end());
  grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
  const Eigen::VectorXd densities = largest_densities(own, own_mesh, grid);
  double intervals = 0.0;
  for (Eigen::Index j = 0; j < densities.size(); ++j) intervals += densities(j) * (grid[index(j + 1)] - grid[index(j)]);
  return equal_parts(grid, densities, static_cast<int>(std::ceil(finer * intervals)));
}

Eigen::MatrixXd states_on_own_meshes(const Eigen::MatrixXd& states, const OrbitShape& common,
                                     const std::vector<double>& common_mesh, const OrbitShape& own,
                                     const std::vector<double>& own_mesh) {
  const int c = own.collocation;
  const std::vector<double> tau = Orbit{common, common_mesh, {}, {}}.node_times();
  Eigen::MatrixXd result(own.dimension, own.columns());
  for (int s = 0; s < own.segments; ++s) {
    const double* const mesh = own_mesh.data() + own.first_mesh_point(s);
    for (int j = 0; j < own.intervals_of(s); ++j) {
      const Samples samples(tau, c, mesh[j], mesh[j + 1]);
      for (int i = 0; i <= c; ++i)
        result.col(own.first_node(s) + j * c + i) =
            samples.at(static_cast<double>(i) / c, states, common.first_node(s));
    }
    // The ends are nodes in common.
    result.col(own.first_node(s)) = states.col(common.first_node(s));
    result.col(own.last_node(s)) = states.col(common.last_node(s));
  }
  return result;
}

}  // namespace tchat
