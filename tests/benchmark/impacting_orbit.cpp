#include "benchmark/impacting_orbit.hpp"

#include <cmath>
#include <numbers>

#include "benchmark/chain_files.hpp"
#include "benchmark/compiled_problem.hpp"

namespace tchat::benchmark {

namespace {

/// The state at time t after the impact.
Eigen::Vector4d state(const ImpactData& p, double t) {
  const double detuning = 1.0 - p.omega * p.omega;
  const double damping = 2.0 * p.zeta * p.omega;
  const double amplitude = p.alpha / (detuning * detuning + damping * damping);
  const double a = amplitude * detuning;
  const double b = amplitude * damping;
  const double natural = std::sqrt(1.0 - p.zeta * p.zeta);
  const double c = 1.0 - (a * p.y2 + b * p.y1);
  const double start_velocity = -p.restitution * p.velocity - p.omega * (b * p.y2 - a * p.y1);
  const double d = (start_velocity + p.zeta * c) / natural;

  const double sine = std::sin(p.omega * t);
  const double cosine = std::cos(p.omega * t);
  const double y1 = p.y1 * cosine + p.y2 * sine;
  const double y2 = p.y2 * cosine - p.y1 * sine;
  const double decay = std::exp(-p.zeta * t);
  const double s = std::sin(natural * t);
  const double k = std::cos(natural * t);
  const double free = decay * (c * k + d * s);
  const double free_velocity = decay * natural * (d * k - c * s) - p.zeta * free;
  return {a * y2 + b * y1 + free, p.omega * (b * y2 - a * y1) + free_velocity, y1, y2};
}

}  // namespace

const HybridSystem& oscillator() { return problem_of_repository("linosc"); }

const HybridSystem& chain(int n) { return compiled_problem(chain_source(n)); }

Signature impacting_signature(int segments) { return Signature(static_cast<std::size_t>(segments), {1, 1, 1}); }

Orbit impacting_orbit(const OrbitShape& shape) {
  const ImpactData data;
  Orbit x;
  x.shape = shape;
  x.mesh = uniform_mesh(shape.intervals);
  x.states.resize(shape.dimension, shape.columns());
  x.par = ParameterVector(ParameterLayout(), shape.segments);
  x.par.head(5) << data.alpha, data.omega, data.zeta, data.restitution, chain_coupling;
  const double period = 2.0 * std::numbers::pi / data.omega;
  for (int s = 0; s < shape.segments; ++s) {
    x.duration(s) = period;
    for (int k = 0; k < shape.nodes(); ++k) {
      const Eigen::Vector4d first = state(data, period * x.tau(k));
      auto column = x.states.col(s * shape.nodes() + k);
      column.setZero();
      column.head(2) = first.head(2);
      column.tail(2) = first.tail(2);
    }
  }
  return x;
}

}  // namespace tchat::benchmark
