/// What becomes of the orbit along a branch: does it shrink to a point, or a torus to a periodic orbit, does its period
/// grow without bound?
///
/// Of the `orbits` returns of a torus (orbit/torus_system.hpp) the deviation of a node is that from its mean over the
/// returns: it vanishes on a periodic orbit, run through so many times.
#pragma once

#include <optional>

#include "orbit/orbit.hpp"

namespace tchat {

/// Largest minus least value of each state over the orbit, n entries.
Eigen::VectorXd state_ranges(const Orbit& x);

/// Cosine of the angle between the states' deviations from their means, nodes being equal; both orbits on one mesh.
/// About -1 where a step has led through an equilibrium: beyond it the branch consists of the same orbits, begun half a
/// turn later.
double deviation_cosine(const Orbit& x, const Orbit& y, int orbits = 1);
/// What a step of unit length along `direction`, a vector of states, adds to x's deviation from its mean, as a share of
/// the deviation, in its own direction.
double deviation_growth(const Orbit& x, const Eigen::MatrixXd& direction, int orbits = 1);

/// How the period has grown since the parameter stands still.
struct PeriodGrowth {
  double from = 0.0;
  double to = 0.0;
  double parameter = 0.0;
};

class OrbitTrend {
 public:
  explicit OrbitTrend(int orbits = 1) : orbits_(orbits) {}

  /// An accepted point of the branch; `parameter` is the principal one.
  void add(const Orbit& x, double parameter);

  /// Is every state's range of deviations at most this share of its largest one so far?
  bool has_shrunk(const Orbit& x, double share) const;

  /// Nothing unless the period is positive and has grown by more than half since the parameter stands still.
  std::optional<PeriodGrowth> period_growth() const;

 private:
  struct Place {
    double parameter = 0.0;
    double period = 0.0;
  };
  int orbits_;
  Eigen::VectorXd largest_;  // ranges
  Eigen::VectorXd sizes_;    // largest moduli of the states
  Place still_;              // since when the parameter has stood still
  Place last_;
};

}  // namespace tchat
