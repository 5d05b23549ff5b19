/// An orbit put together from pieces of another one: the same curve with other cuts.
///
/// A piece is the part tau in [from, to] of one segment; scaled to [0, 1] it is a segment of duration
/// (to - from) T_s of the new orbit. from = to is a segment of zero duration, constant: in the old orbit's state there,
/// or in a state of its own. All new segments share one mesh: the old mesh when every piece is a whole segment (then
/// states and direction are copied exactly), otherwise a mesh whose density is the sum of those that the old mesh gives
/// to the pieces; there the old collocation polynomials are evaluated, so the new orbit has the accuracy that the old
/// one has between mesh points, order NCOL + 1. Where segments have meshes of their own, so have the new ones: each has
/// the density that the old mesh gives to its piece, and its share of the intervals.
#pragma once

#include <vector>

#include "orbit/collocation_rule.hpp"
#include "run/orbit_start.hpp"

namespace tchat {

struct OrbitPiece {
  int segment = 0;  ///< of the old orbit, from 0
  double from = 0.0;
  double to = 1.0;
  Eigen::VectorXd constant = {};  ///< state of an empty piece, where it is not that of the old orbit

  bool whole() const { return from == 0.0 && to == 1.0; }
  bool empty() const { return from == to; }
};

/// The direction is kept when all pieces are whole segments that keep their meshes, and dropped otherwise. Pieces must
/// not be empty as a list.
OrbitStart assemble(const OrbitStart& old, const std::vector<OrbitPiece>& pieces);

/// Each list of pieces, none empty, joined to one segment, on a mesh whose density is the sum of those of all pieces.
Orbit joined_orbit(const Orbit& old, const std::vector<std::vector<OrbitPiece>>& groups);

/// The state at the end of a piece.
Eigen::VectorXd end_of(const OrbitPiece& piece, const Orbit& x);

/// The collocation polynomial of segment s (from 0) at tau in [0, 1].
Eigen::VectorXd state_at(const Orbit& x, const CollocationRule& rule, int s, double tau);

}  // namespace tchat
