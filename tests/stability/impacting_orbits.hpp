/// The one-impact orbit of the linear oscillator in several cuts, and its bifurcations from the closed form of its
/// multipliers.
#pragma once

#include <boost/math/tools/toms748_solve.hpp>

#include "support/linear_oscillator.hpp"

namespace tchat::test {

/// A signature with the pieces of the orbit that belong to it.
struct CutOrbit {
  Signature signature;
  std::vector<Piece> pieces;
};

inline double root_between(const std::function<double(double)>& f, double low, double high) {
  std::uintmax_t iterations = 100;
  const auto bracket =
      boost::math::tools::toms748_solve(f, low, high, boost::math::tools::eps_tolerance<double>(52), iterations);
  return 0.5 * (bracket.first + bracket.second);
}

/// {J1}
inline CutOrbit whole(const OscillatorOrbit& orbit) {
  return {{{1, 1, 1}}, {orbit.piece(0, orbit.constants.period())}};
}

/// Cut at the minimum of x1 (event 3, identity), which is the first zero of x2 after the impact; `impact_first` begins
/// with the segment that ends in the impact.
inline CutOrbit cut_at_minimum(const OscillatorOrbit& orbit, bool impact_first) {
  const double period = orbit.constants.period();
  const auto velocity = [&](double t) { return orbit.state(t)(1); };
  double after = period / 1000;
  while (velocity(after) < 0.0) after += period / 1000;
  const double cut = root_between(velocity, after - period / 1000, after);
  if (impact_first) return {{{1, 1, 1}, {1, 3, 2}}, {orbit.piece(cut, period), orbit.piece(0, cut)}};
  return {{{1, 3, 2}, {1, 1, 1}}, {orbit.piece(0, cut), orbit.piece(cut, period)}};
}

/// {J1, J1}
inline CutOrbit twice(const OscillatorOrbit& orbit) {
  const Piece piece = orbit.piece(0, orbit.constants.period());
  return {{{1, 1, 1}, {1, 1, 1}}, {piece, piece}};
}

/// det(M - mu Id) of the two nontrivial multipliers.
inline double characteristic(double omega, double v, double mu) {
  const auto multipliers = one_impact_multipliers(omega, v);
  return ((mu - multipliers[0]) * (mu - multipliers[1])).real();
}

/// Impact velocities and alpha of the bifurcations, from the closed form.
inline double period_doubling_velocity(double omega = 2.0072) {
  return root_between([&](double v) { return characteristic(omega, v, -1.0); }, 0.02, 0.05);
}
inline double fold_velocity(double omega = 1.8901) {
  return root_between([&](double v) { return characteristic(omega, v, 1.0); }, 4.5, 6.0);
}

inline constexpr double grazing_omega = 1.998333565522409;  // at alpha = 3
inline constexpr double doubling_alpha = 3.03619356554716;  // at omega = 2.0072
inline constexpr double fold_alpha = 1.9706026714368;       // at omega = 1.8901

}  // namespace tchat::test
