/// The periodic orbit that a simulation has settled on, refined by shooting.
#pragma once

#include <complex>
#include <string>
#include <vector>

#include "simulation/orbit_flow.hpp"
#include "simulation/simulation_run.hpp"

namespace tchat {

struct FoundOrbit {
  bool converged = false;
  std::string message;  ///< why not
  Signature signature;
  std::vector<Mode> modes;  ///< what each segment watched
  Eigen::VectorXd start;    ///< x_1(0)
  ReturnMap map;            ///< one turn from there
  /// Floquet multipliers, largest modulus first; the 1 of each ignorable state left out.
  std::vector<std::complex<double>> multipliers;
  Eigen::VectorXd advance;                              ///< of each state in one turn: zero but for ignorable states
  int iterations = 0;                                   ///< Newton steps of shooting
  IntegrationMethod method = IntegrationMethod::adams;  ///< by which it was found

  /// Every multiplier at most 1 + 1e-5 in modulus.
  bool is_stable() const;
};

/// A turn whose Poincare sections (identity jump, the same field after it) no longer end segments: each joins the
/// segment after it. As it was when nothing else ends a segment. Samples and marks are not kept.
std::vector<SimulatedSegment> without_sections(const HybridSystem& system, std::vector<SimulatedSegment> turn);

/// A turn rotated so that its index vectors read the same wherever the simulation stopped: with `first`, if the orbit
/// has it, in front, and the smallest sequence of those.
std::vector<SimulatedSegment> in_standard_order(std::vector<SimulatedSegment> turn, const IndexVector& first);

/// Refines the recognised turn of `result`, whose segments are rotated so that the smallest index vector, or `first` if
/// the orbit has it, comes first. What fails is a value: no convergence, or convergence to another orbit than the one
/// simulated.
FoundOrbit refine(const HybridSystem& system, const SimulationResult& result, const Eigen::VectorXd& par,
                  const IndexVector& first);

}  // namespace tchat
