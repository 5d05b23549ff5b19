/// The periodic orbit that a simulation has settled on, refined by shooting, and its samples for a .dat file.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "motion/orbit_flow.hpp"
#include "motion/recurrence.hpp"

namespace tchat {

enum class OrbitStability {
  stable,    ///< every multiplier inside the unit circle
  neutral,   ///< the largest one on it, as far as its uncertainty tells
  unstable,  ///< one outside
};

/// By the largest modulus, known to +- uncertainty.
OrbitStability stability_of(const std::vector<std::complex<double>>& multipliers, double uncertainty);

/// Eigenvalues of a return map's derivative without the rows and columns of ignorable states, largest modulus first.
std::vector<std::complex<double>> multipliers_without(const Eigen::MatrixXd& derivative,
                                                      const std::vector<Eigen::Index>& ignorable);

struct FoundOrbit {
  bool converged = false;
  std::string message;  ///< why not
  Signature signature;
  std::vector<Mode> modes;     ///< what each segment watched
  std::vector<bool> instants;  ///< of each segment: has its event come together with the one before?
  Eigen::VectorXd start;       ///< x_1(0)
  ReturnMap map;               ///< one turn from there
  /// Floquet multipliers, largest modulus first; the 1 of each ignorable state left out.
  std::vector<std::complex<double>> multipliers;
  Eigen::VectorXd advance;                              ///< of each state in one turn: zero but for ignorable states
  int iterations = 0;                                   ///< Newton steps of shooting
  IntegrationMethod method = IntegrationMethod::adams;  ///< by which it was found

  Eigen::VectorXd sizes;      ///< of the states, n (StateSizes)
  double longest_wait = 0.0;  ///< for the event of a segment
  Eigen::VectorXd moved;      ///< of x_1(0), by the correction
  double uncertainty = 0.0;   ///< of the moduli of multipliers: what integration leaves

  OrbitStability stability() const { return stability_of(multipliers, uncertainty); }
};

/// A turn whose Poincare sections (identity jump, the same field after it) no longer end segments: each joins the
/// segment after it. As it was when nothing else ends a segment. Samples and marks are not kept.
std::vector<SimulatedSegment> without_sections(const HybridSystem& system, std::vector<SimulatedSegment> turn);

/// The orbit of a smooth system as one segment without a section, {(i,0,0)}, on which `monitored` event functions
/// count.
FoundOrbit without_cuts(FoundOrbit orbit, std::vector<int> monitored);

/// A turn rotated so that its index vectors read the same wherever the simulation stopped: with `first`, if the orbit
/// has it, in front, and the smallest sequence of those.
std::vector<SimulatedSegment> in_standard_order(std::vector<SimulatedSegment> turn, const IndexVector& first);

/// Refines a turn that has been recognised, whose segments are rotated so that the smallest index vector, or `first` if
/// the orbit has it, comes first. What fails is a value: no convergence, or convergence to another orbit than the one
/// simulated, unless that was a guess.
FoundOrbit refine(const HybridSystem& system, const Turn& recognised, const Eigen::VectorXd& par,
                  const IndexVector& first, bool is_guess = false);

// A refined periodic orbit as rows of a .dat file: all segments at common times tau of [0, 1], on the mesh that a
// continuation is to begin with.

struct OrbitSamples {
  std::vector<double> tau;  ///< rising, from 0 to 1: every mesh interval in 2 c equal parts
  Eigen::MatrixXd states;   ///< (n m) x tau.size(), segment 1's states first
  int intervals = 0;        ///< of the mesh
  double error = 0.0;       ///< of polynomials of degree c on it, estimated_interpolation_error()
};

/// Where samples lie so close together that a time, a share of the segment's duration, has no digits left for them.
struct FastPart {
  int segment = 1;      ///< in which most happens there
  int state = 1;        ///< that changes most there, as a share of its range
  double value = 0.0;   ///< of that state
  double before = 0.0;  ///< that value a millionth of the duration before, or after, where the segment begins with it
};
std::optional<FastPart> fastest_part(const OrbitSamples& samples, int dimension);

/// The mesh equidistributes the error that polynomials of degree `collocation` would make. It has `intervals`
/// intervals, and more where the orbit is so sharp that the error would be larger than 1e-7.
OrbitSamples sample_orbit(const HybridSystem& system, const FoundOrbit& orbit, const Eigen::VectorXd& par,
                          int intervals, int collocation);

}  // namespace tchat
