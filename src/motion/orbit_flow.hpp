/// Segments, return maps and periodic orbits of a signature by forward integration, independent of collocation.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "motion/watched_flow.hpp"

namespace tchat {

// Forward integration of one segment with CVODES, independent of collocation.
//
//     x' = f_i(x, p), x(0) = x0, until h_j(x, p) falls through zero (from + to -), or for a given duration;
//     Phi' = f_x Phi, Phi(0) = Id, along with it.
//
// Start on the event surface (|h| / (1 + |h_x| |x|) <= surface_tolerance, as after an impact or on a section): the
// start itself is never taken for the event. If the flow leaves to the positive side, the next fall through zero ends
// the segment. If it leaves to the negative side (the start is just behind the event, as on a Poincare section), h
// must rise above zero first; the crossing by rounding at the start is passed over. A start elsewhere with h < 0 is
// treated likewise: h must rise first.
//
// What cannot be integrated is a value of the result (status, message). UserError: index vector outside the problem's
// ranges, wrong length of x0 or par, entries that are not finite, PAR indices in `active` out of range.

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

/// An event that comes at once, as the second of two that happen together: on an orbit beside it a little later, or
/// earlier. Its time is the zero of h next to 0, of either sign, by Newton's method.
SegmentFlow integrate_to_instant(const HybridSystem& system, const IndexVector& index, const Eigen::VectorXd& x0,
                                 const Eigen::VectorXd& par, const FlowOptions& options = {});

/// For a fixed duration, which may be zero or negative; ends with time_reached.
SegmentFlow integrate_for(const HybridSystem& system, int field, const Eigen::VectorXd& x0, const Eigen::VectorXd& par,
                          double duration, const FlowOptions& options = {});

// Return maps and periodic orbits of a signature by forward integration (shooting), independent of collocation.
//
//     x_s(0) -> x_s(1) by field i_s to event j_s,   x_{s+1}(0) = g_{k_s}(x_s(1), p),
//     P_s = (Id - f h_x / (h_x f)) Phi_s,            M = g_{k_m,x} P_m ... g_{k_1,x} P_1         (2.26)
//
// The eigenvalues of M are the Floquet multipliers of a periodic orbit; one is zero (along the flow). Parameter
// derivatives of the map count the change of the durations and of the jumps.
//
// What cannot be computed (no event, h_x f = 0 at an end, no convergence) is a value of the result. UserError as for
// integrate_segment, and for an empty signature.

struct MapSegment {
  Eigen::VectorXd start;           ///< x_s(0)
  Eigen::VectorXd end;             ///< x_s(1), before the jump
  double duration = 0.0;           ///< T_s
  double event_velocity = 0.0;     ///< h_x f at the end
  Eigen::MatrixXd flow_jacobian;   ///< Phi_s, n x n
  Eigen::MatrixXd map_derivative;  ///< P_s, n x n
};

struct ReturnMap {
  bool ok = false;
  std::string message;  ///< why not ok, naming the segment (from 1)
  std::vector<MapSegment> segments;
  Eigen::VectorXd end;                   ///< state after the last jump, n
  double period = 0.0;                   ///< sum of the durations
  Eigen::MatrixXd derivative;            ///< M, n x n
  Eigen::MatrixXd parameter_derivative;  ///< d end / d PAR(active), n x active
  Eigen::VectorXcd multipliers;          ///< eigenvalues of M, largest modulus first
};

/// One turn through the signature from x1 = x_1(0); without derivatives where `options` are not variational.
/// `instants`: of each segment, does its event come at once? None does where this is empty.
ReturnMap return_map(const HybridSystem& system, const Signature& signature, const Eigen::VectorXd& x1,
                     const Eigen::VectorXd& par, const FlowOptions& options = {},
                     const std::vector<bool>& instants = {});

struct ShootingOptions {
  FlowOptions flow;
  int max_iterations = 20;
  double tolerance = 1e-11;  ///< on |Newton step| / (1 + |x|), of the last step taken, in sizes of states if known
  /// States that nothing depends on and that need not return (a position on an endless floor), from 0: kept at their
  /// start, and without an equation.
  std::vector<Eigen::Index> ignorable;
  std::vector<bool> instants = {};  ///< as for return_map()
};

struct PeriodicOrbit {
  bool converged = false;
  std::string message;    ///< why not
  int iterations = 0;     ///< Newton steps taken
  double residual = 0.0;  ///< |x1 - return map(x1)|, maximum norm
  Eigen::VectorXd start;  ///< x_1(0)
  ReturnMap map;          ///< at `start`
};

/// The shortest dx, n, in sizes of states (n, 0 where not known) with (Id - M) dx = gap, as far as Id - M is not
/// singular to 1e-8: the orbit of a family that is nearest. Of a state that nothing depends on dx_k = gap_k.
Eigen::VectorXd closing_step(const Eigen::MatrixXd& derivative, const Eigen::VectorXd& gap,
                             const std::vector<Eigen::Index>& ignorable, const Eigen::VectorXd& sizes);

/// Newton's method on x1 - R(x1) = 0 with the matrix Id - M; of many states, next to the orbit, with that of an earlier
/// step. The signature's own events fix the phase, so the matrix is regular away from folds and branch points.
PeriodicOrbit shoot(const HybridSystem& system, const Signature& signature, const Eigen::VectorXd& guess,
                    const Eigen::VectorXd& par, const ShootingOptions& options = {});

}  // namespace tchat
