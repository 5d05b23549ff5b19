/// The orbit that everything is measured on: {J1} of the linear impact oscillator, one impact per forcing period.
///
/// Between impacts x1 = a cos theta + b sin theta + exp(-zeta t) (C cos omega_d t + D sin omega_d t), theta = omega t +
/// phase, from x1 = 1, x2 = -r v to x1 = 1, x2 = v after one forcing period T = 2 pi / omega.
#pragma once

#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"

namespace tchat::benchmark {

/// One point of the branch in closed form: impact velocity and phase belong to alpha.
struct ImpactData {
  double alpha = 3.39159789647371;
  double omega = 2.0072;
  double zeta = 0.05;
  double restitution = 0.8;
  double velocity = 5.0;
  double y1 = 0.439271830566;
  double y2 = -0.898354194553;
};

/// problems/linosc/linosc.cpp.
const HybridSystem& oscillator();

/// Its signature repeated m times.
Signature impacting_signature(int segments);

/// The orbit on a uniform mesh, passed through shape.segments times. With more than 4 states: of the first mass of the
/// chain without coupling, where the others rest.
Orbit impacting_orbit(const OrbitShape& shape);

/// Weak, so that the orbit of the chain is found from that without coupling.
inline constexpr double chain_coupling = 0.02;

/// The chain with n = 4, 6, 8, ... states (oscillator_chain.hpp).
const HybridSystem& chain(int n);

}  // namespace tchat::benchmark
