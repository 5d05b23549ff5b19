/// The Gauss points of an orbit's mesh intervals, at which integrals over its collocation polynomials are taken.
#pragma once

#include <algorithm>

#include "orbit/collocation_rule.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

/// Calls use(interval, Gauss point, h, h w) for segment s: the interval's length, and the point's weight in an integral
/// over tau from 0 to 1.
template <class Use>
void for_each_gauss_point(const Orbit& x, const CollocationRule& rule, int s, const Use& use) {
  const double* const mesh = x.mesh_of(s);
  for (int j = 0; j < x.shape.intervals_of(s); ++j) {
    const double h = mesh[j + 1] - mesh[j];
    for (int g = 0; g < rule.points(); ++g) use(j, g, h, h * rule.weights(g));
  }
}

/// The polynomial of interval j at Gauss point g.
inline void interpolate(const Orbit& x, const CollocationRule& rule, int s, int j, int g, double* state) {
  const double* node = x.node(s, j * x.shape.collocation);
  std::fill_n(state, x.shape.dimension, 0.0);
  for (int i = 0; i <= rule.points(); ++i)
    for (int a = 0; a < x.shape.dimension; ++a) state[a] += rule.value(g, i) * *node++;
}

}  // namespace tchat
