#include "orbit/mesh_in_common.hpp"

#include <algorithm>
#include <cmath>

#include "orbit/mesh_adaptation.hpp"

namespace tchat {

namespace {

std::size_t index(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }

constexpr double rounding_of_times = 1e-14;

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
