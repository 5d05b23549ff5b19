/// One segment of a stored orbit against CVODES, independent of collocation: from the stored start, over the stored
/// duration, is the stored end reached, is the terminal event met there, and does nothing else come first?
///
///     x' = f_i(x, p), x(0) = x_s(0):   x(T_s) = x_s(1),   h_j(x(T_s)) = 0,   h_k > 0 before, for all events that end
///                                                                            or forbid the segment
///
/// The size of an event function is the largest sum |h_x| scale along the segment: what a change of all states by their
/// scales makes of h. Trouble of the integrator is a value (`message`), never an exception.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"

namespace tchat {

/// What is known of the segment. States are measured by `scale`.
struct StoredSegment {
  IndexVector index;
  int next_field = 1;     ///< of the segment after it
  int integrand = 0;      ///< number of the segment where the problem has integral conditions, from 1
  bool grazing = false;   ///< ends in contact, h = h_x f = 0 (IPS 150)
  Eigen::VectorXd start;  ///< x_s(0)
  Eigen::VectorXd end;    ///< x_s(1), before the jump
  double duration = 0.0;  ///< T_s
  double period = 1.0;    ///< of the orbit
  /// Event functions that may not be negative anywhere on the segment (GCHGRZIND).
  std::vector<int> monitored;
  /// What else could have ended the segment, by the problem's index jump function: same field, other events.
  std::vector<IndexVector> alternatives;
};

/// The integral of q over the segment, NINT values, and sizes: integrals of |q| + sum |q_x| scale.
struct IntegralValues {
  Eigen::VectorXd values;
  Eigen::VectorXd sizes;
};

struct EventMet {
  int event = 0;
  double time = 0.0;   ///< since the start of the segment
  double depth = 0.0;  ///< how far h goes below zero before the segment's end: -h / its size
};

struct SegmentCheck {
  std::string message;           ///< why it could not be integrated; empty when it was
  Eigen::VectorXd end;           ///< x(T_s)
  Eigen::MatrixXd flow;          ///< Phi, n x n: d x(T_s) / d x_s(0) at fixed T_s
  double growth = 1.0;           ///< |Phi| in scaled states, row sum norm: how errors of the start grow
  double state_defect = 0.0;     ///< largest |x(T_s) - x_s(1)| / scale
  double time_defect = 0.0;      ///< between T_s and the time at which the terminal event happens
  double event_level = 0.0;      ///< |h| / its size at x(T_s): the same as a distance
  bool touches = false;          ///< the terminal surface is met tangentially, to the tolerance
  bool leaves_surface = false;   ///< h_x f > 0 at the end: the event is crossed from below
  bool breaks_rules = false;     ///< by those of the problem another segment follows
  IntegralValues integrals;      ///< of the problem's integrands; empty without `integrand`
  std::vector<EventMet> wrong;   ///< events met before the end that end or forbid the segment, in time
  std::vector<EventMet> passed;  ///< events met that change nothing (sections: the same field, the same state after it)
};

/// `par` has the room of the problem's ParameterLayout; `scale` > 0 for every state; an event function that goes less
/// than `tolerance` (in `depth`) below zero touches it only.
SegmentCheck check_segment(const HybridSystem& system, const StoredSegment& segment, const Eigen::VectorXd& par,
                           const Eigen::VectorXd& scale, double tolerance);

}  // namespace tchat
