/// The class of problems/mems/mems.cpp, compiled into a test instead of registered as a plugin, and states of its
/// orbits at omega = 0.8 (SPEC section 13.2: computed by shooting with another program).
#pragma once

#include <Eigen/Core>
#include <tchat/problem.hpp>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"

#pragma push_macro("TCHAT_PROBLEM")
#undef TCHAT_PROBLEM
#define TCHAT_PROBLEM(PROBLEM) static_assert(PROBLEM::dimension == 5);
#include "../../problems/mems/mems.cpp"
#pragma pop_macro("TCHAT_PROBLEM")

namespace tchat::test {

inline const HybridSystem& mems() {
  static const HybridSystem system(*ProblemTable<MemsOscillator>::get("mems"));
  return system;
}

namespace mems_orbits {

inline const Signature nonimpacting = {{1, 3, 3}};
inline const Signature grazing = {{1, 1, 3}};
inline const Signature impacting = {{1, 1, 1}, {2, 2, 2}};
inline const Signature secondary_grazing = {{1, 1, 2}, {1, 1, 1}, {2, 2, 2}};

}  // namespace mems_orbits

}  // namespace tchat::test
