/// An orbit's equations beyond their linear part: second and third derivatives along changes of the orbit.
#pragma once

#include <array>
#include <vector>

#include "orbit/collocation_rule.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/return_map.hpp"

namespace tchat {

// An orbit's equations beyond their linear part: products of up to three changes of the orbit.
//
// The nodes and durations depend on three numbers whose squares are left out, X = sum of X_m e^m, m = 0..7
// (tchat_problem::third), and so do the equations: with T_k and f_k the parts of the duration and of the field,
//
//     slope x_m - h sum over k in m of T_k f_{m-k}   at the Gauss points,
//     h_m   at the end of a segment with an event,      x_{s+1}(0)_m - g_m   behind it.
//
// Rows and unknowns are those of NodalSystem. A plane across the flow, in place of an event, is linear.

/// X_1, ..., X_7 by their numbers; null: zero. X_0 is the orbit itself.
using NodalParts = std::array<const Eigen::VectorXd*, 8>;

class NodalExpansion {
 public:
  explicit NodalExpansion(const DefiningSystem& system) : system_(system) {}

  /// Part number m > 0 of the equations at x. Not finite where the problem's functions are not.
  Eigen::VectorXd part(const Orbit& x, const NodalParts& parts, int m) const;

 private:
  const DefiningSystem& system_;
};

// Second and third derivatives of an orbit's equations along one change of the orbit.
//
// With nodes and durations x + t u, T + t sigma, and f_2, f_3 the second and third derivative of the field along u,
//
//     second:  -h (T f_2 + 2 sigma f_1)  at the Gauss points,   h_2   at the end of a segment,   -g_2   behind it
//     third:   -h (T f_3 + 3 sigma f_2)                          h_3                              -g_3
//
// in one pass over the Gauss points. Rows are those of RowWeights. A plane across the flow, in place of an event, is
// linear.

class DirectionalExpansion {
 public:
  /// All arrays are allocated here, unless the problem has no third derivatives.
  DirectionalExpansion(const DefiningSystem& system, const OrbitShape& shape);

  /// Rows of zeros.
  RowWeights make_rows() const;
  /// At x along u, whose globals are not read. Not finite where the problem's functions are not.
  void find(const Orbit& x, const OrbitVector& u, RowWeights& second, RowWeights& third);

 private:
  void put_intervals(const Orbit& x, const OrbitVector& u, int s, int first, int last, RowWeights& second,
                     RowWeights& third);
  void put_ends(const Orbit& x, const OrbitVector& u, int s, RowWeights& second, RowWeights& third);
  void evaluate(FunctionKind kind, int number, int points, const Orbit& x);

  const DefiningSystem& system_;
  OrbitShape shape_;
  CollocationRule rule_;
  Eigen::MatrixXd states_;  // n x 8 for each point of some intervals, of HybridSystem::third_at_points
  Eigen::MatrixXd values_;  // n x 8
};

}  // namespace tchat
