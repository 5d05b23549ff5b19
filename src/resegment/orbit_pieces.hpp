/// Orbits put together from pieces of another one, on which side their branch leads, and their NAME.dat.
#pragma once

#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/orbit.hpp"
#include "run/orbit_start.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// An orbit put together from pieces of another one: the same curve with other cuts.
//
// A piece is the part tau in [from, to] of one segment; scaled to [0, 1] it is a segment of duration
// (to - from) T_s of the new orbit. from = to is a segment of zero duration, constant: in the old orbit's state there,
// or in a state of its own. All new segments share one mesh: the old mesh when every piece is a whole segment (then
// states and direction are copied exactly), otherwise a mesh whose density is the sum of those that the old mesh gives
// to the pieces; there the old collocation polynomials are evaluated, so the new orbit has the accuracy that the old
// one has between mesh points, order NCOL + 1. Where segments have meshes of their own, so have the new ones: each has
// the density that the old mesh gives to its piece, and its share of the intervals.

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

// Which way a branch leads that begins where an event or a segment is born.

/// What is born at the start of a branch; segments count from 0.
struct Birth {
  std::vector<int> impacts;         ///< segments whose ends are in grazing contact: h_x f is to fall there
  std::vector<int> empty_segments;  ///< of zero duration: it is to grow

  struct EndEvent {
    int segment, event;
  };
  std::vector<EndEvent> late_events;  ///< zero just at the end of a segment that another event ends: to come later

  struct InnerContact {
    int segment, event;
    double tau;
  };
  std::vector<InnerContact> lost_contacts = {};  ///< the surface is touched there: the orbit is to leave it

  bool is_any() const {
    return !impacts.empty() || !empty_segments.empty() || !late_events.empty() || !lost_contacts.empty();
  }
};

/// The sign of DS with which the run of `settings` from `start` leads to where all of these exist. 0 when they
/// disagree, when nothing changes along the tangent, and when the run's first point is not the start (or none is
/// found).
int side_of_birth(const HybridSystem& users, const RunSettings& settings, const SelectedStart& start,
                  const Birth& birth);

// An orbit as a NAME.dat file: parameter values and durations in comments, then rows of the states at the mesh points
// and between them.

std::string data_text(const Orbit& x, const HybridSystem& system);

}  // namespace tchat
