/// Maps of a section to itself that stand for a flow, and what a composite map is made of.
///
/// States are those of incoming trajectories of the smooth flow; contact is accounted for after them, by the
/// discontinuity map. The map depends on parameters; of those that it was not expanded in, only the values it was made
/// with are right.
#pragma once

#include <Eigen/Core>

#include "model/parameter_vector.hpp"

namespace tchat {

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

}  // namespace tchat
