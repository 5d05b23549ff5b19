/// The numbers of problem types (IPS, ISW) whose constants other rooms make.
#pragma once

namespace tchat {

struct ProblemId {
  int number;       ///< IPS
  int branch_mode;  ///< ISW
};
inline constexpr ProblemId periodic_orbit{180, 1};
inline constexpr ProblemId orbit_curve{180, 2};
inline constexpr ProblemId branch_switch{180, -1};
inline constexpr ProblemId grazing_orbit{150, 1};
inline constexpr ProblemId invariant_torus{182, 1};
inline constexpr ProblemId torus_birth{182, -1};
inline constexpr ProblemId grazing_torus{152, 1};
inline constexpr ProblemId boundary_value{4, 1};
inline constexpr ProblemId equilibrium{1, 1};

}  // namespace tchat
