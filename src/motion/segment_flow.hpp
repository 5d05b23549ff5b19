/// Forward integration of one segment with CVODES, independent of collocation.
///
///     x' = f_i(x, p), x(0) = x0, until h_j(x, p) falls through zero (from + to -), or for a given duration;
///     Phi' = f_x Phi, Phi(0) = Id, along with it.
///
/// Start on the event surface (|h| / (1 + |h_x| |x|) <= surface_tolerance, as after an impact or on a section): the
/// start itself is never taken for the event. If the flow leaves to the positive side, the next fall through zero ends
/// the segment. If it leaves to the negative side (the start is just behind the event, as on a Poincare section), h
/// must rise above zero first; the crossing by rounding at the start is passed over. A start elsewhere with h < 0 is
/// treated likewise: h must rise first.
///
/// What cannot be integrated is a value of the result (status, message). UserError: index vector outside the problem's
/// ranges, wrong length of x0 or par, entries that are not finite, PAR indices in `active` out of range.
#pragma once

#include <Eigen/Core>
#include <string>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "motion/flow_options.hpp"

namespace tchat {

enum class FlowStatus {
  event_reached,  ///< ended on the event surface
  time_reached,   ///< ended after the wanted duration, or after max_duration without an event
  failed,         ///< the integrator gave up; see message
};

struct SegmentFlow {
  FlowStatus status = FlowStatus::failed;
  std::string message;                   ///< for time_reached without an event, and failed
  double duration = 0.0;                 ///< T
  Eigen::VectorXd end_state;             ///< x(T), n
  Eigen::MatrixXd jacobian;              ///< Phi(T), n x n; d x(T) / d x0 at fixed T
  Eigen::MatrixXd parameter_derivative;  ///< n x active: d x(T) / d PAR(active) at fixed T
  double event_velocity = 0.0;           ///< h_x f at x(T); of the terminal event function
};

/// PAR(1), PAR(2), ... checked and padded with zeros to at least the room of the problem's ParameterLayout. UserError:
/// fewer than the problem's parameters, or not finite.
Eigen::VectorXd full_parameters(const HybridSystem& system, const Eigen::VectorXd& par);

/// `par` is PAR(1), PAR(2), ... : at least the problem's parameters.
SegmentFlow integrate_segment(const HybridSystem& system, const IndexVector& index, const Eigen::VectorXd& x0,
                              const Eigen::VectorXd& par, const FlowOptions& options = {});

/// For a fixed duration, which may be zero or negative; ends with time_reached.
SegmentFlow integrate_for(const HybridSystem& system, int field, const Eigen::VectorXd& x0, const Eigen::VectorXd& par,
                          double duration, const FlowOptions& options = {});

}  // namespace tchat
