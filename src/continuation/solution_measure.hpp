/// The printed numbers of an orbit: norms, maxima and integrals over the whole period, whatever its cuts into segments.
#pragma once

#include "orbit/collocation_rule.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

/// sqrt of the time mean of sum_i theta_i u_i^2: each segment weighted by T_s / sum T (equally when all T_s are 0).
double l2_norm(const Orbit& x, const CollocationRule& rule, const Eigen::VectorXd& state_weights);

/// Largest and smallest value of U(k), k = 1..n, over the stored points of all segments.
double maximum_of(const Orbit& x, int k);
double minimum_of(const Orbit& x, int k);

/// The measure that IPLT selects: 0 or |IPLT| > 3n the L2-norm; 1..n maximum, -1..-n minimum, n+1..2n time mean,
/// 2n+1..3n L2-norm of one component.
double solution_measure(const Orbit& x, const CollocationRule& rule, const Eigen::VectorXd& state_weights, int iplt);

}  // namespace tchat
