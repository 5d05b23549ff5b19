/// The least value of an event function over a torus, followed from where it was last (torus_contact.hpp): in Newton's
/// loop, so that nothing is allocated after the first time.
///
/// Inner: on the orbit of phase phi, h_x f = 0 by Newton's method in tau on the collocation polynomial, then by the
/// flow from the mesh point before it. Outer: h_x x_phi = 0 by the secant method. At an end of the segment tau stays
/// there as long as h falls towards it: on a section h_P = 0 contact is always there.
#pragma once

#include <Eigen/Core>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <vector>

#include "orbit/collocation_rule.hpp"
#include "stability/torus_contact.hpp"

namespace tchat {

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

}  // namespace tchat
