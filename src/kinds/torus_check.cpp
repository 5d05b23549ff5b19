#include "kinds/torus_check.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/event_at.hpp"
#include "orbit/torus_system.hpp"
#include "run/torus_start.hpp"
#include "settings/settings_type.hpp"
#include "stability/floquet_multipliers.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// |h_x f| up to this share of |h_x| |f| is contact.
constexpr double least_rate = 1e-6;

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
    const int orbit = s / m;
    const double phi = offset + static_cast<double>(orbit) / torus.orbits() + TorusSystem::rotation(x);
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
  worst.touches = worst.touches && other.touches;
  worst.leaves_surface = worst.leaves_surface || other.leaves_surface;
  if (worst.wrong.empty()) worst.wrong = other.wrong;
  if (worst.passed.empty()) worst.passed = other.passed;
}

/// The derivatives of the N integrated returns, each a column; NaN where one ends in contact. `links`: of all segments
/// of all returns.
MatrixXd integrated_returns(const TorusSystem& torus, const std::vector<SegmentLink>& links, Index n) {
  const int m = torus.segments_per_return();
  MatrixXd columns(n * n, torus.orbits());
  for (int i = 0; i < torus.orbits(); ++i) {
    MatrixXd product = MatrixXd::Identity(n, n);
    for (int s = 0; s < m; ++s) {
      const SegmentLink& link = links[static_cast<std::size_t>(i * m + s)];
      const double rate = link.hx * link.f;
      if (!(std::abs(rate) > least_rate * link.hx.norm() * link.f.norm())) return MatrixXd::Constant(n * n, 1, NAN);
      product = link.gx * project_along_flow(link.f, link.hx.transpose(), link.flow * product);
    }
    columns.col(i) = Eigen::Map<const VectorXd>(product.data(), n * n);
  }
  return columns;
}

/// The largest range of a state over the curve, relative to its scale. An error of the curve turns its direction, along
/// which one multiplier is 1, by that error divided by this: near the birth of a torus multipliers are known to less.
double curve_size(const TorusSystem& torus, const Orbit& x, const VectorXd& scale) {
  const MatrixXd curve = periodic_section_curve(torus, x);
  const VectorXd ranges = curve.rowwise().maxCoeff() - curve.rowwise().minCoeff();
  return (ranges + torus.winding().curve.cwiseAbs()).cwiseQuotient(scale).cwiseMin(1.0).maxCoeff();
}

/// Moduli of the multipliers of the integrated returns; empty where there are none.
std::vector<std::complex<double>> integrated_moduli(const TorusSystem& torus, const Orbit& x,
                                                    const std::vector<SegmentLink>& links) {
  const int states = least_dimension(torus.system(), torus.signature());
  if (links.empty() || states < 2) return {};
  const MatrixXd matrices = integrated_returns(torus, links, x.shape.dimension);
  if (!matrices.allFinite()) return {};
  const VectorXd moduli = moduli_along_rotation(matrices, periodic_section_curve(torus, x), torus.winding().curve,
                                                TorusSystem::rotation(x), states);
  std::vector<std::complex<double>> result(moduli.begin(), moduli.end());
  result.emplace_back(0.0);
  return result;
}

}  // namespace

OrbitCheck check_torus(const HybridSystem& system, const RunSettings& one_return, const Orbit& x,
                       const std::vector<std::complex<double>>& stored, double tolerance) {
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
    if (offset == 0.0)
      result.multipliers =
          integrated_moduli(torus, x, links_of(system, settings, x, checks, VectorXd::Ones(x.shape.dimension)));
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
  result.goes_forward = x.period() > 0.0 && std::isfinite(x.period());
  if (!(result.period > 0.0)) result.period = 1.0;
  if (result.multipliers.size() == stored.size() && !stored.empty()) {
    result.multiplier_difference = largest_difference(stored, result.multipliers);
    result.multiplier_error = *result.multiplier_difference * curve_size(torus, x, scale);
  }
  return result;
}

}  // namespace tchat
