/// The linear problem of an orbit's return map: condensed to the ends of segments, and on all nodes.
#pragma once

#include <span>
#include <vector>

#include "linear/array_kernel.hpp"
#include "linear/sparse_lu.hpp"
#include "model/function_values.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/defining_system.hpp"

namespace tchat {

// The linear problem of the return map, condensed to the ends of segments, and its derivative along the orbit.
//
// With v_s(0), w_s = v_s(1) and sigma_s (change of the duration) of every segment as unknowns,
//
//     S(mu):   A_s v_s(0) + C_s w_s + B_s sigma_s = 0,   h_x w_s = 0,   v_{s+1}(0) = g_x w_s,   mu v_1(0) = g_x w_m,
//
// is singular exactly when mu is a multiplier: sigma_s replaces the division by h_x f of (5.13), so nothing is special
// at grazing. A_s, C_s, B_s are the blocks of the condensed Newton matrix. h is the terminal event of the segment,
// whose second derivatives enter the derivative of S, or where there is none the plane across the flow: the map
// belongs to problem types with these sections (180).

/// A weight for each of the rows that S(1) is condensed from.
struct RowWeights {
  std::vector<double> collocation;  ///< m N c n: segment, interval, Gauss point, component
  std::vector<double> ends;         ///< m (1 + n): of each segment the event row and the n rows of connectivity
};

/// The field is asked for the Gauss points of so many intervals at once.
inline constexpr int intervals_at_once = 8;

class CondensedReturnMap {
 public:
  /// `vectors`: of how many null vectors derivatives are asked for at a time.
  CondensedReturnMap(const DefiningSystem& system, const OrbitShape& shape, int vectors = 1);

  /// m (2n + 1): rows by segment (n condensed, 1 event, n connectivity), unknowns by segment (v_s(0), w_s, sigma_s).
  int size() const { return size_; }
  /// Positions of the values that `values` writes; those of the factor mu are the entries `factor_positions`.
  const std::vector<int>& rows() const { return rows_; }
  const std::vector<int>& columns() const { return columns_; }
  const std::vector<std::size_t>& factor_positions() const { return factor_positions_; }
  /// First row of the last connectivity, whose left side is mu v_1(0).
  int last_connectivity_row() const { return size_ - n_; }

  /// S at x, whose linearisation is in `condensed`, with the factor `mu`.
  void values(const CondensedSystem& condensed, const Orbit& x, double mu, std::vector<double>& values);

  /// The columns of free parameter g beside S = S(1): its effect on the same rows, size() entries.
  void parameter_column(const CondensedSystem& condensed, const Orbit& x, int g, double* column);

  /// gradient -= the sum of w_k^T (dS) v_k for changes of the orbit, the durations and the free parameters, over all
  /// `vectors`; w_k has size() entries, one behind the other. v_k is `extended` to all nodes from the ends of segments
  /// (CondensedSystem::extend): second derivatives of f, h and g along it. Its globals are read: where they are not
  /// zero, S stands for S(1) with its parameters' columns, v_k for v_k with these globals.
  void subtract_derivative(CondensedSystem& condensed, const Orbit& x, const double* w,
                           std::span<const OrbitVector> extended, OrbitVector& gradient);
  /// The same for a single v, with weights of all rows that S is condensed from.
  void subtract_derivative(const Orbit& x, const RowWeights& weights, const OrbitVector& v, OrbitVector& gradient);

 private:
  void put_parameters(int k, const OrbitVector& v);
  void add_segments(const Orbit& x, std::span<const OrbitVector> extended, OrbitVector& gradient);
  void put_points(const Orbit& x, int s, int first, int last, std::span<const OrbitVector> extended);
  void put_weights(const Orbit& x, int s, int first, int last, std::span<const OrbitVector> extended);
  IntervalBasis basis(int first, int last) const;
  void add_intervals(const Orbit& x, int s, int first, int last, OrbitVector& gradient);
  template <class Dimension>
  double along(Dimension n, int gauss_point, int point, int k) const;
  void section_change(const Orbit& x, int s, const Eigen::Ref<const Eigen::VectorXd>& v);
  void add_ends(const Orbit& x, int s, const double* weights, const OrbitVector& v, OrbitVector& gradient);

  const DefiningSystem& system_;
  OrbitShape shape_;
  CollocationRule rule_;
  int n_;
  int size_;
  std::vector<int> rows_;
  std::vector<int> columns_;
  std::vector<std::size_t> factor_positions_;
  std::vector<double> condensed_weights_;
  std::vector<std::vector<double>> collocation_weights_;  // of each vector
  WeightedSecond curvature_;                              // of the field at the Gauss points of some intervals
  // scratch of one end of a segment
  Eigen::VectorXd f_, d_, hx_, hp_, direction_;
  Eigen::MatrixXd fx_, dx_, fp_, dp_;
};

// The linear problem of an orbit's return map on all its nodes, factored, for solutions and adjoint ones.
//
// Unknowns: the nodes v_s of all segments and sigma_s, the changes of the durations. Rows: with (5.29) linearised
//
//     M:   slope v - h T f_x v - h sigma f = 0 at the Gauss points,   h_x v_s(1) = 0,   v_{s+1}(0) = g_x v_s(1)
//
// (s cyclic; f is the field and h its interval's length in the first, the event function in the second), and beside
// them a column for each free parameter p_k: -h T f_p, h_p, -g_p. The last row may have a factor, mu v_1(0) = g_x
// v_m(1): eliminated to the ends of segments M(mu) is the matrix S(mu) of CondensedReturnMap, singular where the
// orbit has the multiplier mu.
//
// A solution of M^T l = q weighs all rows, the interior ones too: q may be the gradient of any function of the orbit.
// One sparse factorisation, whose work is linear in segments and mesh intervals; it allocates.

class NodalSystem {
 public:
  /// The system outlives this object; its terminal events are the sections of the return map.
  NodalSystem(const DefiningSystem& system, const OrbitShape& shape);
  const DefiningSystem& system() const { return system_; }

  /// M(mu) and the columns of the parameters at x. False where M is singular or not finite.
  bool factorize(const Orbit& x, double mu = 1.0);
  /// n for each node and one for each segment; as many rows, the last n of which close the orbit.
  Eigen::Index size() const { return right_.size(); }
  /// Relative distance of M to a singular matrix.
  double singular_distance() const { return lu_.singular_distance(); }

  /// v and its sigma with M v + the columns times v.globals = 0, for the globals that v has.
  void solve(OrbitVector& v);
  /// M^T weights = the states and durations of q: a weight for each row of M, segment by segment.
  void solve_adjoint(const OrbitVector& q, Eigen::VectorXd& weights);
  /// M v = right, M^T weights = right: unknowns are the nodes' states and then the durations' changes.
  Eigen::VectorXd solve(const Eigen::VectorXd& right);
  Eigen::VectorXd solve_adjoint(const Eigen::VectorXd& right);
  /// A column for each free parameter, with the rows of M.
  const Eigen::MatrixXd& parameter_columns() const { return columns_; }
  /// What these weights say of a shift of the phase at unit speed on an orbit without an event at the end of segment s:
  /// the derivative of q in that direction.
  double phase_derivative(const Eigen::VectorXd& weights, const Orbit& x, int s);
  /// Weights of the rows of M as those of the kinds of rows.
  RowWeights by_kind(const Eigen::VectorXd& weights) const;

 private:
  Eigen::Index end_row(int s) const { return rows_of_ends_[static_cast<std::size_t>(s)]; }
  void put_collocation(const Orbit& x, int s);
  void put_ends(const Orbit& x, int s, double mu);

  const DefiningSystem& system_;
  OrbitShape shape_;
  CollocationRule rule_;
  std::vector<Eigen::Index> rows_of_ends_;  // the event row of each segment
  std::vector<double> values_;
  SparseLu lu_;
  Eigen::MatrixXd columns_;  // of the free parameters
  Eigen::VectorXd right_, solution_;
  // scratch of one point
  Eigen::VectorXd state_, f_, hx_, hp_;
  Eigen::MatrixXd fx_, fp_;
};

}  // namespace tchat
