/// Settings of forward integration.
#pragma once

#include <vector>

namespace tchat {

enum class IntegrationMethod {
  adams,        ///< order up to 12; for problems that are not stiff, and for the highest accuracy
  bdf,          ///< order up to 5; for stiff problems
  runge_kutta,  ///< order 5; for many short flows of problems that are not stiff; no variational equations
};

struct FlowOptions {
  IntegrationMethod method = IntegrationMethod::adams;
  /// Of one step; a segment's error is about ten times that. Multipliers near grazing need this much; problems with
  /// large derivatives may fail to converge and want 1e-12. CVODES refuses less than 2e-16.
  double relative_tolerance = 1e-15;
  double absolute_tolerance = 1e-16;
  double max_duration = 1e3;        ///< give up waiting for an event after this time
  long max_steps = 100000;          ///< of the integrator, for one segment
  double surface_tolerance = 1e-9;  ///< |h| / (1 + |h_x| |x|) below this: the start is on the event surface
  bool variational = true;          ///< integrate the flow Jacobian along
  std::vector<int> active;          ///< PAR indices, from 1, by which derivatives are wanted (needs `variational`)
};

}  // namespace tchat
