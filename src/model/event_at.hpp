/// An event function at one state, and how a flow meets its surface there; a jump at one state. Together they give the
/// derivative of a segment's map (2.26), for changes v = Phi v_0 of the state x_s(1) at fixed duration:
///
///     v -> g_x (v + f sigma),   sigma = -h_x v / (h_x f).
///
/// Allocates: not for Newton's loop.
#pragma once

#include <Eigen/Core>

#include "model/hybrid_system.hpp"

namespace tchat {

/// sigma, the change of the time at which a flow with the field f meets the surface with the normal h_x, for each
/// column of v (n x K): 1 x K. Not finite where h_x f = 0.
Eigen::RowVectorXd change_of_time(const Eigen::VectorXd& f, const Eigen::VectorXd& gradient, const Eigen::MatrixXd& v);
/// v + f sigma = (Id - f h_x / (h_x f)) v: onto that surface, along the flow.
Eigen::MatrixXd project_along_flow(const Eigen::VectorXd& f, const Eigen::VectorXd& gradient, const Eigen::MatrixXd& v);

struct EventAt {
  double h = 0.0;
  Eigen::VectorXd gradient;  ///< h_x, n
  Eigen::VectorXd f;         ///< the field, n; empty when none was asked for

  double rate() const { return gradient.dot(f); }              ///< h_x f
  double sizes() const { return gradient.norm() * f.norm(); }  ///< |h_x| |f|
  /// What rounding of the state, as a share of it, makes of h: up to this times that share h is zero.
  double scale(const double* x) const;
  /// Onto the surface of the event, along the flow.
  Eigen::MatrixXd project(const Eigen::MatrixXd& v) const { return project_along_flow(f, gradient, v); }
};

/// h_j and h_x alone.
EventAt event_at(const HybridSystem& system, int event, const double* x, const double* par);
/// With field i; h_x is zero for states that its mode has not.
EventAt event_at(const HybridSystem& system, int event, int field, const double* x, const double* par);
/// The gradient of h_x f of field i at the same state: h_xx f + h_x f_x.
Eigen::VectorXd rate_gradient(const HybridSystem& system, const EventAt& at, int event, int field, const double* x,
                              const double* par);

/// g_k and g_x at one state.
struct JumpAt {
  Eigen::VectorXd image;       ///< n
  Eigen::MatrixXd derivative;  ///< n x n
};
JumpAt jump_at(const HybridSystem& system, int jump, const double* x, const double* par);

}  // namespace tchat
