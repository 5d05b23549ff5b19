/// Events and jumps: how flows meet event surfaces, jumps without effect, dimensions of modes, sliding, and contact
/// segments.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"

namespace tchat {

// An event function at one state, and how a flow meets its surface there; a jump at one state. Together they give the
// derivative of a segment's map (2.26), for changes v = Phi v_0 of the state x_s(1) at fixed duration:
//
//     v -> g_x (v + f sigma),   sigma = -h_x v / (h_x f).
//
// Allocates: not for Newton's loop.

/// sigma, the change of the time at which a flow with the field f meets the surface with the normal h_x, for each
/// column of v (n x K): 1 x K. Not finite where h_x f = 0.
Eigen::RowVectorXd change_of_time(const Eigen::VectorXd& f, const Eigen::VectorXd& gradient, const Eigen::MatrixXd& v);
/// v + f sigma = (Id - f h_x / (h_x f)) v: onto that surface, along the flow.
Eigen::MatrixXd project_along_flow(const Eigen::VectorXd& f, const Eigen::VectorXd& gradient, const Eigen::MatrixXd& v);

/// What states of their sizes make of an event function with the gradient h_x (n) at x: up to this times the share to
/// which states are known h is zero. `sizes`: of the states, n; none: of a problem in units of its own orbit
/// (model/scaled_problem.hpp), whose states are of size 1. 0 where h depends on no state.
double surface_scale(const Eigen::VectorXd& gradient, const double* x, const Eigen::VectorXd& sizes);

struct EventAt {
  double h = 0.0;
  Eigen::VectorXd gradient;  ///< h_x, n
  Eigen::VectorXd f;         ///< the field, n; empty when none was asked for

  double rate() const { return gradient.dot(f); }              ///< h_x f
  double sizes() const { return gradient.norm() * f.norm(); }  ///< |h_x| |f|
  double scale(const double* x, const Eigen::VectorXd& sizes = {}) const { return surface_scale(gradient, x, sizes); }
  /// Of h_x f where states have these sizes (n): sum |h_x,i| size_i, in the time in which the fastest of them changes
  /// by its size. |h_x| |f| instead adds states of different units.
  double rate_scale(const Eigen::VectorXd& sizes) const;
  /// Onto the surface of the event, along the flow.
  Eigen::MatrixXd project(const Eigen::MatrixXd& v) const { return project_along_flow(f, gradient, v); }
};

/// h_j and h_x alone.
EventAt event_at(const HybridSystem& system, int event, const double* x, const double* par);
/// With field i; h_x is zero for states that its mode has not.
EventAt event_at(const HybridSystem& system, int event, int field, const double* x, const double* par);
/// x on the surface h_j = 0 by Newton's method, each step the shortest one in these sizes of states (n, 0 where not
/// known; none: 1). Nothing where h_j has no finite value, depends on no state or does not become zero. Field 0: all
/// states.
std::optional<Eigen::VectorXd> onto_surface(const HybridSystem& system, int event, int field, Eigen::VectorXd x,
                                            const double* par, const Eigen::VectorXd& sizes = {});
/// The gradient of h_x f of field i at the same state: h_xx f + h_x f_x.
Eigen::VectorXd rate_gradient(const HybridSystem& system, const EventAt& at, int event, int field, const double* x,
                              const double* par);

/// g_k and g_x at one state.
struct JumpAt {
  Eigen::VectorXd image;       ///< n
  Eigen::MatrixXd derivative;  ///< n x n
};
JumpAt jump_at(const HybridSystem& system, int jump, const double* x, const double* par);

// Jumps that change nothing: ends of segments that only cut an orbit, as on a Poincare section.

/// Is jump k the identity map in every mode? Tried at two generic states.
bool is_identity_jump(const HybridSystem& system, int k);
/// Does the jump at the end of this segment leave the states of its mode as they are?
bool is_identity_jump(const HybridSystem& system, const IndexVector& segment);
/// The first jump that leaves the states of a field's mode as they are; 0 when the problem has none.
int first_identity_jump(const HybridSystem& system, int field);

// Which modes of different dimension may follow each other.

/// Sets the entries of states that the mode of a field has not to zero.
void clear_absent(const HybridSystem& system, int field, Eigen::VectorXd& states);

/// Why the field `next` cannot follow a segment, as a sentence with a cure; "" where it can. After a jump the mode must
/// have exactly the states that the jump sets; after the identity it must have at least the states of the segment.
std::string mode_fault(const HybridSystem& system, const IndexVector& segment, int next);

// Which of the events that may come next matter: all but Poincare sections.

/// Whether `field` goes on after index vector v ends in state x, by the index jump function.
bool keeps_field(const HybridSystem& system, const IndexVector& v, int field, const double* x, const double* par);

/// Event functions of `following`, rising, each once, without those of sections: an identity jump after which, by the
/// index jump function in state x, `field` goes on.
std::vector<int> relevant_events(const HybridSystem& system, std::span<const IndexVector> following, int field,
                                 const double* x, const double* par);

// What the fields of a sliding mode (tchat_sliding) do at a state. Allocates: not for Newton's loop.

inline bool is_side(const tchat_sliding& mode, int field) { return field == mode.minus || field == mode.plus; }
inline int other_side(const tchat_sliding& mode, int side) { return side == mode.minus ? mode.plus : mode.minus; }
inline bool ends_sliding(const tchat_sliding& mode, int event) {
  return event == mode.to_minus || event == mode.to_plus;
}
/// The event function at which sliding ends with the field of a side.
inline int ends_with(const tchat_sliding& mode, int side) { return side == mode.minus ? mode.to_minus : mode.to_plus; }

/// How a side's field meets the surface.
struct SideRate {
  double away;   ///< h_x f in the direction from the surface into that side; negative: the field points at the surface
  double sizes;  ///< |h_x| |f|
};
SideRate side_rate(const HybridSystem& system, const tchat_sliding& mode, int side, const double* x, const double* par);

/// The surface's event function with its gradient, and whether h is zero there to this share of its scale.
bool is_on_surface(const HybridSystem& system, const tchat_sliding& mode, const double* x, const double* par,
                   double tolerance);

// Segments that begin and end on one event surface, which the orbit only passes: a one-sided spring is touched and
// left, a diode conducts for a while, a switch is on.
//
// The state does not jump where such a segment begins, so that it is born at a tangency of the orbit before it: the
// duration of the contact grows from zero like the square root of the parameter.

/// Is `own`, where it follows `before`, such a segment? The jump of `before` leaves the states of its surface as they
/// are, and these lie on the surface on which `own` ends; the fields differ (else the surface only cuts the orbit).
/// Tried at generic states of the surface: false where the functions have no finite values at any of them.
bool is_contact_segment(const HybridSystem& system, const IndexVector& before, const IndexVector& own);

/// The same for segment s (from 0) of a cyclic signature; never the only one.
bool is_contact_segment(const HybridSystem& system, const Signature& signature, int s);

}  // namespace tchat
