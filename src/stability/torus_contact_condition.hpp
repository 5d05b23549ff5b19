/// Defining condition of tori in grazing contact (problem type 152): the least value of an event function h over the
/// torus is zero,
///
///     G = min over phi, tau of h(x(tau; phi), p) = 0.
///
/// One condition more than a torus has, so that a parameter more is free. At the least value h_x x_tau = h_x f = 0 and
/// h_x x_phi = 0: what would have to be said of the orbit that touches, h = h_x f = 0 and stationary over phi, is said
/// by the minimum, on any section, and the orbit that touches need not be one of the N. For the same reason the
/// gradient is that of h at a fixed place of the torus: with x = sum_l K(phi - l / N) sum_k B_k(tau) x_{l,k},
///
///     dG = h_x sum_{l,k} K_l B_k dx_{l,k} + h_p dp.
#pragma once

#include "orbit/defining_system.hpp"
#include "stability/torus_contact.hpp"
#include "stability/torus_contact_follower.hpp"

namespace tchat {

class TorusContactCondition final : public OrbitCondition {
 public:
  /// `segment` counts from 0, within the return. `system` outlives this.
  TorusContactCondition(const TorusSystem& system, const OrbitShape& shape, int segment, int event);

  bool evaluate(CondensedSystem& condensed, const Orbit& x) override;
  double value(int = 0) const override { return contact_.value; }
  const OrbitVector& gradient(int = 0) const override { return gradient_; }
  const TorusContact& contact() const { return contact_; }
  /// phi and tau, from which the minimum is followed.
  void remember(std::vector<double>& memory) const override;
  void recall(const std::vector<double>& memory) override;

 private:
  bool find(const CollocationRule& rule, const Orbit& x);

  const TorusSystem& system_;
  TorusContactSearch search_;
  TorusContactFollower follower_;
  TorusContact contact_;
  bool started_ = false;
  OrbitVector gradient_;
  Eigen::VectorXd gradient_at_contact_;
};

}  // namespace tchat
