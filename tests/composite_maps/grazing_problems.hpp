/// Problems of chapters 3 and 4 as the sources that users compile, and their grazing orbits.
#pragma once

#include <tchat/problem.hpp>

#include <Eigen/Core>
#include <initializer_list>

#include "model/parameter_vector.hpp"
#include "support/test_system.hpp"

// Their line of registration would make a plugin of the test.
#undef TCHAT_PROBLEM
#define TCHAT_PROBLEM(Problem)
#include "../../problems/fvdp/fvdp.cpp"
#include "../../problems/planar/planar.cpp"
#include "../../problems/rand3d/rand3d.cpp"

namespace tchat::test {

/// PAR(1), PAR(2), ... and zeros.
inline ParameterVector full_par(std::initializer_list<double> values) {
  ParameterVector par{ParameterLayout()};
  int k = 0;
  for (const double value : values) par(k++) = value;
  return par;
}

}  // namespace tchat::test
