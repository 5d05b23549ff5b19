#include "motion/found_orbit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/levels.hpp"
#include "linear/dense_matrix.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"
#include "motion/cvodes_flow.hpp"
#include "orbit/mesh_adaptation.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double waits = 10.0;                   // for the event of a segment, as a multiple of the simulated turn
constexpr double same_orbit = 0.1;               // largest correction, as a share of the orbit's range
constexpr double together = level::rounding;     // events so far apart, as a share of the period
constexpr double same_state = level::tolerance;  // of points of the refined orbit, likewise

bool ends_in_section(const HybridSystem& system, const std::vector<SimulatedSegment>& turn, std::size_t s) {
  return is_identity_jump(system, turn[s].index) && turn[(s + 1) % turn.size()].mode.field() == turn[s].mode.field();
}

/// `first` and the segment that follows it without anything between.
SimulatedSegment joined(const SimulatedSegment& first, SimulatedSegment second) {
  for (const IndexVector& v : first.mode.index_vectors)
    if (const auto& all = second.mode.index_vectors; std::find(all.begin(), all.end(), v) == all.end())
      second.mode.index_vectors.push_back(v);
  for (const int event : first.mode.monitored)
    if (const auto& all = second.mode.monitored; std::find(all.begin(), all.end(), event) == all.end())
      second.mode.monitored.push_back(event);
  second.start = first.start;
  second.start_time = first.start_time;
  second.duration += first.duration;
  second.low = second.low.cwiseMin(first.low);
  second.high = second.high.cwiseMax(first.high);
  second.samples.clear();
  second.marks.clear();
  return second;
}

/// Events that come together to rounding come together.
void settle_instants(FoundOrbit& found) {
  for (std::size_t s = 0; s < found.map.segments.size(); ++s) {
    double& duration = found.map.segments[s].duration;
    if (found.instants[s] && std::abs(duration) <= found.uncertainty * found.map.period) duration = 0.0;
  }
}

PeriodicOrbit shoot_finely(const HybridSystem& system, FoundOrbit& found, const VectorXd& guess, const VectorXd& par,
                           const std::vector<Eigen::Index>& ignorable) {
  ShootingOptions options;
  options.ignorable = ignorable;
  options.instants = found.instants;
  options.flow.sizes = found.sizes;
  options.flow.max_duration = found.longest_wait;
  const PeriodicOrbit orbit = shoot(system, found.signature, guess, par, options);
  found.uncertainty = level::orbit;
  if (orbit.converged) return orbit;
  // Large derivatives leave fewer digits.
  options.flow.set(level::relaxed_flow);
  options.tolerance = level::orbit;
  const PeriodicOrbit roughly = shoot(system, found.signature, guess, par, options);
  found.uncertainty = level::located;
  if (roughly.converged) return roughly;
  // On a stiff problem the steps of a method for others are too many.
  options.flow.method = IntegrationMethod::bdf;
  options.flow.max_steps = 1000000;
  PeriodicOrbit stiff = shoot(system, found.signature, guess, par, options);
  if (!stiff.converged) return roughly;
  found.method = IntegrationMethod::bdf;
  return stiff;
}

/// How far each state goes on the simulated orbit; infinitely far where it does not matter.
VectorXd ranges(const std::vector<SimulatedSegment>& turn, const std::vector<Eigen::Index>& ignorable,
                const VectorXd& sizes) {
  VectorXd low = turn.front().low;
  VectorXd high = turn.front().high;
  for (const SimulatedSegment& segment : turn) {
    low = low.cwiseMin(segment.low);
    high = high.cwiseMax(segment.high);
  }
  VectorXd range = high - low;
  for (const Eigen::Index k : ignorable) range(k) = 0.0;
  range += 1e-3 * sizes;
  for (const Eigen::Index k : ignorable) range(k) = INFINITY;
  return range;
}

/// Shooting has gone to an equilibrium: nothing moves in a period, in ranges of the simulated turn.
bool is_at_rest(const HybridSystem& system, const FoundOrbit& found, const PeriodicOrbit& orbit, const VectorXd& par,
                const VectorXd& range) {
  VectorXd f(range.size());
  double fastest = 0.0;
  for (std::size_t s = 0; s < found.signature.size(); ++s)
    for (const VectorXd& x : {orbit.map.segments[s].start, orbit.map.segments[s].end}) {
      system.value(FunctionKind::field, found.signature[s].field, x.data(), par.data(), f.data());
      fastest = std::max(fastest, f.cwiseQuotient(range).lpNorm<Eigen::Infinity>());
    }
  return fastest * orbit.map.period <= level::located;
}

/// The number of segments after which the orbit already repeats itself: near an orbit with a multiplier close to -1 the
/// simulation comes back best after two turns.
std::size_t true_period(const FoundOrbit& found, const PeriodicOrbit& orbit, const VectorXd& range) {
  const std::size_t m = found.signature.size();
  for (std::size_t q = 1; q < m; ++q) {
    bool repeats = m % q == 0;
    for (std::size_t s = 0; repeats && s < m; ++s) {
      const VectorXd difference = orbit.map.segments[s].start - orbit.map.segments[(s + q) % m].start;
      repeats = found.signature[s] == found.signature[(s + q) % m] &&
                (difference.cwiseAbs().array() <= same_state * range.array()).all();
    }
    if (repeats) return q;
  }
  return m;
}

}  // namespace

OrbitStability stability_of(const std::vector<std::complex<double>>& multipliers, double uncertainty) {
  double largest = 0.0;
  for (const auto& mu : multipliers) largest = std::max(largest, std::abs(mu));
  if (largest < 1.0 - uncertainty) return OrbitStability::stable;
  return largest > 1.0 + uncertainty ? OrbitStability::unstable : OrbitStability::neutral;
}

std::vector<std::complex<double>> multipliers_without(const MatrixXd& m, const std::vector<Eigen::Index>& ignorable) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    if (std::find(ignorable.begin(), ignorable.end(), i) == ignorable.end()) kept.push_back(i);
  const Eigen::VectorXcd values = eigenvalues(MatrixXd(m(kept, kept)));
  std::vector<std::complex<double>> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
    return std::abs(a) != std::abs(b) ? std::abs(a) > std::abs(b) : a.imag() > b.imag();
  });
  return sorted;
}

std::vector<SimulatedSegment> in_standard_order(std::vector<SimulatedSegment> turn, const IndexVector& first) {
  const auto sequence_from = [&](std::size_t begin) {
    Signature s;
    for (std::size_t i = 0; i < turn.size(); ++i) s.push_back(turn[(begin + i) % turn.size()].index);
    return s;
  };
  const auto is_better = [&](std::size_t a, std::size_t b) {
    const bool a_first = turn[a].index == first;
    const bool b_first = turn[b].index == first;
    return a_first != b_first ? a_first : sequence_from(a) < sequence_from(b);
  };
  std::size_t best = 0;
  for (std::size_t k = 1; k < turn.size(); ++k)
    if (is_better(k, best)) best = k;
  std::rotate(turn.begin(), turn.begin() + static_cast<std::ptrdiff_t>(best), turn.end());
  return turn;
}

std::vector<SimulatedSegment> without_sections(const HybridSystem& system, std::vector<SimulatedSegment> turn) {
  std::size_t last = turn.size();  // a segment that stays one
  for (std::size_t s = 0; s < turn.size(); ++s)
    if (!ends_in_section(system, turn, s)) last = s;
  if (last == turn.size()) return turn;
  std::rotate(turn.begin(), turn.begin() + static_cast<std::ptrdiff_t>((last + 1) % turn.size()), turn.end());
  std::vector<SimulatedSegment> kept;
  bool open = false;  // the last one kept goes on
  for (std::size_t s = 0; s < turn.size(); ++s) {
    if (open)
      kept.back() = joined(kept.back(), turn[s]);
    else
      kept.push_back(turn[s]);
    open = ends_in_section(system, turn, s);
  }
  return kept;
}

FoundOrbit without_cuts(FoundOrbit orbit, std::vector<int> monitored) {
  MapSegment whole = orbit.map.segments.front();
  whole.end = orbit.map.segments.back().end;
  whole.duration = orbit.map.period;
  orbit.map.segments = {whole};
  orbit.signature = {{orbit.signature.front().field, no_function, no_function}};
  orbit.modes = {Mode{{}, std::move(monitored)}};
  return orbit;
}

FoundOrbit refine(const HybridSystem& system, const Turn& recognised, const VectorXd& par, const IndexVector& first,
                  bool is_guess) {
  const std::vector<SimulatedSegment> turn = in_standard_order(recognised.segments, first);
  FoundOrbit found;
  found.sizes = sizes_in(system, turn, par).sizes();
  double period = 0.0;
  for (const SimulatedSegment& segment : turn) period += segment.duration;
  found.longest_wait = waits * period;
  for (const SimulatedSegment& segment : turn) {
    found.signature.push_back(segment.index);
    found.modes.push_back(segment.mode);
    found.instants.push_back(period > 0.0 && segment.duration <= together * period);
  }
  const VectorXd range = ranges(turn, recognised.ignorable, found.sizes);
  PeriodicOrbit orbit = shoot_finely(system, found, turn.front().start, par, recognised.ignorable);
  // Only where shooting has closed the orbit does its map have all segments.
  if (const std::size_t events = orbit.converged ? true_period(found, orbit, range) : turn.size();
      events < turn.size()) {
    found.signature.resize(events);
    found.modes.resize(events);
    found.instants.resize(events);
    orbit = shoot_finely(system, found, orbit.start, par, recognised.ignorable);
  }
  found.start = orbit.start;
  found.map = orbit.map;
  settle_instants(found);
  found.iterations = orbit.iterations;
  if (!orbit.converged) {
    found.message = orbit.message;
    return found;
  }
  found.moved = orbit.start - turn.front().start;
  if (is_at_rest(system, found, orbit, par, range)) {
    found.message = "shooting went to an equilibrium, where nothing moves";
    return found;
  }
  const double share = found.moved.cwiseQuotient(range).lpNorm<Eigen::Infinity>();
  const double turned = found.map.period * static_cast<double>(turn.size() / found.signature.size());
  if (!is_guess && !(std::abs(turned - period) <= same_orbit * period)) {
    found.message = fmt::format("shooting went to another orbit, of period {:.6g}", found.map.period);
    return found;
  }
  if (!is_guess && !(share < same_orbit)) {
    found.message = fmt::format("shooting went {:.2g} of its range away, to another orbit", share);
    return found;
  }
  found.converged = true;
  found.multipliers = multipliers_without(orbit.map.derivative, recognised.ignorable);
  const auto states = static_cast<std::size_t>(least_dimension(system, found.signature));
  if (found.multipliers.size() > states) found.multipliers.resize(states);  // the others are zero
  found.advance = VectorXd::Zero(found.start.size());
  for (const Eigen::Index k : recognised.ignorable) found.advance(k) = orbit.map.end(k) - orbit.start(k);
  return found;
}

namespace {

constexpr double wanted_error = level::tolerance;
constexpr int most_intervals = 1000;
constexpr int first_samples = 1600;

/// Samples of one segment.
///
/// A node's time is known to its rounding, which is more than a sharp part takes where that lies far from the start: a
/// spike of 1e-10 after 100 units of time. So integration begins anew, at time 0, where samples are that close.
class SegmentSampler {
 public:
  SegmentSampler(const HybridSystem& system, const FoundOrbit& orbit, std::size_t s, const VectorXd& par)
      : system_(system), index_(orbit.signature[s]), segment_(orbit.map.segments[s]), par_(par) {
    options_.variational = false;
    options_.method = orbit.method;
    options_.sizes = orbit.sizes;
    options_.set(level::reference_flow);
    options_.max_steps = 10000000;
  }

  /// x_s at duration * tau, the first and last columns being those of the refined orbit.
  MatrixXd at(const std::vector<double>& tau) const {
    MatrixXd states = segment_.start.replicate(1, static_cast<Eigen::Index>(tau.size()));
    states.rightCols(1) = segment_.end;
    if (segment_.duration == 0.0) return states;
    for (std::size_t first = 0; first + 2 < tau.size();) first = sample_from(first, tau, states);
    return states;
  }

 private:
  /// Up to where integration must begin anew, or to the last sample before the end.
  std::size_t sample_from(std::size_t first, const std::vector<double>& tau, MatrixXd& states) const {
    constexpr double closest = level::located;  // of the time since the start: the spacing's rounding is 1e-10 of it
    std::size_t last = first + 1;
    while (last + 2 < tau.size() && tau[last + 1] - tau[last] > closest * (tau[last] - tau[first])) ++last;
    const VectorXd start = states.col(static_cast<Eigen::Index>(first));
    double duration = segment_.duration;
    if (const double left = 1.0 - tau[first]; first > 0 && last + 2 == tau.size())
      duration = time_to_event(start, left * duration, states) / left;
    CvodesFlow flow(system_, index_.field, start, par_, options_);
    const auto time = [&](std::size_t k) { return (tau[k] - tau[first]) * duration; };
    std::size_t next = first + 1;
    flow.on_piece([&](double, double to) {
      for (; next <= last && time(next) <= to; ++next)
        states.col(static_cast<Eigen::Index>(next)) = flow.state_at(time(next));
      return true;
    });
    flow.advance(time(last));
    return last;
  }

  /// The end of a short last part from `start`, whose time has lost its digits, by the event itself.
  double time_to_event(const VectorXd& start, double expected, MatrixXd& states) const {
    if (index_.event == no_function) return expected;
    CvodesFlow flow(system_, index_.field, start, par_, options_);
    flow.watch({index_.event});
    if (flow.advance(2.0 * expected) != Progress::root) return expected;
    states.rightCols(1) = flow.state();
    return flow.time();
  }

  const HybridSystem& system_;
  IndexVector index_;
  const MapSegment& segment_;
  const VectorXd& par_;
  FlowOptions options_;
};

MatrixXd sample_all(const HybridSystem& system, const FoundOrbit& orbit, const VectorXd& par,
                    const std::vector<double>& tau) {
  const Eigen::Index n = system.dimension();
  MatrixXd stacked(n * static_cast<Eigen::Index>(orbit.signature.size()), static_cast<Eigen::Index>(tau.size()));
  for (std::size_t s = 0; s < orbit.signature.size(); ++s)
    stacked.middleRows(static_cast<Eigen::Index>(s) * n, n) = SegmentSampler(system, orbit, s, par).at(tau);
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

/// The orbit's states on a mesh, in units of their sizes, exact at its nodes.
Orbit on_mesh(const HybridSystem& system, const FoundOrbit& orbit, const VectorXd& par, std::vector<double> mesh,
              int collocation) {
  const int n = system.dimension();
  const int m = static_cast<int>(orbit.signature.size());
  const OrbitShape shape{n, m, static_cast<int>(mesh.size()) - 1, collocation};
  Orbit x{shape, std::move(mesh), MatrixXd(n, shape.columns()), ParameterVector(system.layout(), m)};
  const MatrixXd stacked = sample_all(system, orbit, par, x.node_times());
  for (int s = 0; s < m; ++s) {
    x.states.middleCols(s * shape.nodes(), shape.nodes()) =
        orbit.sizes.unaryExpr(&size_for_tolerance).cwiseInverse().asDiagonal() * stacked.middleRows(s * n, n);
    x.duration(s) = orbit.map.segments[static_cast<std::size_t>(s)].duration;
  }
  return x;
}

}  // namespace

std::optional<FastPart> fastest_part(const OrbitSamples& samples, int dimension) {
  constexpr double fewest_digits = 16.0 * std::numeric_limits<double>::epsilon(), away = level::located;
  const std::vector<double>& tau = samples.tau;
  const auto close =
      std::adjacent_find(tau.begin(), tau.end(), [](double a, double b) { return b - a < fewest_digits; });
  if (close == tau.end()) return std::nullopt;
  const Eigen::Index k = close - tau.begin();
  const auto far = std::find_if(tau.rbegin(), tau.rend(), [&](double t) { return t < *close - away; });
  const Eigen::Index before =
      far != tau.rend() ? tau.rend() - far - 1 : std::upper_bound(tau.begin(), tau.end(), *close + away) - tau.begin();
  const VectorXd range = samples.states.rowwise().maxCoeff() - samples.states.rowwise().minCoeff();
  Eigen::Index row = 0;
  (samples.states.col(k) - samples.states.col(before))
      .cwiseAbs()
      .cwiseQuotient(range.cwiseMax(std::numeric_limits<double>::min()))
      .maxCoeff(&row);
  return FastPart{static_cast<int>(row) / dimension + 1, static_cast<int>(row) % dimension + 1, samples.states(row, k),
                  samples.states(row, before)};
}

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
