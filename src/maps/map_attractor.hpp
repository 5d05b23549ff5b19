/// What the iterates of a map settle on.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "maps/section_map.hpp"
#include "motion/attractor_kind.hpp"
#include "motion/growth_series.hpp"

namespace tchat {

struct MapIteration {
  long transient = 1000;      ///< returns that are dropped
  long returns = 1000;        ///< returns that are kept of a motion that does not repeat itself
  long most_returns = 64000;  ///< that exponents are computed over to tell its kind
  int max_period = 16;        ///< in returns
  double recognition = 1e-6;  ///< states that are equal, relative to the range of the iterates
  double escape = 1.0;        ///< distance from the orbit or torus, in its extents, beyond which the map has no meaning
  int exponents = 0;          ///< how many are wanted always; without any they are computed to tell a kind
  std::function<bool()> interrupted;
};

struct MapAttractor {
  /// Periodic unless a multiplier says that the orbit is unstable; chaotic if chaos_evidence() finds it so.
  AttractorKind kind = AttractorKind::none;
  std::string message;  ///< why it has escaped or not settled
  int period = 0;       ///< in returns; 0: not periodic
  double time = 0.0;    ///< of one period; NaN
  /// Section states, n x K: one period, also of an unstable orbit, or all after the transient; with the penetration of
  /// each and whether it has been in contact.
  Eigen::MatrixXd points;
  Eigen::VectorXd penetrations;
  std::vector<bool> contacts;
  std::optional<LyapunovSpectrum> spectrum;  ///< per unit of time; of a periodic orbit by its multipliers
  Eigen::VectorXd last;                      ///< to go on from
};

/// Iterates from x0. What goes wrong is a value; ComputationError when interrupted.
MapAttractor iterate_to_attractor(const IteratedMap& map, const Eigen::VectorXd& x0, const ParameterVector& par,
                                  const MapIteration& settings);

}  // namespace tchat
