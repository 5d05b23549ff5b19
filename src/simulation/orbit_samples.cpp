#include "simulation/orbit_samples.hpp"

#include <algorithm>
#include <cmath>

#include "simulation/cvodes_flow.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// x_s at duration * tau, the first and last columns being those of the refined orbit.
MatrixXd sample_segment(const HybridSystem& system, int field, const MapSegment& segment, const VectorXd& par,
                        const std::vector<double>& tau) {
  MatrixXd states = segment.start.replicate(1, static_cast<Eigen::Index>(tau.size()));
  states.rightCols(1) = segment.end;
  FlowOptions options;
  options.variational = false;
  options.relative_tolerance = 1e-13;
  options.absolute_tolerance = 1e-14;
  CvodesFlow flow(system, field, segment.start, par, options);
  std::size_t next = 1;
  flow.on_piece([&](double, double to) {
    for (; next + 1 < tau.size() && tau[next] * segment.duration <= to; ++next)
      states.col(static_cast<Eigen::Index>(next)) = flow.state_at(tau[next] * segment.duration);
    return true;
  });
  if (segment.duration > 0.0) flow.advance(segment.duration);
  return states;
}

MatrixXd sample_all(const HybridSystem& system, const FoundOrbit& orbit, const VectorXd& par,
                    const std::vector<double>& tau) {
  const Eigen::Index n = system.dimension();
  MatrixXd stacked(n * static_cast<Eigen::Index>(orbit.signature.size()), static_cast<Eigen::Index>(tau.size()));
  for (std::size_t s = 0; s < orbit.signature.size(); ++s)
    stacked.middleRows(static_cast<Eigen::Index>(s) * n, n) =
        sample_segment(system, orbit.signature[s].field, orbit.map.segments[s], par, tau);
  return stacked;
}

/// [0, 1] in `parts` parts of equal weight 1/2 (time + arclength), given states at equal times.
std::vector<double> equal_weights(const MatrixXd& states, int parts) {
  const Eigen::Index count = states.cols() - 1;
  const VectorXd range = states.rowwise().maxCoeff() - states.rowwise().minCoeff();
  VectorXd length = VectorXd::Zero(count);
  for (Eigen::Index j = 0; j < count; ++j) {
    for (Eigen::Index i = 0; i < range.size(); ++i)
      if (range(i) > 0.0) length(j) += std::pow((states(i, j + 1) - states(i, j)) / range(i), 2);
    length(j) = std::sqrt(length(j));
  }
  const double total = length.sum();
  std::vector<double> weight{0.0};  // cumulated
  for (Eigen::Index j = 0; j < count; ++j)
    weight.push_back(weight.back() + 1.0 / static_cast<double>(count) + (total > 0.0 ? length(j) / total : 0.0));
  std::vector<double> tau{0.0};
  std::size_t j = 0;
  for (int k = 1; k < parts; ++k) {
    const double target = weight.back() * k / parts;
    while (weight[j + 1] < target) ++j;
    const double inside = (target - weight[j]) / (weight[j + 1] - weight[j]);
    tau.push_back((static_cast<double>(j) + inside) / static_cast<double>(count));
  }
  tau.push_back(1.0);
  return tau;
}

}  // namespace

OrbitSamples sample_orbit(const HybridSystem& system, const FoundOrbit& orbit, const VectorXd& par, int rows) {
  std::vector<double> uniform;
  const int fine = 4 * rows;
  for (int k = 0; k <= fine; ++k) uniform.push_back(static_cast<double>(k) / fine);
  OrbitSamples samples;
  samples.tau = equal_weights(sample_all(system, orbit, par, uniform), rows - 1);
  samples.states = sample_all(system, orbit, par, samples.tau);
  return samples;
}

}  // namespace tchat
