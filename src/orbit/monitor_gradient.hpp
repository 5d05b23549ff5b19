/// Derivatives of a monitor along a family of periodic orbits, and the condition that it is stationary.
#pragma once

#include <memory>
#include <vector>

#include "orbit/bordered_problem.hpp"
#include "orbit/monitor.hpp"
#include "orbit/return_map.hpp"

namespace tchat {

// How a monitor changes along a family of periodic orbits: its derivatives by the free parameters.
//
// With u an orbit and its durations and F(u, p) = 0 its equations, the orbits are a family u(p) where F_u is regular,
// and q(u, p) is a function on it. With M = F_u on all nodes (return_map.hpp), F_k its column of p_k and q_k the
// derivative by p_k in q itself,
//
//     M^T l = q_u,      H_k = dq / dp_k = q_k - l . F_k                             (adjoint)
//
// for all k from one solution. Where monitors r_1, .., r_h are held, the last h free parameters depend on the others:
// q - sum of nu_i r_i has H = 0 by each of these, which is where nu comes from, and stands for q. With
// y_k = (z_k, e_k), the change of the orbit with p_k (and of those parameters),
//
//     dH_k = D^2 q (y_k, .) - l . D^2 F (y_k, .),
//
// for F' y_k = 0, and l takes the change of z_k out [E. J. Doedel, H. B. Keller, J. P. Kernevez, Int.
// J. Bifurcation and Chaos 1 (1991) 493 and 745: successive continuation]. D^2 F is exact, D^2 q the central
// difference, of fourth order, of the monitors' gradients along y_k.

class ReducedGradient {
 public:
  /// The arguments outlive this object. Of the system's free parameters, the last held.size() depend on the others.
  ReducedGradient(const DefiningSystem& system, const OrbitShape& shape, const Monitor& objective,
                  const std::vector<const Monitor*>& held);

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

// Defining condition of curves on which a monitor is stationary in K parameters, K + 1 of them free (after those that
// depend on others, where monitors are held): H_1 = .. = H_K = 0 of ReducedGradient.
//
// Count. N unknowns u and N equations F: with K + 1 parameters and the K numbers H_k a curve. On it dq = H_{K+1}
// dp_{K+1}: where H_{K+1} = 0 the monitor is stationary in K + 1 parameters, and the curve of the next K begins.

/// Those of a list of held ones, which outlives them.
std::vector<const Monitor*> held_monitors(const std::vector<HeldMonitor>& held);

class StationaryMonitor final : public OrbitCondition {
 public:
  /// The system frees K + 1 parameters more than there are monitors held, and outlives the condition.
  StationaryMonitor(const DefiningSystem& system, const OrbitShape& shape, std::shared_ptr<const Monitor> objective,
                    const std::vector<HeldMonitor>& held);

  int count() const override { return gradient_.count() - 1; }
  bool evaluate(CondensedSystem& condensed, const Orbit& x) override;
  /// H_k and its gradient as a share of the size of H_k at the point that the step began from.
  double value(int k) const override { return gradient_.value(k) / scales_[static_cast<std::size_t>(k)]; }
  const OrbitVector& gradient(int k) const override { return rows_[static_cast<std::size_t>(k)]; }
  /// The sizes.
  void remember(std::vector<double>& memory) const override;
  void recall(const std::vector<double>& memory) override { scales_ = memory; }

  /// H_{K+1} of the last evaluation as a share of its size.
  double next_derivative() const { return gradient_.value(count()) / gradient_.size(count()); }

 private:
  std::shared_ptr<const Monitor> objective_;
  std::vector<HeldMonitor> held_;
  ReducedGradient gradient_;
  std::vector<double> scales_, next_scales_;
  std::vector<OrbitVector> rows_;
};

/// Is the monitor stationary at x in all independent parameters but the last one? Also false where the orbit is
/// no part of a family in these parameters.
bool is_stationary(const DefiningSystem& system, const Orbit& x, const Monitor& objective,
                   const std::vector<HeldMonitor>& held);

}  // namespace tchat
