/// The derivative of one segment's map from its start to the start of the next one, as a matrix (2.26):
///
///     w = Phi v,   sigma = -h_x w / (h_x f),   v_next = g_x (w + sigma f).
///
/// It divides by h_x f, so it is for orbits that cross their sections: those of a torus, and the orbit that a torus is
/// born from. Multipliers of periodic orbits, near grazing too, are the business of floquet_multipliers.hpp.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "orbit/condensed_system.hpp"

namespace tchat {

struct SegmentMap {
  Eigen::MatrixXd to_end;          ///< v to the change of x_s(1), n x n: Phi + f sigma
  Eigen::RowVectorXd to_duration;  ///< v to sigma = change of T_s, n
  Eigen::MatrixXd to_next;         ///< v to the change of the next start: g_x to_end
};

/// Of segment s, from the linearisation at x. Not finite where h_x f = 0.
SegmentMap segment_map(const CondensedSystem& condensed, const Orbit& x, int s);

/// The derivative of the map over the segments first..last-1, n x n.
Eigen::MatrixXd return_matrix(const CondensedSystem& condensed, const Orbit& x, int first, int last);

}  // namespace tchat
