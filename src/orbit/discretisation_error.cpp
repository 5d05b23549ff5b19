#include "orbit/discretisation_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linear/array_kernel.hpp"
#include "linear/stack_array.hpp"

namespace tchat {

namespace {

/// The largest component of the residual at the ends of the intervals of segment s.
double largest_residual(const HybridSystem& system, int field, const Orbit& x, const CollocationRule& rule, int s) {
  const int n = x.shape.dimension;
  const int c = x.shape.collocation;
  constexpr std::size_t usual_entries = 2048;
  const int intervals = x.shape.intervals_of(s);
  const double* const mesh = x.mesh_of(s);
  StackMatrix<usual_entries> slopes(n, 2 * static_cast<Eigen::Index>(intervals));
  array_functions().interpolate({rule.end_slope.data(), 2, c, n, intervals}, x.node(s, 0), slopes.data(), n);
  StackVector f(n);
  double largest = 0.0;
  for (int j = 0; j <= intervals; ++j) {
    system.value(FunctionKind::field, field, x.node(s, j * c), x.par.data(), f.data());
    if (!std::all_of(f.begin(), f.end(), [](double value) { return std::isfinite(value); })) continue;
    // The end of one interval is the start of the next one.
    for (const int side : {0, 1}) {
      const int interval = j - side;
      if (interval < 0 || interval >= intervals) continue;
      const double time = (mesh[interval + 1] - mesh[interval]) * x.duration(s);
      const double* slope = slopes.col(2 * interval + side).data();
      for (int a = 0; a < n; ++a) largest = std::max(largest, std::abs(slope[a] - time * f(a)));
    }
  }
  return largest;
}

}  // namespace

double estimated_error(const HybridSystem& system, const Signature& signature, const Orbit& x,
                       const CollocationRule& rule) {
  ArrayRange of_states{0.0, true};
  double residual = 0.0;
  for (int s = 0; s < x.shape.segments; ++s) {
    widen(of_states, array_functions().range(x.node(s, 0), long{x.shape.nodes_of(s)} * x.shape.dimension));
    if (!of_states.finite) return std::numeric_limits<double>::infinity();
    const int field = signature[static_cast<std::size_t>(s)].field;
    if (x.duration(s) != 0.0) residual = std::max(residual, largest_residual(system, field, x, rule, s));
  }
  return rule.residual_integral * residual / (1.0 + of_states.largest);
}

}  // namespace tchat
