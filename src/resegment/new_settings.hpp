/// The constants of a run that starts from a resegmented orbit: those of the run that found the label, with what the
/// new signature changes.
#pragma once

#include "model/hybrid_system.hpp"
#include "resegment/segment_list.hpp"
#include "settings/problem_type.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

struct NewProblem {
  int problem_type = periodic_orbit.number;      ///< IPS
  int branch_mode = periodic_orbit.branch_mode;  ///< ISW
  int grazing_jump = 1;                          ///< GRJUMP
  bool names_parameters = false;                 ///< the user gives ICP, so what is missing there is no fault
};

/// Free parameters: the problem's own in their order (a second one is added where the problem type needs it, and left
/// out where it does not), then all durations. Weights of durations go with the pieces; user values of durations and
/// rules to stop are dropped. Test functions: xi_1..xi_5 on a grazing curve, otherwise the located ones of the watched
/// events. Throws UserError when no second parameter of the problem is known.
RunSettings new_settings(const RunSettings& old, const SegmentList& segments, const NewProblem& problem,
                         const HybridSystem& system);

}  // namespace tchat
