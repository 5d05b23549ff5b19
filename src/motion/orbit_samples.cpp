#include "motion/orbit_samples.hpp"

#include <algorithm>
#include <cmath>

#include "motion/cvodes_flow.hpp"
#include "orbit/mesh_adaptation.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double wanted_error = 1e-7;
constexpr int most_intervals = 1000;
constexpr int first_samples = 1600;

/// x_s at duration * tau, the first and last columns being those of the refined orbit.
MatrixXd sample_segment(const HybridSystem& system, int field, const MapSegment& segment, const VectorXd& par,
                        IntegrationMethod method, const std::vector<double>& tau) {
  MatrixXd states = segment.start.replicate(1, static_cast<Eigen::Index>(tau.size()));
  states.rightCols(1) = segment.end;
  FlowOptions options;
  options.variational = false;
  options.method = method;
  options.relative_tolerance = 1e-13;
  options.absolute_tolerance = 1e-14;
  options.max_steps = 10000000;
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
        sample_segment(system, orbit.signature[s].field, orbit.map.segments[s], par, orbit.method, tau);
  return stacked;
}

/// [0, 1] in `parts` parts of equal weight 1/2 (time + arclength), given states at times tau.
std::vector<double> equal_weights(const std::vector<double>& tau, const MatrixXd& states, int parts) {
  const Eigen::Index count = states.cols() - 1;
  const VectorXd range = states.rowwise().maxCoeff() - states.rowwise().minCoeff();
  VectorXd length = VectorXd::Zero(count);
  VectorXd time(count);
  for (Eigen::Index j = 0; j < count; ++j) {
    time(j) = tau[static_cast<std::size_t>(j + 1)] - tau[static_cast<std::size_t>(j)];
    for (Eigen::Index i = 0; i < range.size(); ++i)
      if (range(i) > 0.0) length(j) += std::pow((states(i, j + 1) - states(i, j)) / range(i), 2);
    length(j) = std::sqrt(length(j));
  }
  const double total = length.sum();
  if (total > 0.0) length /= total;
  return equal_parts(tau, (time + length).cwiseQuotient(time), parts);
}

/// Times of the orbit's nodes on a mesh, each interval in `parts` equal parts.
std::vector<double> divided(const std::vector<double>& mesh, int parts) {
  std::vector<double> tau{0.0};
  for (std::size_t j = 0; j + 1 < mesh.size(); ++j)
    for (int k = 1; k <= parts; ++k)
      tau.push_back(k == parts ? mesh[j + 1] : mesh[j] + (mesh[j + 1] - mesh[j]) * k / parts);
  return tau;
}

/// The orbit's states on a mesh, exact at its nodes.
Orbit on_mesh(const HybridSystem& system, const FoundOrbit& orbit, const VectorXd& par, std::vector<double> mesh,
              int collocation) {
  const int n = system.dimension();
  const int m = static_cast<int>(orbit.signature.size());
  const OrbitShape shape{n, m, static_cast<int>(mesh.size()) - 1, collocation};
  Orbit x{shape, std::move(mesh), MatrixXd(n, shape.columns()), ParameterVector(system.layout(), m)};
  const MatrixXd stacked = sample_all(system, orbit, par, x.node_times());
  for (int s = 0; s < m; ++s) {
    x.states.middleCols(s * shape.nodes(), shape.nodes()) = stacked.middleRows(s * n, n);
    x.duration(s) = orbit.map.segments[static_cast<std::size_t>(s)].duration;
  }
  return x;
}

}  // namespace

OrbitSamples sample_orbit(const HybridSystem& system, const FoundOrbit& orbit, const VectorXd& par, int intervals,
                          int collocation) {
  // Sharp parts may lie between equally spaced times: these gather there.
  std::vector<double> tau = uniform_mesh(first_samples);
  for (int pass = 0; pass < 4; ++pass) tau = equal_weights(tau, sample_all(system, orbit, par, tau), first_samples);
  const CollocationRule rule(collocation);
  OrbitSamples samples;
  for (samples.intervals = intervals;; samples.intervals += (samples.intervals + 3) / 4) {
    std::vector<double> mesh = resampled_mesh(tau, samples.intervals);
    for (int pass = 0; pass < 6; ++pass)
      mesh = equidistributed_mesh(on_mesh(system, orbit, par, mesh, collocation), rule, samples.intervals);
    samples.error = estimated_interpolation_error(on_mesh(system, orbit, par, mesh, collocation), rule);
    if (samples.error > wanted_error && samples.intervals < most_intervals) continue;
    samples.tau = divided(mesh, 2 * collocation);
    samples.states = sample_all(system, orbit, par, samples.tau);
    return samples;
  }
}

}  // namespace tchat
