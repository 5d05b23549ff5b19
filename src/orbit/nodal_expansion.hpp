/// An orbit's equations beyond their linear part: products of up to three changes of the orbit.
///
/// The nodes and durations depend on three numbers whose squares are left out, X = sum of X_m e^m, m = 0..7
/// (tchat_problem::third), and so do the equations: with T_k and f_k the parts of the duration and of the field,
///
///     slope x_m - h sum over k in m of T_k f_{m-k}   at the Gauss points,
///     h_m   at the end of a segment with an event,      x_{s+1}(0)_m - g_m   behind it.
///
/// Rows and unknowns are those of NodalSystem. A plane across the flow, in place of an event, is linear.
#pragma once

#include <array>

#include "orbit/collocation_rule.hpp"
#include "orbit/defining_system.hpp"

namespace tchat {

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

}  // namespace tchat
