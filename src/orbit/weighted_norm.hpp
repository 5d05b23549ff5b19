/// The inner product of pseudo-arclength continuation (5.50),
///
///     <a, b> = sum_s integral_0^1 sum_i theta_i a_i b_i dtau + sum_s theta_T a_T b_T + sum_g theta_g a_g b_g,
///
/// with weights theta from THU (states) and THL (durations and free parameters). Integrals are exact for the
/// polynomials. For several segments the sum grows with their number, as in AUTO's multi-segment problems.
#pragma once

#include <vector>

#include "linear/array_kernel.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

/// M of add_mass() and mass_product() for states of segment s (n x nodes) on the mesh of x: a . M v is the integral
/// of sum_i weights_i a_i v_i over its scaled time. The arguments must outlive it.
MassIntervals mass_intervals(const Orbit& x, const CollocationRule& rule, const Eigen::VectorXd& weights, int s);

class WeightedNorm {
 public:
  /// `state_weights` has n entries, `parameter_weights` those of the orbit's PAR, all >= 0.
  WeightedNorm(Eigen::VectorXd state_weights, ParameterVector parameter_weights);
  /// All weights 1, for orbits of this shape and a problem of at most 60 parameters.
  static WeightedNorm unit(const OrbitShape& shape);

  /// The dual vector <v, .> on the mesh of x, written to `row`. Returns its value on v, <v, v>.
  double dual(const Orbit& x, const CollocationRule& rule, const std::vector<int>& free_parameters,
              const OrbitVector& v, OrbitVector& row) const;

 private:
  Eigen::VectorXd state_weights_;
  ParameterVector parameter_weights_;
};

}  // namespace tchat
