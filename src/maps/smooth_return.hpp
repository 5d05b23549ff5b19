/// Smooth return maps to a section and their Taylor polynomials of first and second order.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "maps/suspended_system.hpp"
#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "model/parameter_vector.hpp"
#include "motion/watched_flow.hpp"

namespace tchat {

// A smooth map by its Taylor polynomial of first or second order at a point:
//
//     z -> value + first (z - at) + 1/2 (z - at)^T second_i (z - at)

struct QuadraticMap {
  Eigen::VectorXd at;                   ///< N
  Eigen::VectorXd value;                ///< N
  Eigen::MatrixXd first;                ///< N x N
  std::vector<Eigen::MatrixXd> second;  ///< for each component N x N, symmetric; empty: a map of first order
  double time = 0.0;                    ///< that the flow takes from `at` to `value`

  int order() const { return second.empty() ? 1 : 2; }
  Eigen::VectorXd operator()(const Eigen::VectorXd& z) const;
  Eigen::MatrixXd derivative(const Eigen::VectorXd& z) const;
};

// Maps of a section to itself that stand for a flow, and what a composite map is made of.
//
// States are those of incoming trajectories of the smooth flow; contact is accounted for after them, by the
// discontinuity map. The map depends on parameters; of those that it was not expanded in, only the values it was made
// with are right.

/// P_smooth: the return of the flow without contact.
class SmoothMap {
 public:
  virtual ~SmoothMap() = default;
  virtual Eigen::VectorXd image(const Eigen::VectorXd& x, const ParameterVector& par) const = 0;
  /// n x n. Directions off the section are projected along the flow.
  virtual Eigen::MatrixXd derivative(const Eigen::VectorXd& x, const ParameterVector& par) const = 0;
  /// How long the return from near x takes.
  virtual double time(const Eigen::VectorXd& x) const = 0;
  /// x - y, the way round that is shorter for angles.
  virtual Eigen::VectorXd difference(const Eigen::VectorXd& x, const Eigen::VectorXd& y) const { return x - y; }
  /// Scale of each state: what the orbit or torus extends over.
  virtual const Eigen::VectorXd& extent() const = 0;
  /// Distance from the orbit or torus, each state by its extent; the map is no good where that is not small.
  virtual double distance(const Eigen::VectorXd& x) const = 0;
};

/// One return of an iterated map.
struct Iterate {
  Eigen::VectorXd image;
  double penetration = 0.0;  ///< of the point that was mapped: positive, when it has been in contact
  bool contact = false;      ///< the discontinuity map has been applied
  bool missed = false;       ///< penetration is positive, but farther from x* than the discontinuity map is good for
  double time = 0.0;
  double depth = 0.0;  ///< penetration relative to what h_D ranges over on the motion; 0 without contact
};

/// What is iterated: a composite map or a reduced one.
class IteratedMap {
 public:
  virtual ~IteratedMap() = default;
  virtual Iterate step(const Eigen::VectorXd& x, const ParameterVector& par) const = 0;
  /// d x d, of the step in the d coordinates that its exponents are of (n, or 1 of a reduced map).
  virtual Eigen::MatrixXd tangent(const Eigen::VectorXd& x, const ParameterVector& par) const = 0;
  virtual Eigen::Index coordinates() const = 0;
  /// How many exponents exist: those of directions in the section.
  virtual Eigen::Index exponents() const = 0;
  virtual const SmoothMap& smooth() const = 0;
};

// Which events a smooth flow meets between two intersections with a section.

/// From z on the section (event function `section`, whether it ends segments or not) to its next fall: the index
/// vectors met on the way, then (field, section, 0). The first mode is what the problem says of a start, `field` where
/// it says nothing. Throws ComputationError when the flow does not come back, or after `most` segments.
Signature return_path(const HybridSystem& system, const Eigen::VectorXd& z, const Eigen::VectorXd& par, int section,
                      int field, const FlowOptions& options, int most = 1000);

// The return of a flow to a section, with jumps on its way, expanded in the start to first or second order:
//
//     Phi' = f_z Phi,    S_ab' = f_z S_ab + f_zz Phi_a Phi_b                (variational equations)
//     z -> Phi(z, T + tau(z)),  h(.) = 0 gives the time tau to each order,  then z -> g(z)
//
// N states (of a suspended system: with parameters among them), one unknown tau and one equation for each event.

/// Along `path` from z: each index vector's field until its event falls to zero, then its jump (`no_function`: none).
/// Events and their first derivatives are located by CVODES; second derivatives along them by a Runge-Kutta formula of
/// order 7. `par` has the room of the problem's ParameterLayout; `order` is 1 or 2. Throws ComputationError, naming the
/// segment, for what cannot be integrated, an event that does not come, and one that is met tangentially.
QuadraticMap smooth_return(const HybridSystem& system, const Signature& path, const Eigen::VectorXd& z,
                           const Eigen::VectorXd& par, int order, const FlowOptions& options = {});

// P_smooth of a periodic orbit in grazing contact: its Taylor polynomial at x*, in the state and in parameters.

/// The orbit as it is cut: from x*, index vectors, durations.
struct GrazingTurn {
  Eigen::VectorXd x;    ///< x*, on P, n
  ParameterVector par;  ///< p*
  /// From x* to x*; the last one ends at x*, whatever its event. Jumps may be `no_function`.
  Signature segments;
  std::vector<double> durations;  ///< of each
  Eigen::VectorXd extent;         ///< range of each state over the orbit, n
};

class PeriodicReturn : public SmoothMap {
 public:
  /// `section` is the event function of `suspended` that is the section: `suspended.least_distance()`, its plane, or
  /// one of the problem's. `order` 1 or 2. Throws ComputationError when the turn does not come back to x*.
  PeriodicReturn(std::shared_ptr<const SuspendedSystem> suspended, const GrazingTurn& turn, int section, int order,
                 const FlowOptions& options = {});

  Eigen::VectorXd image(const Eigen::VectorXd& x, const ParameterVector& par) const override;
  Eigen::MatrixXd derivative(const Eigen::VectorXd& x, const ParameterVector& par) const override;
  double time(const Eigen::VectorXd&) const override { return map_.time; }
  const Eigen::VectorXd& extent() const override { return extent_; }
  double distance(const Eigen::VectorXd& x) const override;

  /// In (x, q) of the suspended system.
  const QuadraticMap& map() const { return map_; }
  const Signature& path() const { return path_; }

 private:
  std::shared_ptr<const SuspendedSystem> suspended_;
  Signature path_;
  QuadraticMap map_;
  Eigen::VectorXd extent_;
};

}  // namespace tchat
