/// Orbits of m segments on their mesh and vectors of their space; how accurately an orbit is known, and when a segment
/// has zero duration.
#pragma once

#include <Eigen/Core>
#include <cassert>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "base/levels.hpp"
#include "model/hybrid_system.hpp"
#include "model/parameter_vector.hpp"
#include "model/scales.hpp"

namespace tchat {

// An orbit of m segments on its mesh, and vectors of the space that orbits live in.
//
// Each segment s = 0..m-1 is scaled to tau in [0, 1] with its own duration T_s (5.1-5.7) and is represented on N_s
// mesh intervals by polynomials of degree c (NCOL) through c + 1 equally spaced nodes (5.26-5.27). Neighbouring
// intervals share their mesh node, so a segment has N_s c + 1 nodes. Either all segments have one mesh of N intervals
// in common, or each has a mesh of its own; then the N_s sum to m N, so that both kinds of orbits have equally many
// nodes.

/// The numbers of mesh intervals of segments that have meshes of their own. Copies share one table.
class OwnIntervals {
 public:
  OwnIntervals() = default;  ///< of none: the segments have their mesh in common
  explicit OwnIntervals(const std::vector<int>& counts);

  explicit operator bool() const { return starts_ != nullptr; }
  int of(int s) const { return start(s + 1) - start(s); }
  /// How many the segments before s have together; s may be the number of segments.
  int start(int s) const { return (*starts_)[static_cast<std::size_t>(s)]; }
  bool operator==(const OwnIntervals& other) const {
    return starts_ == other.starts_ || (starts_ && other.starts_ && *starts_ == *other.starts_);
  }

 private:
  std::shared_ptr<const std::vector<int>> starts_;
};

/// The sizes of an orbit.
struct OrbitShape {
  int dimension = 1;      ///< n
  int segments = 1;       ///< m
  int intervals = 1;      ///< N = NTST: of every segment, or on average where they have meshes of their own
  int collocation = 4;    ///< c = NCOL
  OwnIntervals own = {};  ///< where segments have meshes of their own

  int intervals_of(int s) const { return own ? own.of(s) : intervals; }
  int first_interval(int s) const { return own ? own.start(s) : s * intervals; }  ///< among those of all segments
  int total_intervals() const { return segments * intervals; }
  int nodes_of(int s) const { return intervals_of(s) * collocation + 1; }
  int first_node(int s) const { return first_interval(s) * collocation + s; }  ///< among those of all segments
  int last_node(int s) const { return first_node(s + 1) - 1; }
  int mean_nodes() const { return intervals * collocation + 1; }
  /// Of each segment on a mesh in common.
  int nodes() const {
    assert(!own);
    return mean_nodes();
  }
  int columns() const { return segments * mean_nodes(); }
  /// Where the points of a segment's mesh are in Orbit::mesh, and how many that has.
  int first_mesh_point(int s) const { return own ? own.start(s) + s : 0; }
  int mesh_points() const { return own ? total_intervals() + segments : intervals + 1; }
  /// The same with a mesh in common, or with meshes of their own of N intervals each.
  OrbitShape in_common() const { return {dimension, segments, intervals, collocation}; }
  OrbitShape with_own_meshes() const;
  /// An equilibrium: one interval of degree 1, both of whose nodes are the same state.
  static OrbitShape point(int dimension) { return {dimension, 1, 1, 1}; }
  /// Nodes of one segment whose states differ, so that files store them.
  int stored_nodes() const { return *this == point(dimension) ? 1 : mean_nodes(); }
  bool operator==(const OrbitShape&) const = default;
};

struct Orbit {
  OrbitShape shape;
  std::vector<double> mesh;  ///< N + 1 rising values of tau, from 0 to 1, or own ones of the segments in a row
  Eigen::MatrixXd states;    ///< n x m (N c + 1): column first_node(s) + k is node k of segment s
  ParameterVector par;       ///< PAR, durations included

  double duration(int s) const { return par.duration(s); }
  double& duration(int s) { return par.duration(s); }
  double period() const { return par.durations(shape.segments).sum(); }

  const double* node(int s, int k) const { return states.col(shape.first_node(s) + k).data(); }
  double* node(int s, int k) { return states.col(shape.first_node(s) + k).data(); }
  const double* start(int s) const { return node(s, 0); }                           ///< x_s(0)
  const double* end(int s) const { return states.col(shape.last_node(s)).data(); }  ///< x_s(1)

  /// The N_s + 1 points of the mesh of segment s.
  const double* mesh_of(int s) const { return mesh.data() + shape.first_mesh_point(s); }
  /// tau of node k of segment s.
  double tau(int s, int k) const;
  /// tau of a node, and of all nodes, of any segment on a mesh in common.
  double tau(int k) const {
    assert(!shape.own);
    return tau(0, k);
  }
  std::vector<double> node_times() const;
};

/// A uniform mesh of N intervals on [0, 1].
std::vector<double> uniform_mesh(int intervals);
/// The same of orbits of a shape, all segments on uniform meshes.
std::vector<double> uniform_mesh(const OrbitShape& shape);

/// A vector of the unknowns' space: a tangent, a Newton correction, or (as a dual vector) a row of conditions on them.
/// `globals` belong to the free problem parameters, in the order of the defining system.
struct OrbitVector {
  Eigen::MatrixXd states;     ///< like Orbit::states
  Eigen::VectorXd durations;  ///< m
  Eigen::VectorXd globals;    ///< free problem parameters

  OrbitVector() = default;
  OrbitVector(const OrbitShape& shape, int global_count);
  void set_zero();
  void scale(double factor);
};

/// Plain sum of products of all entries; the value of the dual vector `row` on `v`.
double dot(const OrbitVector& row, const OrbitVector& v);

/// The terms of that sum without their signs: its size, whatever the units of the unknowns are.
double dot_of_sizes(const OrbitVector& row, const OrbitVector& v);

/// dot(row, v) and dot(row, w).
std::pair<double, double> dot_both(const OrbitVector& row, const OrbitVector& v, const OrbitVector& w);

/// x + step v; `free_parameters` are the PAR indices of v.globals.
void advance(Orbit& x, double step, const OrbitVector& v, const std::vector<int>& free_parameters);
/// The same of durations and parameters alone.
void advance_parameters(Orbit& x, double step, const OrbitVector& v, const std::vector<int>& free_parameters);

/// The value of the dual vector `row` on x - base.
double dot_difference(const OrbitVector& row, const Orbit& x, const Orbit& base,
                      const std::vector<int>& free_parameters);

// How well a computed orbit is known: the one level below which a value says nothing.

/// Relative error of a corrected orbit.
inline constexpr double orbit_accuracy = level::orbit;

/// The size of an event function, against which a value of it is small: the largest |h| at the mesh points of the whole
/// orbit, for on a segment that is about to vanish all of them are small. Of an equilibrium, whose h may be all there
/// is and small, what a change of the state by its own size makes of h.
double event_scale(const HybridSystem& system, const Orbit& x, int event);

/// The sizes of its states (StateSizes, by the functions of the segments of this signature, which the orbit may run
/// through more than once).
Eigen::VectorXd state_sizes(const HybridSystem& system, const Signature& signature, const Orbit& x);
/// The same before sizes are taken from it: which states have one is known, too. `change`: of the states, n to a
/// column, added to their sizes, for an orbit near x that is not at rest.
StateSizes known_sizes(const HybridSystem& system, const Signature& signature, const Orbit& x,
                       const Eigen::MatrixXd* change = nullptr);

/// How well states of the orbit are known, n entries: orbit_accuracy times the largest |x_k| over the orbit, and not
/// less than rounding of the largest of all states, for a state that is zero throughout shows nothing but rounding.
Eigen::VectorXd state_uncertainty(const Orbit& x);

/// |h_j| at a state, beside what states of these sizes make of h_j (surface_scale()).
double relative_event(const HybridSystem& system, int event, const Eigen::VectorXd& state, const double* par,
                      const Eigen::VectorXd& sizes);

// When a segment lasts no time.

/// Durations that are a smaller share of the period are zero: located points, where segments vanish, are known to about
/// ten times less (EPSS).
inline constexpr double no_duration = level::located;

/// Does segment s (from 0) last no time, but for the accuracy of a located point?
inline bool lasts_no_time(const Orbit& x, int s, double period) {
  return std::abs(x.duration(s)) <= no_duration * std::abs(period);
}
/// The same where the period is not at hand, which is a sum over all segments.
inline bool lasts_no_time(const Orbit& x, int s) { return lasts_no_time(x, s, x.period()); }

/// A contact segment (model/events.hpp) that shrinks to nothing passes zero in proportion to the arclength,
/// so that a located point knows its duration to EPSS, which may be coarse. At a tangency a shorter one is zero.
inline constexpr double no_contact = level::visible;

inline bool contact_lasts_no_time(const Orbit& x, int s) {
  return std::abs(x.duration(s)) <= no_contact * std::abs(x.period());
}

}  // namespace tchat
