/// The linear problem of an orbit's return map on all its nodes, factored, for solutions and adjoint ones.
///
/// Unknowns: the nodes v_s of all segments and sigma_s, the changes of the durations. Rows: with (5.29) linearised
///
///     M:   slope v - h T f_x v - h sigma f = 0 at the Gauss points,   h_x v_s(1) = 0,   v_{s+1}(0) = g_x v_s(1)
///
/// (s cyclic; f is the field and h its interval's length in the first, the event function in the second), and beside
/// them a column for each free parameter p_k: -h T f_p, h_p, -g_p. The last row may have a factor, mu v_1(0) = g_x
/// v_m(1): eliminated to the ends of segments M(mu) is the matrix S(mu) of condensed_return_map.hpp, singular where the
/// orbit has the multiplier mu.
///
/// A solution of M^T l = q weighs all rows, the interior ones too: q may be the gradient of any function of the orbit.
/// One sparse factorisation, whose work is linear in segments and mesh intervals; it allocates.
#pragma once

#include <vector>

#include "linear/sparse_lu.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/condensed_return_map.hpp"
#include "orbit/defining_system.hpp"

namespace tchat {

class NodalSystem {
 public:
  /// The system outlives this object; its terminal events are the sections of the return map.
  NodalSystem(const DefiningSystem& system, const OrbitShape& shape);

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
