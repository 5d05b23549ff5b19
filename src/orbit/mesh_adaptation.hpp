/// Meshes: adaptation to a solution, transfer between meshes, and one mesh for all segments of an orbit, as files store
/// it.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "orbit/collocation_rule.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

// Meshes that follow the solution: equidistribution of the estimated local error, and transfer between meshes.
//
// The (c+1)-th derivative of the exact solution is estimated by differencing the c-th derivatives of the polynomials
// of neighbouring intervals. The monitor is the sum over components and segments of |u^(c+1) / size of u|^(1/(c+1))
// where one mesh in tau serves all segments; where each has its own mesh it is that segment's sum, and its integrals
// over the segments decide how many of the m N intervals each of them gets. Units of states do not matter. Segments
// of zero duration have no weight, nor have components whose estimates are rounding.

/// A segment with a mesh of its own has so many intervals at least, where N is not smaller: what four lanes do at once.
inline constexpr int least_own_intervals = 4;

/// The mesh of `intervals` intervals that equidistributes the monitor of x; the uniform one where the largest local
/// error h^(c+1) |u^(c+1)|, relative to the size of its component, is expected to be less on that. The density of the
/// old mesh is kept where all derivatives vanish to rounding: no mesh is better.
std::vector<double> equidistributed_mesh(const Orbit& x, const CollocationRule& rule, int intervals);

/// Makes such meshes for the orbits of a branch, without allocations after the first of a shape. Where segments have
/// their own meshes, of `intervals` intervals on average, each keeps its number of intervals until one needs an eighth
/// more: numbers that are the same again cost nothing (SegmentElimination).
class MeshEquidistribution {
 public:
  /// Valid until the next call.
  const std::vector<double>& mesh(const Orbit& x, const CollocationRule& rule, int intervals);
  /// That of orbits on the last mesh.
  const OrbitShape& shape() const { return shape_; }

 private:
  /// Of the segments on one mesh.
  struct Monitor {
    Eigen::MatrixXd level;        // c-th derivatives on each interval, n x N
    Eigen::MatrixXd derivatives;  // |u^(c+1)| of one segment, n x N
    Eigen::MatrixXd rounding;     // what rounding makes of them
    Eigen::VectorXd values, smoothed;
    Eigen::VectorXd largest;  // root of the largest derivative relative to its component's size, on each interval
    int known = 0;            // components whose derivatives are not rounding
    std::vector<double> adapted, uniform, cumulative;

    bool is_rounding(int k) const { return (derivatives.row(k).array() <= rounding.row(k).array()).all(); }
    void add_segment(const OrbitShape& shape, const Eigen::VectorXd& sizes);
    void smooth(std::span<const double> mesh);
  };

  void deal_out(const Orbit& x, const CollocationRule& rule, int intervals);
  double need(const Orbit& x, const CollocationRule& rule, int s);
  void put_mesh(const Orbit& x, const CollocationRule& rule, int pattern);
  bool find_monitor(const Orbit& x, const CollocationRule& rule, int pattern);

  Eigen::VectorXd sizes_;          // of the components
  std::vector<Monitor> monitors_;  // of each segment, or one for all
  OrbitShape shape_;
  Eigen::VectorXd needs_;    // of intervals, by each segment
  std::vector<int> counts_;  // the intervals they get
  std::vector<double> mesh_;
};

/// `total` intervals dealt out in proportion to `needs` (>= 0, not all zero), but `least` to each at least.
void deal_out(const Eigen::VectorXd& needs, int total, int least, std::vector<int>& counts);

/// The old mesh's density at another number of intervals.
std::vector<double> resampled_mesh(std::span<const double> mesh, int intervals);
/// The same for all segments of orbits of one kind: on one mesh in common, or on meshes of their own.
std::vector<double> resampled_mesh(const OrbitShape& from, const std::vector<double>& mesh, const OrbitShape& to);
/// `intervals` intervals for each segment, or on average, in the proportion that they have now.
OrbitShape resized(const OrbitShape& shape, int intervals);

/// Splits [0, 1] into `parts` intervals of equal share of a density that is constant on each interval of `mesh`, > 0.
std::vector<double> equal_parts(std::span<const double> mesh, const Eigen::VectorXd& density, int parts);

/// Evaluates states on another mesh, possibly of other N and c, of segments' own or in common (`to` has the same n and
/// m). The weights are computed once and serve any number of matrices. `rule` is that of `from`.
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
  bool differs_by_segment() const { return from_.own || to_.own; }
  void set_segment(std::span<const double> from, std::span<const double> to, int s, const CollocationRule& rule);

  OrbitShape from_ = {};
  OrbitShape to_ = {};
  std::vector<int> first_;   // of the nodes that a node of a segment is made of; of all segments where they differ
  Eigen::MatrixXd weights_;  // of these, a column for each
};

/// The same, of one matrix.
Eigen::MatrixXd interpolate_states(const Eigen::MatrixXd& states, const OrbitShape& from,
                                   const std::vector<double>& from_mesh, const OrbitShape& to,
                                   const std::vector<double>& to_mesh);

/// Estimated largest error of polynomials that agree with a smooth function at the nodes, relative to 1 + max |u|:
/// h^(c+1) |u^(c+1)| times the interpolation constant, the largest over intervals and components. That of a solution
/// of the equations is in collocation_rule.hpp.
double estimated_interpolation_error(const Orbit& x, const CollocationRule& rule);

// Orbits whose segments have meshes of their own, on a mesh that all segments have in common, as files store them; and
// back.
//
// The mesh in common is so fine that each interval of each segment has c + 1 of its nodes at least. So the polynomial
// on that interval passes through these, and is found again from them to rounding. Between its nodes the orbit in
// common has the error of interpolation on finer intervals, of order c + 1.

/// An orbit with a mesh in common as one whose segments have this mesh each.
Orbit with_own_meshes(Orbit x);

/// Do all segments have the same mesh?
bool have_one_mesh(const OrbitShape& shape, const std::vector<double>& mesh);

/// A mesh in common for orbits on own meshes: that which all have, or a finer one.
std::vector<double> mesh_in_common(const OrbitShape& own, const std::vector<double>& own_mesh);

/// The other way: states (n x columns) on own meshes from those on a mesh in common.
Eigen::MatrixXd states_on_own_meshes(const Eigen::MatrixXd& states, const OrbitShape& common,
                                     const std::vector<double>& common_mesh, const OrbitShape& own,
                                     const std::vector<double>& own_mesh);

}  // namespace tchat
