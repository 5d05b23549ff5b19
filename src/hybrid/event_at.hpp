/// An event function at one state, and how a flow meets its surface there. Allocates: not for Newton's loop.
#pragma once

#include <Eigen/Core>

#include "hybrid/hybrid_system.hpp"

namespace tchat {

struct EventAt {
  double h = 0.0;
  Eigen::VectorXd gradient;  ///< h_x, n
  Eigen::VectorXd f;         ///< the field, n; empty when none was asked for

  double rate() const { return gradient.dot(f); }              ///< h_x f
  double sizes() const { return gradient.norm() * f.norm(); }  ///< |h_x| |f|
  /// What rounding of the state, as a share of it, makes of h: up to this times that share h is zero.
  double scale(const double* x) const;
};

/// h_j and h_x alone.
EventAt event_at(const HybridSystem& system, int event, const double* x, const double* par);
/// With field i.
EventAt event_at(const HybridSystem& system, int event, int field, const double* x, const double* par);
/// The gradient of h_x f of field i at the same state: h_xx f + h_x f_x.
Eigen::VectorXd rate_gradient(const HybridSystem& system, const EventAt& at, int event, int field, const double* x,
                              const double* par);

}  // namespace tchat
