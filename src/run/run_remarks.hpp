/// Remarks of a run to the user: on its free parameters, on events that no segment watches, and the next command.
#pragma once

#include <string>
#include <vector>

#include "base/words.hpp"
#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"
#include "run/orbit_start.hpp"
#include "settings/point_type.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// What a user has to know of the free parameters and their bounds before a branch is computed.

/// RL0 and RL1 bound ICP(1): bounds that stand in the constants file for another parameter than the one that the
/// command line has made the first. "" when there are none. `in_file` are the constants before the command line.
std::string inherited_bounds(const HybridSystem& system, const RunSettings& in_file, const RunSettings& used,
                             const std::vector<std::string>& overrides, const std::string& file);

/// From a fold, period doubling or torus bifurcation with ISW = 1, parameters of ICP beyond the free one are mere
/// columns, where the curve in two parameters may have been meant. "" when there are none.
std::string idle_parameters(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start,
                            std::size_t free_count);

// Events that may come next by the problem's successors, but that no segment of the run watches or ends at.

/// A warning with the cure, for no other message reports an orbit that continues through such an event. Events that are
/// negative on their segment are left out, and segments that follow others than the successors allow. "" when there is
/// no such event, or the problem has no successors. Starts of tori hold many returns of the signature, and each counts.
std::string unwatched_events(const HybridSystem& system, const RunSettings& settings, const Orbit& start);

/// Adds those events to the monitored ones of their segments (GCHGRZIND).
void watch_possible_events(const HybridSystem& system, RunSettings& settings, const Orbit& start);

// The command that most users give next at a labelled solution.

/// A label that a run has written.
struct NextStart {
  int label = 0;
  int type = 0;  ///< label_type() of its number in files
  UserPointKind kind;
  int curve = 0;  ///< curve_type() of its number in files; 0: of no curve in two parameters
};

/// The names of the files that a command at a label makes.
struct NextNames {
  std::string branch;              ///< of the run
  std::string start;               ///< of what `tchat resegment` makes first, where it does
  std::string branch_after_start;  ///< of the run then
};
/// "O_PD3", or "O_GR3" and "O_GR3_branch".
NextNames names_at(const NextStart& start, const std::string& output);

/// At a bifurcation a run on the branch that is born there, at a fold the curve of folds in two parameters, at an
/// extremum that of extrema, at a contact or an impact of velocity zero resegmentation and a run with the new
/// signature; on curves in two parameters, the one that begins at the label or crosses there. None where no command
/// suits most users. `settings` are those of the run that wrote the label to q.`output`; `problem` is the name or path
/// of its problem.
Commands next_commands(const NextStart& start, const RunSettings& settings, const HybridSystem& system,
                       const std::string& problem, const std::string& output, const NextNames& names);

/// Is the kind that of a section which the orbit touches, and no contact that changes the motion?
bool tangent_section(const UserPointKind& kind, const RunSettings& settings, const HybridSystem& system);

/// How the points of a label are followed in two parameters.
struct CurveCommand {
  Commands commands;      ///< the last is a run that lacks ICP
  std::string why_none;   ///< why not, in words
  std::string kind;       ///< name of the points that the curve consists of
  bool is_alone = false;  ///< the only curve of its kind that may end at the label
  bool rests = false;     ///< it consists of equilibria
};

/// To files of the name `curve`. A grazing contact is cut first (tchat resegment); one that changes nothing, in
/// problems with one field and no jumps but identities, is kept by HOLD. From a label of a curve, only another curve is
/// followed: a contact's, that of BE, or the one that CURVE names.
CurveCommand curve_command(const NextStart& start, const RunSettings& settings, const HybridSystem& system,
                           const std::string& problem, const std::string& output, const std::string& curve);

/// The curves in two parameters that begin at a label of a curve, and both Hopf curves through HH, each to files of the
/// name `curve`. Empty where none begins.
std::vector<CurveCommand> born_curve_commands(const NextStart& start, const RunSettings& settings,
                                              const std::string& problem, const std::string& output,
                                              const std::string& curve);

}  // namespace tchat
