#include "verification/torus_check.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bvp/torus_system.hpp"
#include "constants/settings_type.hpp"
#include "run/torus_start.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The N returns that begin at the phases offset + i / N.
Orbit returns_from(const TorusSystem& torus, const Orbit& x, double offset) {
  Orbit result = x;
  const int m = torus.segments_per_return();
  for (int i = 0; i < torus.orbits(); ++i) {
    const Orbit one = return_at(torus, x, offset + static_cast<double>(i) / torus.orbits());
    result.states.middleCols(i * one.states.cols(), one.states.cols()) = one.states;
    for (int s = 0; s < m; ++s) result.duration(i * m + s) = one.duration(s);
  }
  return result;
}

/// What follows each segment of those returns: the start of the next one, or u(phi + rho).
MatrixXd following_states(const TorusSystem& torus, const Orbit& x, const Orbit& returns, double offset) {
  const int m = torus.segments_per_return();
  const Index n = x.shape.dimension;
  MatrixXd states(n, returns.shape.segments);
  for (int s = 0; s < returns.shape.segments; ++s) {
    if ((s + 1) % m != 0) {
      states.col(s) = Eigen::Map<const VectorXd>(returns.start(s + 1), n);
      continue;
    }
    const double phi = offset + static_cast<double>(s / m) / torus.orbits() + TorusSystem::rotation(x);
    states.col(s) = return_at(torus, x, phi).states.col(0) + torus.winding().returns;
  }
  return states;
}

/// What matters of `other` too.
void take_worse(SegmentCheck& worst, const SegmentCheck& other) {
  if (worst.message.empty()) worst.message = other.message;
  worst.growth = std::max(worst.growth, other.growth);
  worst.state_defect = std::max(worst.state_defect, other.state_defect);
  worst.time_defect = std::max(worst.time_defect, other.time_defect);
  worst.event_level = std::max(worst.event_level, other.event_level);
  worst.leaves_surface = worst.leaves_surface || other.leaves_surface;
  if (worst.wrong.empty()) worst.wrong = other.wrong;
  if (worst.passed.empty()) worst.passed = other.passed;
}

}  // namespace

OrbitCheck check_torus(const HybridSystem& system, const RunSettings& one_return, const Orbit& x, double tolerance) {
  const int m = segment_count(one_return);
  const int orbits = x.shape.segments / m;
  const TorusSystem torus(system, one_return.signature(), orbits, {}, torus_winding(system, one_return.signature(), x));
  const RunSettings settings = settings_of_orbits(one_return, orbits);
  const VectorXd scale = state_scales(x);
  const std::vector<Index> angles = angle_states(system, one_return.signature(), section_curve(torus, x), x.par);
  OrbitCheck result;
  for (const double offset : {0.0, 0.5 / orbits}) {
    const Orbit returns = offset == 0.0 ? x : returns_from(torus, x, offset);
    const std::vector<SegmentCheck> checks = check_segments(
        system, settings, returns, scale, following_states(torus, x, returns, offset), tolerance, angles);
    for (std::size_t s = 0; s < checks.size(); ++s) {
      const std::size_t place = s % static_cast<std::size_t>(m);
      if (result.segments.size() <= place)
        result.segments.push_back(checks[s]);
      else
        take_worse(result.segments[place], checks[s]);
    }
  }
  for (int s = 0; s < m; ++s) {
    double mean = 0.0;
    for (int i = 0; i < orbits; ++i) mean += x.duration(i * m + s) / orbits;
    result.durations.push_back(mean);
    result.period += std::abs(mean);
  }
  if (!(result.period > 0.0)) result.period = 1.0;
  return result;
}

}  // namespace tchat
