/// Second derivatives of a function of the problem at many points, summed with weights there.
///
/// At each point x there are some directions (v_k, q_k) by the state and the active parameters, weights w_k of the
/// values in each of them and weights u of the function itself. With D_k = F_x v_k + F_p q_k,
///
///     D_k    and    the gradient of  u . F + sum over k of w_k . D_k  by x and the active parameters
///
/// are found in one call of a problem that can do so, else by calls of its first and second derivatives at each point.
#pragma once

#include <vector>

#include "model/hybrid_system.hpp"

namespace tchat {

class WeightedSecond {
 public:
  /// At most `points` points with `directions` >= 1 directions each; all arrays are allocated here. The system outlives
  /// this object.
  WeightedSecond(const HybridSystem& system, FunctionKind kind, std::vector<int> active, int points, int directions);

  int points() const { return points_; }
  int directions() const { return directions_; }

  // What goes in, at point i and for direction k:
  double* point(int i) { return &x_[at(i, n_)]; }                                            ///< x: n
  double* direction(int i, int k) { return &v_[at(i * directions_ + k, n_)]; }               ///< v_k: n
  double* weights(int i, int k) { return &weights_[at(i * (directions_ + 1) + k, rows_)]; }  ///< w_k: rows
  double* value_weights(int i) { return weights(i, directions_); }                           ///< u: rows
  double* parameter_direction(int k) { return q_.data() + at(k, active_count()); }  ///< q_k, the same at all points

  /// Of function `index` at the first `points` points.
  void compute(int index, int points, const double* par);

  const double* directional(int i, int k) const { return &out_[at(i * directions_ + k, rows_)]; }  ///< D_k: rows
  /// n + active parameters
  const double* gradient(int i) const { return &gradient_[at(i, n_ + active_count())]; }

 private:
  static std::size_t at(int i, int length) { return static_cast<std::size_t>(i) * static_cast<std::size_t>(length); }
  int active_count() const { return static_cast<int>(active_.size()); }
  void compute_one(int index, int i, const double* par);

  const HybridSystem& system_;
  FunctionKind kind_;
  std::vector<int> active_;
  int points_;
  int directions_;
  int n_;
  int rows_;
  std::vector<double> x_, v_, q_, weights_, out_, gradient_;
  std::vector<double> f_, dx_, dp_, direction_;  // scratch of one point
};

}  // namespace tchat
