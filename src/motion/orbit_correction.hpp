/// A periodic orbit near a motion, corrected by Newton's method on turns of the simulation itself, and whether the
/// motion approaches it.
///
///     y - R(y) = 0,   (Id - M) dy = R(y) - y,   y moved onto the event's surface after each step
///
/// with R and M of motion/tangent_flow.hpp. A state that nothing depends on keeps its value and has no equation.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "motion/found_orbit.hpp"
#include "motion/tangent_flow.hpp"

namespace tchat {

/// What a correction starts from.
struct OrbitCandidate {
  const HybridSimulation& motion;       ///< stands behind an event
  Eigen::VectorXd end;                  ///< the state in which it was met, n
  Signature signature;                  ///< the index vectors of the turn, the last one that of this event
  Eigen::VectorXd scale;                ///< of each state, n; infinite where nothing depends on it
  std::vector<Eigen::Index> ignorable;  ///< states that nothing depends on, from 0
  SimulationSettings settings;          ///< of the corrected turn
  std::vector<Eigen::VectorXd> passed;  ///< y of the turns before, in the order of time, the last one being `end`
};

struct CorrectedOrbit {
  bool converged = false;
  bool is_smooth = true;  ///< false: the motion's own turn has no derivative, so that nothing could be corrected
  std::string fault;      ///< why it has not converged
  Eigen::VectorXd end;    ///< y of the orbit
  SimulatedTurn turn;     ///< from there
  /// Largest modulus first, without those of ignorable states; one is 0, along the flow.
  std::vector<std::complex<double>> multipliers;
  double uncertainty = 0.0;  ///< of their moduli: the difference between two tolerances, and what the correction leaves
  Eigen::VectorXd passed;    ///< R(y) of the motion's own y

  OrbitStability stability() const { return stability_of(multipliers, uncertainty); }
};

CorrectedOrbit correct_orbit(const OrbitCandidate& candidate);

/// The turn from y as accurately as it is corrected, with the samples and marks of the candidate's settings.
SimulatedTurn turn_of(const OrbitCandidate& candidate, const Eigen::VectorXd& y);

/// Whether the orbits beside one with the derivative M of its turn are closed as well.
enum class Neighbours {
  isolated,  ///< no multiplier is 1: there are none
  closed,    ///< one of a family, as where the energy is conserved
  open,      ///< a multiplier is 1, and turns beside do not close: a fold is near, or nothing is an orbit here
};

/// Of y, which its turn takes to itself to the noise of integration. In every direction of a multiplier +1, where Id -
/// M is singular in units of the scale, to 1e-4 or to ten times the `uncertainty` of multipliers, and both ways, by 5 %
/// of the scale or else by 1 %, a state is looked for whose turn moves it along the left null vectors alone
/// (Lyapunov-Schmidt). Where it is not moved (g = 0) the orbit beside is closed.
///
///     y* - R(y*) + W g = 0,  V'(y* - y) = s e_k:   n + m unknowns (y*, g), n + m equations
///
/// g is a bifurcation function: beside a fold it is s^2, at a cusp s^3, of a family 0.
Neighbours neighbours_of(const OrbitCandidate& candidate, const Eigen::VectorXd& y, double uncertainty);

/// W = sum over k of M^k' D^2 M^k, D = diag(1 / scale), 0 where that is not positive; not finite where M^k does not
/// decay.
Eigen::MatrixXd decay_weight(Eigen::MatrixXd m, const Eigen::VectorXd& scale);

/// Does the motion approach this stable orbit? V(d) = sum over k of |D M^k d|^2, D = diag(1 / scale), falls from turn
/// to turn where the orbit's linearisation M holds. V of the motion's distance d from the orbit must fall by half of
/// what M predicts, at least, in the turns that follow, and in turns from states between the motion and the orbit, so
/// that M holds all the way. A distance that integration cannot tell from zero is no distance.
bool approaches(const OrbitCandidate& candidate, const CorrectedOrbit& orbit);

/// Is the motion still leaving this unstable orbit? Its distance d has become about M d in each of the last turns, and
/// has grown as the largest multiplier says. Its exponents are then those of the orbit.
bool is_leaving(const OrbitCandidate& candidate, const CorrectedOrbit& orbit);

}  // namespace tchat
