/// The command `tchat resegment`: from a labelled orbit or torus to data and constants of the next run.
#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "files/solution_file.hpp"
#include "model/hybrid_system.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// `tchat resegment`: from a labelled orbit to starting data and constants of the next run, where the signature changes
// (5.1.1, 5.3; src/docs/resegment.md).

enum class ResegmentKind {
  grazing_curve,  ///< the segment ends in grazing contact, IPS 150
  impacting,      ///< it ends in the event with the event's own jump, IPS 180
  signature,      ///< another signature of the same orbit: segments of zero duration vanish or appear
  rotate,         ///< another segment first
  repeat,         ///< the signature twice
};

struct ResegmentRequest {
  std::string solutions;  ///< q-file, by path or by the name of its run
  std::string label;
  ResegmentKind kind = ResegmentKind::grazing_curve;
  int repeats = 1;                       ///< of `impacting`: periods of the orbit, the contact is in the first one
  int rotation = 1;                      ///< of `rotate`: segments that move from the beginning to the end
  std::optional<std::string> constants;  ///< -c; default r.S of the run that wrote the label
  std::optional<std::string> problem;    ///< -p; default the name of the q-file
  std::string output;                    ///< -o
  std::optional<std::string> signature;  ///< of the new orbit, "1,1,1;2,2,2"
  std::optional<int> jump;               ///< at the contact
  std::optional<std::string> contact;    ///< what holds beyond the surface, "2,2,1"
  bool data = false;                     ///< O.dat instead of q.O
  std::vector<std::string> overrides;    ///< KEY=VALUE, for gc.O
};

/// Writes q.O (or O.dat) and gc.O and tells on `screen` what they hold; returns warnings. `notices` is told which
/// plugin of another folder is loaded. Throws UserError when label, signature, constants and problem do not go
/// together.
std::vector<std::string> resegment(const ResegmentRequest& request, std::ostream& screen, std::ostream& notices);

// From a torus that touches a surface (GR on a run of type 182) to the curve of such tori in two parameters (type
// 152): the orbits stay what they are, the constants ask for the contact and free one parameter more.

/// The constants of the run of type 152. `icp_is_given`: the command line names its parameters; else the first
/// parameter of the problem that is not free yet becomes free. Throws UserError, `name` in front, where the label is no
/// contact of a torus, or all parameters are free already.
RunSettings grazing_torus_settings(const RunSettings& settings, const LabelledSolution& solution,
                                   const std::string& name, const HybridSystem& system, bool icp_is_given);

/// The label as the start of that run: without its direction, which is that of another problem.
LabelledSolution grazing_torus_start(LabelledSolution solution);

}  // namespace tchat
