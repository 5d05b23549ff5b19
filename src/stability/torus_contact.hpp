/// Grazing of invariant tori: the least value of an event function over a torus, followed along a branch, and the
/// condition that it is zero.
#pragma once

#include <Eigen/Core>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <vector>

#include "orbit/collocation_rule.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/torus_system.hpp"
#include "stability/test_function.hpp"

namespace tchat {

// Grazing of an invariant torus: the least value of an event function over all of it,
//
//     psi = min over phi and tau of h(x(tau; phi)),
//
// x(.; phi) the orbit of one return that starts at the phase phi: the trigonometric polynomial through the N orbits
// (orbit/torus_system.hpp), node by node. On each orbit the least value is found as on a periodic orbit
// (orbit/event_minima.hpp), polished by the flow, and then over phi between the neighbours of each that may have the
// least one beside it.

struct TorusContact {
  double phi = 0.0;  ///< in [0, 1), of the return
  double tau = 0.0;  ///< along the segment
  double value = 0.0;
  Eigen::VectorXd state;
};

/// Finds the least values of one event function on one segment of the return.
class TorusContactSearch {
 public:
  /// `segment` counts from 0, within the return. `system` outlives this.
  TorusContactSearch(const TorusSystem& system, int segment, int event);

  int segment() const { return segment_; }
  int event() const { return event_; }
  /// Over the whole torus; nothing where h has neither a minimum on the segment nor ends of its own.
  std::optional<TorusContact> least(const Orbit& x, const CollocationRule& rule) const;
  /// The one near the phase phi, within the distance to the neighbouring orbits.
  std::optional<TorusContact> least_near(const Orbit& x, const CollocationRule& rule, double phi) const;

 private:
  double stationary(const Orbit& x, const CollocationRule& rule, double phi) const;
  double slope(const Orbit& x, const CollocationRule& rule, double phi) const;
  std::optional<TorusContact> at(const Orbit& x, const CollocationRule& rule, double phi) const;

  const TorusSystem& system_;
  PeriodicOrbitSystem one_return_;
  int segment_;
  int event_;
};

class TorusContactTest final : public TestFunction {
 public:
  /// Beyond a falling zero the torus violates the model: `stop` ends the branch there.
  TorusContactTest(const TorusSystem& system, int segment, int event, bool stop);
  std::string name() const override;
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  const TorusSystem& system_;
  TorusContactSearch search_;
  bool stop_;
};

/// The rotation number passes p / q, q = 1..4: a strong resonance, where the motion on the torus may lock and the torus
/// break. Where it is not broken, another parametrisation of the curve that goes with the rotation by p / q solves the
/// equations too, so that they are singular: the passage is told, not located.
class StrongResonanceTest final : public TestFunction {
 public:
  StrongResonanceTest(int p, int q) : p_(p), q_(q) {}
  std::string name() const override;
  bool is_only_reported() const override { return true; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  int p_, q_;
};

// The least value of an event function over a torus, followed from where it was last (TorusContactSearch): in Newton's
// loop, so that nothing is allocated after the first time.
//
// Inner: on the orbit of phase phi, h_x f = 0 by Newton's method in tau on the collocation polynomial, then by the
// flow from the mesh point before it. Outer: h_x x_phi = 0 by the secant method. At an end of the segment tau stays
// there as long as h falls towards it: on a section h_P = 0 contact is always there.

class TorusContactFollower {
 public:
  /// `segment` counts from 0, within the return. `system` outlives this.
  TorusContactFollower(const TorusSystem& system, const OrbitShape& shape, int segment, int event);

  /// From contact.phi and contact.tau. False where it gets lost; `contact` is as good as nothing then.
  bool follow(const Orbit& x, const CollocationRule& rule, TorusContact& contact);

  /// The weights of a contact that was found in another way.
  void take_place(const Orbit& x, const CollocationRule& rule, const TorusContact& contact);

  /// Of the last contact: K(phi - l / N), the interval of tau, the weights of its nodes, and h_x.
  const Eigen::RowVectorXd& phase_weights() const { return weights_; }
  int interval() const { return interval_; }
  const Eigen::VectorXd& node_weights() const { return basis_; }
  const Eigen::VectorXd& gradient() const { return hx_; }

 private:
  void find_place(const Orbit& x, const CollocationRule& rule, double tau);
  void state_of(const Orbit& x, const Eigen::RowVectorXd& weights, const Eigen::VectorXd& basis, double turns,
                Eigen::VectorXd& u) const;
  double duration_of(const Orbit& x) const;
  bool rate_at(const double* u, const double* par, double& rate, double& rate_slope);
  bool find_least_time(const Orbit& x, const CollocationRule& rule, double phi, double& tau);
  bool polish(const Orbit& x, double phi, double tau, TorusContact& contact);
  bool flow(const Orbit& x, double time);
  /// The contact on the orbit of this phase, and h_x x_phi there.
  bool at(const Orbit& x, const CollocationRule& rule, double phi, TorusContact& contact, double& slope);

  using State = std::vector<double>;
  using Stepper = boost::numeric::odeint::controlled_runge_kutta<boost::numeric::odeint::runge_kutta_fehlberg78<State>>;

  const TorusSystem& system_;
  int segment_, event_, field_;
  Eigen::RowVectorXd weights_, slopes_;  // K and K' of the N orbits
  int interval_ = 0;
  Eigen::VectorXd basis_, basis_slopes_, start_basis_;
  Eigen::VectorXd u_, f_, hx_, curvature_, fxf_, by_phase_;
  Eigen::MatrixXd fx_;
  State y_;
  Stepper stepper_;
};

// Defining condition of tori in grazing contact (problem type 152): the least value of an event function h over the
// torus is zero,
//
//     G = min over phi, tau of h(x(tau; phi), p) = 0.
//
// One condition more than a torus has, so that a parameter more is free. At the least value h_x x_tau = h_x f = 0 and
// h_x x_phi = 0: what would have to be said of the orbit that touches, h = h_x f = 0 and stationary over phi, is said
// by the minimum, on any section, and the orbit that touches need not be one of the N. For the same reason the
// gradient is that of h at a fixed place of the torus: with x = sum_l K(phi - l / N) sum_k B_k(tau) x_{l,k},
//
//     dG = h_x sum_{l,k} K_l B_k dx_{l,k} + h_p dp.

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
