/// Orbits with values that are easy to tell apart, for the tests of files.
#pragma once

#include <cmath>

#include "files/solution_file.hpp"

namespace test_support {

/// `segments` segments of dimension n on a mesh of `intervals` x `collocation`; every number is different. Of a problem
/// of so many `parameters`, whose durations stand behind them or, of few, behind PAR(60).
inline tchat::LabelledSolution sample_orbit(int n, int segments, int intervals, int collocation, int parameters = 4) {
  tchat::LabelledSolution orbit;
  orbit.branch = 2;
  orbit.point = 17;
  orbit.type = 7;
  orbit.label = 5;
  orbit.dimension = n;
  orbit.mesh_intervals = intervals;
  orbit.collocation_points = collocation;
  const int points = intervals * collocation + 1;
  orbit.states.resize(n * segments, points);
  orbit.state_direction.resize(n * segments, points);
  for (int p = 0; p < points; ++p) {
    orbit.tau.push_back(static_cast<double>(p) / (points - 1));
    for (int r = 0; r < n * segments; ++r) {
      orbit.states(r, p) = std::sin(1.0 + r + 0.37 * p);
      orbit.state_direction(r, p) = 1e-3 * std::cos(2.0 + r - 0.21 * p);
    }
  }
  orbit.free_parameters = {1};
  orbit.parameter_direction = {-0.125};
  orbit.parameters = {3.0, 2.0, 0.05, 0.8};
  const int before_durations = parameters > 60 ? parameters : 60;
  orbit.layout = tchat::ParameterLayout(parameters);
  orbit.parameters.resize(static_cast<std::size_t>(before_durations), 0.0);
  if (parameters > 60) orbit.parameters.back() = -7.5;
  for (int s = 1; s <= segments; ++s) {
    orbit.free_parameters.push_back(before_durations + s);
    orbit.parameter_direction.push_back(0.25 * s);
    orbit.parameters.push_back(1.0 + 0.5 * s);
  }
  return orbit;
}

}  // namespace test_support
