/// How a monitor changes along a family of periodic orbits: its derivatives by the free parameters.
///
/// With u an orbit and its durations and F(u, p) = 0 its equations, the orbits are a family u(p) where F_u is regular,
/// and q(u, p) is a function on it. With M = F_u on all nodes (nodal_system.hpp), F_k its column of p_k and q_k the
/// derivative by p_k in q itself,
///
///     M^T l = q_u,      H_k = dq / dp_k = q_k - l . F_k                             (adjoint)
///
/// for all k from one solution. Where monitors r_1, .., r_h are held, the last h free parameters depend on the others:
/// q - sum of nu_i r_i has H = 0 by each of these, which is where nu comes from, and stands for q. With
/// y_k = (z_k, e_k), the change of the orbit with p_k (and of those parameters),
///
///     dH_k = D^2 q (y_k, .) - l . D^2 F (y_k, .),
///
/// for F' y_k = 0, and l takes the change of z_k out [E. J. Doedel, H. B. Keller, J. P. Kernevez, Int.
/// J. Bifurcation and Chaos 1 (1991) 493 and 745: successive continuation]. D^2 F is exact, D^2 q the central
/// difference, of fourth order, of the monitors' gradients along y_k.
#pragma once

#include <vector>

#include "orbit/condensed_return_map.hpp"
#include "orbit/monitor.hpp"
#include "orbit/nodal_system.hpp"

namespace tchat {

class ReducedGradient {
 public:
  /// The arguments outlive this object. Of the system's free parameters, the last held.size() depend on the others.
  ReducedGradient(const DefiningSystem& system, const OrbitShape& shape, const Monitor& objective,
                  std::vector<const Monitor*> held);

  /// How many independent parameters: the first ones of the system.
  int count() const { return static_cast<int>(values_.size()); }

  /// H at x. False where there is none, why_none() says why.
  bool evaluate(const Orbit& x);
  const char* why_none() const { return why_none_; }
  /// Does a monitor depend on the phase of x, an orbit where evaluate() was last, while no event fixes it? Then H says
  /// nothing.
  bool depends_on_phase(const Orbit& x);
  double value(int k) const { return values_(k); }
  /// The terms that H_k is the sum of, without their signs, and q / (1 + |p_k|): what H_k is small or large against.
  double size(int k) const { return sizes_(k); }

  /// Sets `row` to dH_k at x, where evaluate() was last.
  void derivative(const Orbit& x, int k, OrbitVector& row);
  /// How far x, where evaluate() was last, is from an orbit with H_k = 0 when p_k alone changes, by Newton's step in
  /// units of 1 + |p_k|; infinite where the second derivative may be zero.
  double distance(const Orbit& x, int k);
  /// y_k; until the next call.
  const OrbitVector& tangent(int k);

  /// What a stationary point is in some of the parameters, the others fixed.
  enum class Nature { minimum, maximum, saddle, unknown };
  /// From the second derivatives in these, at x, where evaluate() was last and H is zero in them: unknown where an
  /// eigenvalue may be zero.
  Nature nature(const Orbit& x, const std::vector<int>& parameters);

 private:
  bool find_multipliers();
  double relative_change(const Orbit& x, const OrbitVector& y) const;
  void add_monitor_gradient(const Orbit& x, const OrbitVector& along, double step, double factor, OrbitVector& row);

  const DefiningSystem& system_;
  CollocationRule rule_;
  std::vector<const Monitor*> monitors_;  // q, r_1, ..
  NodalSystem nodal_;
  CondensedReturnMap map_;
  Eigen::MatrixXd derivatives_, terms_;   // of each monitor by each free parameter, and the sizes of their terms
  std::vector<Eigen::VectorXd> adjoint_;  // of each monitor
  Eigen::VectorXd combined_;              // l
  Eigen::VectorXd combination_;           // 1, -nu
  Eigen::MatrixXd dependent_;             // of the last parameters by the independent ones
  Eigen::VectorXd values_, sizes_;
  RowWeights weights_;
  OrbitVector tangent_, row_, second_row_;
  const char* why_none_ = "";
  Orbit displaced_;
};

}  // namespace tchat
