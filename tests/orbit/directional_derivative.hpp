/// Derivatives of the residual that linear systems are compared with.
#pragma once

#include <random>

#include "orbit/condensed_system.hpp"

namespace tchat::test {

/// Entries from -1 to 1.
inline OrbitVector random_vector(const CondensedSystem& condensed, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  OrbitVector v = condensed.make_vector();
  for (double& entry : v.states.reshaped()) entry = uniform(generator);
  for (double& entry : v.durations) entry = uniform(generator);
  for (double& entry : v.globals) entry = uniform(generator);
  return v;
}

/// dF/d(step along v) by central differences of fourth order: exact for polynomials of fourth degree but for rounding.
inline OrbitResidual directional_derivative(CondensedSystem& condensed, const Orbit& x, const OrbitVector& v) {
  const double h = 1e-3;
  OrbitResidual sum = condensed.make_residual(), part = condensed.make_residual();
  const auto add = [&](double at, double weight) {
    Orbit moved = x;
    advance(moved, at, v, condensed.system().free_parameters());
    condensed.evaluate(moved, part);
    for (std::size_t i = 0; i < part.collocation.size(); ++i) sum.collocation[i] += weight * part.collocation[i];
    for (std::size_t i = 0; i < part.coupling.size(); ++i) sum.coupling[i] += weight * part.coupling[i];
  };
  add(h, 8 / (12 * h)), add(-h, -8 / (12 * h)), add(2 * h, -1 / (12 * h)), add(-2 * h, 1 / (12 * h));
  return sum;
}

/// Equations are J dx = -F.
inline void negate(OrbitResidual& r) {
  for (std::vector<double>* part : {&r.collocation, &r.coupling})
    for (double& entry : *part) entry = -entry;
}

}  // namespace tchat::test
