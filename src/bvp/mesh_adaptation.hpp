/// Meshes that follow the solution: equidistribution of the estimated local error, and transfer between meshes.
///
/// The (c+1)-th derivative of the exact solution is estimated by differencing the c-th derivatives of the polynomials
/// of neighbouring intervals. The monitor is the sum over components and segments of |u^(c+1)|^(1/(c+1)); one mesh in
/// tau serves all segments. Segments of zero duration have no weight, nor have components whose estimates are rounding.
#pragma once

#include "bvp/collocation_rule.hpp"
#include "bvp/orbit.hpp"

namespace tchat {

/// The mesh of `intervals` intervals that equidistributes the monitor of x; the uniform one where the largest local
/// error h^(c+1) |u^(c+1)|, relative to the size of its component, is expected to be less on that. The density of the
/// old mesh is kept where all derivatives vanish to rounding: no mesh is better.
std::vector<double> equidistributed_mesh(const Orbit& x, const CollocationRule& rule, int intervals);

/// Makes such meshes for the orbits of a branch, without allocations after the first of a shape.
class MeshEquidistribution {
 public:
  /// Valid until the next call.
  const std::vector<double>& mesh(const Orbit& x, const CollocationRule& rule, int intervals);

 private:
  bool find_monitor(const Orbit& x, const CollocationRule& rule);
  void add_segment(const Orbit& x);
  void smooth_monitor();

  Eigen::MatrixXd level_;        // c-th derivatives on each interval, n x N
  Eigen::MatrixXd derivatives_;  // |u^(c+1)| of one segment, n x N
  Eigen::MatrixXd rounding_;     // what rounding makes of them
  Eigen::VectorXd sizes_;        // of the components
  Eigen::VectorXd monitor_, smoothed_;
  Eigen::VectorXd largest_;  // root of the largest derivative relative to its component's size, on each interval
  int known_ = 0;            // components whose derivatives are not rounding
  std::vector<double> adapted_, uniform_, cumulative_;
};

/// The old mesh's density at another number of intervals.
std::vector<double> resampled_mesh(const std::vector<double>& mesh, int intervals);

/// Splits [0, 1] into `parts` intervals of equal share of a density that is constant on each interval of `mesh`, > 0.
std::vector<double> equal_parts(const std::vector<double>& mesh, const Eigen::VectorXd& density, int parts);

/// Evaluates states on another mesh, possibly of other N and c (`to` has the same n and m): the weights once, for as
/// many matrices of states as there are. `rule` is that of `from`.
class MeshTransfer {
 public:
  MeshTransfer() = default;
  MeshTransfer(const OrbitShape& from, const std::vector<double>& from_mesh, const OrbitShape& to,
               const std::vector<double>& to_mesh, const CollocationRule& rule);
  /// Between other meshes.
  void set(const OrbitShape& from, const std::vector<double>& from_mesh, const OrbitShape& to,
           const std::vector<double>& to_mesh, const CollocationRule& rule);
  Eigen::MatrixXd operator()(const Eigen::MatrixXd& states) const;
  /// Into a matrix of its own, whose space is used again.
  void operator()(const Eigen::MatrixXd& states, Eigen::MatrixXd& result) const;

 private:
  OrbitShape from_ = {};
  OrbitShape to_ = {};
  std::vector<int> first_;   // of the nodes that node k of a segment is made of
  Eigen::MatrixXd weights_;  // of these, a column for each k
};

/// The same, of one matrix.
Eigen::MatrixXd interpolate_states(const Eigen::MatrixXd& states, const OrbitShape& from,
                                   const std::vector<double>& from_mesh, const OrbitShape& to,
                                   const std::vector<double>& to_mesh);

/// Estimated largest error of polynomials that agree with a smooth function at the nodes, relative to 1 + max |u|:
/// h^(c+1) |u^(c+1)| times the interpolation constant, the largest over intervals and components. That of a solution
/// of the equations is in discretisation_error.hpp.
double estimated_interpolation_error(const Orbit& x, const CollocationRule& rule);

}  // namespace tchat
