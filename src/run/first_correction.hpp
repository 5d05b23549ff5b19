/// The first point of a branch: the start corrected to a solution at the parameter values asked for, and its tangent.
#pragma once

#include "continuation/newton_chord.hpp"
#include "continuation/path_follower.hpp"
#include "run/orbit_start.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// From a start that is not yet a solution to an orbit at the parameter values asked for.

class DefiningSystem;
class PathFollower;

struct FirstCorrection {
  PathPoint point;
  std::vector<NewtonIteration> history;  ///< of the start itself, not of what followed on other meshes
  std::string refusal;                   ///< why this point is none to begin with, or empty
  std::string note;                      ///< what the user has to know of it, or empty
};

/// Newton with ICP(1) fixed. Where that fails and the command line changed parameter values, the orbit is followed to
/// them in steps from the values that it was known at; where that fails too, minimum-norm steps with ICP(1) free, which
/// find a fold or codimension-two point near the start: ICP(1) may move by what the data's accuracy explains, and
/// further only with ICPMOVE = 1. A start from data is corrected again on meshes adapted to it, unless IAD = 0.
/// An orbit that is found only elsewhere has a refusal with both values: the caller may know a better reason. Throws
/// ComputationError where nothing converges, with the residual of every condition.
FirstCorrection correct_start(PathFollower& follower, const DefiningSystem& system, const SelectedStart& selected,
                              const RunSettings& settings);

// The first point of a branch: the start corrected, its tangent oriented for DS > 0, singular problems refused (2, 3,
// 6).

class DefiningSystem;
class PathFollower;

struct FirstPoint {
  PathPoint point;
  std::vector<NewtonIteration> correction;  ///< how the start was corrected
  std::string note;                         ///< what the user has to know of it, or empty
  bool stored_direction = false;            ///< DS > 0 goes on in the direction that is stored with the start
  bool leaves_start = false;                ///< whatever the sign of DS, away from the start
};

/// Is the start a label of a branch point, of orbits or equilibria?
bool start_is_branch_point(const SelectedStart& selected);

/// From data: correct_start(). From a label with its
/// direction: orthogonally to the direction, unless a parameter was changed or the direction is no tangent of this
/// problem (another signature); then as from data. DS > 0 goes on in the stored direction, in which the run of the
/// label went, when there is one that fits, otherwise ICP(1) grows; a changed parameter value keeps the side that the
/// stored direction points to. Throws ComputationError with the residual of every boundary condition when no way
/// converges, when Newton arrives at a point instead of an orbit, and when the bordered matrix is singular, naming the
/// undetermined direction.
FirstPoint first_point(PathFollower& follower, const DefiningSystem& system, const SelectedStart& selected,
                       const RunSettings& settings);

}  // namespace tchat
