/// From a start that is not yet a solution to an orbit at the parameter values asked for.
#pragma once

#include "continuation/newton_result.hpp"
#include "continuation/path_point.hpp"
#include "run/start_selection.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

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

}  // namespace tchat
