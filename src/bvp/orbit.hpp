/// An orbit of m segments on one mesh, and vectors of the space that orbits live in.
///
/// Each segment s = 0..m-1 is scaled to tau in [0, 1] with its own duration T_s (5.1-5.7) and is represented on N mesh
/// intervals by polynomials of degree c (NCOL) through c + 1 equally spaced nodes (5.26-5.27). Neighbouring intervals
/// share their mesh node, so a segment has N c + 1 nodes.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "hybrid/parameter_vector.hpp"

namespace tchat {

/// The sizes of an orbit.
struct OrbitShape {
  int dimension = 1;    ///< n
  int segments = 1;     ///< m
  int intervals = 1;    ///< N = NTST
  int collocation = 4;  ///< c = NCOL

  int nodes() const { return intervals * collocation + 1; }  ///< of one segment
  int columns() const { return segments * nodes(); }
  /// An equilibrium: one interval of degree 1, both of whose nodes are the same state.
  static OrbitShape point(int dimension) { return {dimension, 1, 1, 1}; }
  /// Nodes of one segment whose states differ, so that files store them.
  int stored_nodes() const { return *this == point(dimension) ? 1 : nodes(); }
  bool operator==(const OrbitShape&) const = default;
};

struct Orbit {
  OrbitShape shape;
  std::vector<double> mesh;  ///< N + 1 rising values of tau, from 0 to 1, the same for all segments
  Eigen::MatrixXd states;    ///< n x m (N c + 1): column s (N c + 1) + k is node k of segment s
  ParameterVector par;       ///< PAR, durations included

  double duration(int s) const { return par(first_duration - 1 + s); }
  double& duration(int s) { return par(first_duration - 1 + s); }
  double period() const { return par.segment(first_duration - 1, shape.segments).sum(); }

  const double* node(int s, int k) const { return states.col(s * shape.nodes() + k).data(); }
  double* node(int s, int k) { return states.col(s * shape.nodes() + k).data(); }
  const double* start(int s) const { return node(s, 0); }                ///< x_s(0)
  const double* end(int s) const { return node(s, shape.nodes() - 1); }  ///< x_s(1)

  /// tau of node k.
  double tau(int k) const;
  /// tau of all nodes.
  std::vector<double> node_times() const;
};

/// A uniform mesh of N intervals on [0, 1].
std::vector<double> uniform_mesh(int intervals);

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

/// dot(row, v) and dot(row, w).
std::pair<double, double> dot_both(const OrbitVector& row, const OrbitVector& v, const OrbitVector& w);

/// x + step v; `free_parameters` are the PAR indices of v.globals.
void advance(Orbit& x, double step, const OrbitVector& v, const std::vector<int>& free_parameters);
/// The same of durations and parameters alone.
void advance_parameters(Orbit& x, double step, const OrbitVector& v, const std::vector<int>& free_parameters);

/// The value of the dual vector `row` on x - base.
double dot_difference(const OrbitVector& row, const Orbit& x, const Orbit& base,
                      const std::vector<int>& free_parameters);

}  // namespace tchat
