#include "stability/condensed_orbit.hpp"

#include <cmath>

#include "stability/orbit_forms.hpp"

namespace tchat {

namespace {

/// What the coupling rows of the system leave open.
int open_rows(const DefiningSystem& system) {
  int open = (system.dimension() + 1) * system.segments() + system.free_count();
  for (int s = 0; s < system.segments(); ++s) open -= system.coupling_rows(s);
  return open;
}

}  // namespace

CondensedOrbit::CondensedOrbit(const DefiningSystem& system, const OrbitShape& shape, std::complex<double> critical)
    : system_(system),
      critical_(critical),
      condensed_(system, shape, {0, open_rows(system)}),
      forms_(system, shape, critical.imag() != 0.0),
      residual_(condensed_.make_residual()),
      rows_(forms_.make_rows()) {}

bool CondensedOrbit::linearise(const Orbit& x) {
  return condensed_.condense(x, {}, residual_) == Linearization::ready &&
         forms_.factorize(condensed_, x, shift_for(critical_));
}

/// Those of the collocation rows are known from the linearisation.
const RowWeights& CondensedOrbit::residual(const Orbit& x) {
  const int n = system_.dimension();
  rows_.collocation = residual_.collocation;
  Eigen::VectorXd jump(n);
  for (int s = 0; s < system_.segments(); ++s) {
    const IndexVector& index = system_.signature()[static_cast<std::size_t>(s)];
    auto ends = rows_.ends.begin() + static_cast<std::ptrdiff_t>(s) * (1 + n);
    *ends++ = system_.has_event(s) ? system_.system().event(index.event, x.end(s), x.par.data()) : 0.0;
    system_.system().value(FunctionKind::jump, index.jump, x.end(s), x.par.data(), jump.data());
    system_.clear_absent(s, jump.data(), 1);
    const double* const next = x.start((s + 1) % system_.segments());
    for (int a = 0; a < n; ++a) *ends++ = next[a] - jump(a);
  }
  return rows_;
}

bool CondensedOrbit::correct(const Eigen::VectorXd& q, Orbit& x) {
  constexpr int most_iterations = 10;
  constexpr double arrived = 1e-11, near = 1e-6;
  double last = near;
  OrbitVector change = forms_.make_vector();
  change.set_zero();
  std::optional<Eigen::Index> parameter;
  for (int k = 0; k < most_iterations; ++k) {
    if (!linearise(x)) return false;
    const RowWeights& rows = residual(x);
    if (!is_fold(critical_)) {
      forms_.solve(rows, change);
    } else {
      CriticalVectors vectors;
      if (!parameter) parameter = forms_.find_critical(critical_, vectors) ? forms_.parameter_across(vectors) : 0;
      forms_.solve_across(rows, q, *parameter, change);
    }
    const double moved = std::max(change.states.lpNorm<Eigen::Infinity>(), change.durations.lpNorm<Eigen::Infinity>());
    const double size = moved / (1.0 + x.states.cwiseAbs().maxCoeff());
    if (!std::isfinite(size) || !change.globals.allFinite()) return false;
    advance(x, 1.0, change, system_.free_parameters());
    if (size < arrived || (last < near && size > 0.5 * last)) return true;
    last = size;
  }
  return false;
}

}  // namespace tchat
