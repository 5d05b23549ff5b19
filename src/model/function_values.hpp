/// Values of a problem's functions: ones that are not finite, and weighted sums of second derivatives.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"

namespace tchat {

// Messages about a function of a problem that has no finite value at a state.

/// "x = 1, v = -0.5": a state by the names of its entries; the first eight of a long one.
std::string named_state(const HybridSystem& system, const double* x);

/// What a user can do about it.
inline constexpr const char* undefined_value_advice =
    "give the function a value there (mind roots and logarithms of negative numbers, and divisions by zero), or let an "
    "event end the motion before";

/// "flow has no finite value at x = 1, v = -0.5; " and the advice.
std::string undefined_value(const HybridSystem& system, FunctionKind kind, int index, const double* x);

// Where a function has a value and no derivatives: sqrt, cbrt, hypot and atan2 at zero, asin and acos at 1 and -1.

/// "flow has no finite derivatives at x = (0, 0): ...", with what may be the reason.
std::string no_finite_derivatives(const HybridSystem& system, FunctionKind kind, int index, const Eigen::VectorXd& x);

/// Are the derivatives of function `index` by the states finite at x, wherever its value is? `par` has layout().room()
/// entries. Allocates.
bool has_finite_derivatives(const HybridSystem& system, FunctionKind kind, int index, const double* x,
                            const double* par);

// Second derivatives of a function of the problem at many points, summed with weights there.
//
// At each point x there are some directions (v_k, q_k) by the state and the active parameters, weights w_k of the
// values in each of them and weights u of the function itself. With D_k = F_x v_k + F_p q_k,
//
//     D_k    and    the gradient of  u . F + sum over k of w_k . D_k  by x and the active parameters
//
// are found in one call of a problem that can do so, else by calls of its first and second derivatives at each point.

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
