/// A problem class compiled into a test, seen as a hybrid system.
#pragma once

#include <tchat/problem.hpp>

#include "model/hybrid_system.hpp"

namespace tchat::test {

inline constexpr double pi = 3.14159265358979323846;

template <class Problem>
const HybridSystem& system_of() {
  static const HybridSystem system(*ProblemTable<Problem>::get("test problem"));
  return system;
}

}  // namespace tchat::test
