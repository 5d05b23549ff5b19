#include "orbit/torus_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/levels.hpp"
#include "orbit/defining_system.hpp"

namespace tchat {

namespace {

constexpr double turn = 2.0 * std::numbers::pi;

/// Derivative of K of any order, the sum.
double kernel_sum(int harmonics, double t, int derivative) {
  const double quarter = 0.25 * derivative;  // each derivative turns the cosine by a quarter
  double sum = derivative == 0 ? 1.0 : 0.0;
  for (int k = 1; k <= harmonics; ++k) {
    const double phase = k * t;
    double factor = 2.0;
    for (int d = 0; d < derivative; ++d) factor *= turn * k;
    sum += factor * std::cos(turn * (phase - std::floor(phase) + quarter));
  }
  return sum / (2 * harmonics + 1);
}

/// K and K' in closed form, K = sin(pi N t) / (N sin(pi t)), but for t so near to a whole number that K' would lose
/// digits: there are one or two of those among N equally spaced t.
double kernel(int harmonics, double t, int derivative) {
  const int count = 2 * harmonics + 1;
  const double s = std::sin(0.5 * turn * t);
  if (derivative > 1 || std::abs(s) < 1.0 / count) return kernel_sum(harmonics, t, derivative);
  const double top = std::sin(0.5 * turn * count * t);
  if (derivative == 0) return top / (count * s);
  const double slope = count * std::cos(0.5 * turn * count * t) * s - top * std::cos(0.5 * turn * t);
  return 0.5 * turn * slope / (count * s * s);
}

}  // namespace

Eigen::RowVectorXd interpolation_weights(int count, double phi, int derivative) {
  Eigen::RowVectorXd weights(count);
  set_interpolation_weights(phi, derivative, weights);
  return weights;
}

void set_interpolation_weights(double phi, int derivative, Eigen::RowVectorXd& weights) {
  const auto count = static_cast<int>(weights.size());
  for (int l = 0; l < count; ++l)
    weights(l) = kernel((count - 1) / 2, phi - static_cast<double>(l) / count, derivative);
}

Eigen::MatrixXd resampled_curve(const Eigen::MatrixXd& values, int count) {
  const auto old_count = static_cast<int>(values.cols());
  const int harmonics = (std::min(count, old_count) - 1) / 2;
  // With the kernel of the fewer harmonics, as a mean over the old values.
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(values.rows(), count);
  for (int i = 0; i < count; ++i)
    for (int l = 0; l < old_count; ++l) {
      const double t = static_cast<double>(i) / count - static_cast<double>(l) / old_count;
      result.col(i) += kernel(harmonics, t, 0) * (2 * harmonics + 1) / old_count * values.col(l);
    }
  return result;
}

Eigen::VectorXd harmonic_sizes(const Eigen::MatrixXd& values, const Eigen::VectorXd& scale) {
  const auto count = static_cast<int>(values.cols());
  Eigen::VectorXd sizes((count + 1) / 2);
  Eigen::VectorXd cosines(count);
  Eigen::VectorXd sines(count);
  for (int k = 0; k < sizes.size(); ++k) {
    for (int l = 0; l < count; ++l) {
      const double phase = turn * static_cast<double>((k * l) % count) / count;
      cosines(l) = std::cos(phase);
      sines(l) = std::sin(phase);
    }
    const double factor = (k == 0 ? 1.0 : 2.0) / count;
    const Eigen::VectorXd a = values * cosines;
    const Eigen::VectorXd b = values * sines;
    sizes(k) = factor * ((a.cwiseAbs2() + b.cwiseAbs2()).cwiseSqrt().cwiseQuotient(scale)).maxCoeff();
  }
  return sizes;
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double whole_angle = 2.0 * std::numbers::pi;
/// Of the values of a function: what rounding of 2 pi may do to them.
constexpr double rounding_of_angles = level::orbit;
constexpr int most_turns = 3;

VectorXd function_value(const HybridSystem& system, FunctionKind kind, int index, const VectorXd& x,
                        const VectorXd& par) {
  VectorXd out(system.rows(kind));
  system.value(kind, index, x.data(), par.data(), out.data());
  return out;
}

/// What each value of a function is made of: itself, and what states as large as these make of its derivatives.
VectorXd sizes_of_terms(const HybridSystem& system, FunctionKind kind, int index, const VectorXd& x,
                        const VectorXd& states, const VectorXd& par) {
  VectorXd value(system.rows(kind));
  Eigen::MatrixXd by_state(system.rows(kind), x.size());
  system.first(kind, index, x.data(), par.data(), {}, value.data(), by_state.data(), nullptr);
  return value.cwiseAbs() + by_state.cwiseAbs() * states.cwiseAbs();
}

/// Do the functions of a segment not see that a state is further?
bool is_blind(const HybridSystem& system, const IndexVector& index, const VectorXd& x, const VectorXd& further,
              const VectorXd& par) {
  const auto differs = [&](FunctionKind kind, int which, const VectorXd& shift) {
    const VectorXd here = function_value(system, kind, which, x, par);
    const VectorXd there = function_value(system, kind, which, further, par) - shift;
    const VectorXd sizes = sizes_of_terms(system, kind, which, x, further.cwiseAbs().cwiseMax(x.cwiseAbs()), par);
    return !((here - there).array().abs() <= rounding_of_angles * sizes.array()).all();
  };
  const VectorXd none = VectorXd::Zero(x.size());
  return !differs(FunctionKind::field, index.field, none) &&
         !differs(FunctionKind::event, index.event, VectorXd::Zero(1)) &&
         !differs(FunctionKind::jump, index.jump, further - x);
}

/// The same of all samples, for a state that is further by so much.
bool is_blind(const HybridSystem& system, const Signature& one_return, const MatrixXd& samples, Index state,
              double change, const VectorXd& par) {
  for (Index k = 0; k < samples.cols(); ++k) {
    const VectorXd x = samples.col(k);
    VectorXd further = x;
    further(state) += change;
    for (const IndexVector& index : one_return)
      if (!is_blind(system, index, x, further, par)) return false;
  }
  return true;
}

/// Of a state so large that a turn is rounding of it no part of a turn is seen either, but a change by its own size is.
bool is_angle(const HybridSystem& system, const Signature& one_return, const MatrixXd& samples, Index state,
              const VectorXd& par) {
  const double radian = 1.0 / system.unit_of(static_cast<int>(state) + 1);
  const double size = samples.row(state).cwiseAbs().maxCoeff();
  const auto does_not_matter = [&](double change) { return is_blind(system, one_return, samples, state, change, par); };
  return does_not_matter(whole_angle * radian) && (!does_not_matter(radian) || does_not_matter(size));
}

double last_harmonics_of(const VectorXd& values, double w) {
  Eigen::RowVectorXd row = values.transpose();
  for (Index l = 0; l < row.size(); ++l) row(l) -= w * static_cast<double>(l) / static_cast<double>(row.size());
  const VectorXd sizes = harmonic_sizes(row, VectorXd::Ones(1));
  return sizes.tail(std::min<Index>(2, sizes.size() - 1)).maxCoeff();
}

}  // namespace

TorusWinding no_winding(int dimension) { return {VectorXd::Zero(dimension), VectorXd::Zero(dimension)}; }

double likely_winding(const VectorXd& values) {
  double best = 0.0;
  double least = last_harmonics_of(values, 0.0);
  for (int turns = -most_turns; turns <= most_turns; ++turns) {
    const double last = last_harmonics_of(values, whole_angle * turns);
    if (!(last < least)) continue;
    least = last;
    best = whole_angle * turns;
  }
  return best;
}

std::vector<Index> angle_states(const HybridSystem& system, const Signature& one_return, const MatrixXd& samples,
                                const VectorXd& par) {
  std::vector<Index> angles;
  for (Index state = 0; state < samples.rows(); ++state)
    if (is_angle(system, one_return, samples, state, par)) angles.push_back(state);
  return angles;
}

TorusWinding torus_winding(const HybridSystem& system, const Signature& one_return, const Orbit& x) {
  const auto m = static_cast<Index>(one_return.size());
  const Index n = x.shape.dimension;
  const Index orbits = x.shape.segments / m;
  MatrixXd curve(n, orbits);
  for (Index l = 0; l < orbits; ++l) curve.col(l) = Eigen::Map<const VectorXd>(x.start(static_cast<int>(l * m)), n);
  TorusWinding winding = no_winding(static_cast<int>(n));
  const VectorXd& par = x.par;
  const double rho = x.par.rotation();
  const Eigen::RowVectorXd weights = interpolation_weights(static_cast<int>(orbits), rho);
  VectorXd end = function_value(system, FunctionKind::jump, one_return.back().jump,
                                Eigen::Map<const VectorXd>(x.end(static_cast<int>(m) - 1), n), par);
  for (const Index state : angle_states(system, one_return, curve, par)) {
    const double unit = system.unit_of(static_cast<int>(state) + 1);
    const double w = likely_winding(unit * curve.row(state)) / unit;
    double target = w * rho;
    for (Index l = 0; l < orbits; ++l)
      target += weights(l) * (curve(state, l) - w * static_cast<double>(l) / static_cast<double>(orbits));
    winding.curve(state) = w;
    winding.returns(state) = whole_angle / unit * std::round((end(state) - target) * unit / whole_angle);
  }
  return winding;
}

namespace {

Signature repeated(const Signature& one_return, int orbits) {
  Signature signature;
  for (int i = 0; i < orbits; ++i) signature.insert(signature.end(), one_return.begin(), one_return.end());
  return signature;
}

/// Everything about one orbit of one return in a column: its nodes, and below them its durations.
Eigen::MatrixXd columns_of(const Eigen::MatrixXd& states, const Eigen::VectorXd& durations, int orbits) {
  const Eigen::Index per_orbit = states.size() / orbits;
  const Eigen::Index m = durations.size() / orbits;
  Eigen::MatrixXd columns(per_orbit + m, orbits);
  columns.topRows(per_orbit) = Eigen::Map<const Eigen::MatrixXd>(states.data(), per_orbit, orbits);
  columns.bottomRows(m) = Eigen::Map<const Eigen::MatrixXd>(durations.data(), m, orbits);
  return columns;
}

Eigen::VectorXd durations_of(const Orbit& x) { return x.par.durations(x.shape.segments); }

/// Adds `turns` times w to the states of a column of them; `states` of its rows are states.
void wind(Eigen::Ref<Eigen::VectorXd> column, Eigen::Index states, const Eigen::VectorXd& w, double turns) {
  if (w.size() == 0 || w.isZero()) return;
  for (Eigen::Index first = 0; first < states; first += w.size()) column.segment(first, w.size()) += turns * w;
}

/// The columns less w phi, periodic in phi.
Eigen::MatrixXd periodic_columns(const Orbit& x, int orbits, const Eigen::VectorXd& w) {
  Eigen::MatrixXd columns = columns_of(x.states, durations_of(x), orbits);
  for (int l = 0; l < orbits; ++l) wind(columns.col(l), x.states.size() / orbits, w, -static_cast<double>(l) / orbits);
  return columns;
}

}  // namespace

TorusSystem::TorusSystem(const HybridSystem& system, const Signature& one_return, int orbits,
                         std::vector<int> free_parameters)
    : TorusSystem(system, one_return, orbits, std::move(free_parameters), no_winding(system.dimension())) {}

TorusSystem::TorusSystem(const HybridSystem& system, const Signature& one_return, int orbits,
                         std::vector<int> free_parameters, TorusWinding winding)
    : PeriodicOrbitSystem(system, repeated(one_return, orbits), std::move(free_parameters)),
      orbits_(orbits),
      winding_(std::move(winding)),
      kernel_(orbits),
      kernel_slope_(orbits),
      slope_at_zero_(interpolation_weights(orbits, 0.0, 1)),
      phase_row_(dimension(), orbits) {
  const auto& free = this->free_parameters();
  const auto at = std::find(free.begin(), free.end(), layout().rotation());
  rotation_global_ = at == free.end() ? -1 : static_cast<int>(at - free.begin());
}

void TorusSystem::set_kernels(double rho) const {
  if (has_kernels_ && rho == rho_) return;
  set_interpolation_weights(rho, 0, kernel_);
  set_interpolation_weights(rho, 1, kernel_slope_);
  rho_ = rho;
  has_kernels_ = true;
}

void TorusSystem::target_pattern(int s, int row, CouplingPattern& pattern) const {
  if (!ends_return(s)) return PeriodicOrbitSystem::target_pattern(s, row, pattern);
  for (int l = 0; l < orbits_; ++l) pattern.start_components(row, l * segments_per_return());
  if (rotation_global_ >= 0) pattern.global(row, dimension(), rotation_global_);
}

void TorusSystem::target_value(int s, const Orbit& x, double* target) const {
  if (!ends_return(s)) return PeriodicOrbitSystem::target_value(s, x, target);
  set_kernels(rotation(x));
  const int orbit = s / segments_per_return();
  const double phi = static_cast<double>(orbit) / orbits_ + rotation(x);
  for (int a = 0; a < dimension(); ++a) {
    target[a] = winding_.curve(a) * phi + winding_.returns(a);
    for (int l = 0; l < orbits_; ++l) target[a] += weight(orbit, l, kernel_) * periodic(x, l, a);
  }
}

double* TorusSystem::target_derivatives(int s, const Orbit& x, double* entries) const {
  if (!ends_return(s)) return PeriodicOrbitSystem::target_derivatives(s, x, entries);
  set_kernels(rotation(x));
  const int orbit = s / segments_per_return();
  for (int l = 0; l < orbits_; ++l) entries = std::fill_n(entries, dimension(), weight(orbit, l, kernel_));
  if (rotation_global_ < 0) return entries;
  for (int a = 0; a < dimension(); ++a) {
    entries[a] = winding_.curve(a);
    for (int l = 0; l < orbits_; ++l) entries[a] += weight(orbit, l, kernel_slope_) * periodic(x, l, a);
  }
  return entries + dimension();
}

std::string TorusSystem::target_name(int s) const {
  if (!ends_return(s)) return PeriodicOrbitSystem::target_name(s);
  return fmt::format("of the curve, rho beyond the start of return {},", s / segments_per_return() + 1);
}

/// r' at the phases i / N.
void TorusSystem::find_phase_row(const Orbit& reference) const {
  for (int i = 0; i < orbits_; ++i)
    for (int a = 0; a < dimension(); ++a) {
      phase_row_(a, i) = winding_.curve(a);
      for (int l = 0; l < orbits_; ++l) phase_row_(a, i) += weight(i, l, slope_at_zero_) * periodic(reference, l, a);
    }
  const double length = phase_row_.norm();
  if (length > 0.0) phase_row_ /= length;
}

void TorusSystem::integral_values(const Orbit& x, const Orbit& reference, const CollocationRule&,
                                  double* values) const {
  find_phase_row(reference);
  double sum = 0.0;
  for (int i = 0; i < orbits_; ++i) {
    const double* u = x.start(i * segments_per_return());
    const double* r = reference.start(i * segments_per_return());
    for (int a = 0; a < dimension(); ++a) sum += (u[a] - r[a]) * phase_row_(a, i);
  }
  *values = sum;
}

void TorusSystem::integral_gradients(const Orbit& x, const Orbit& reference, const CollocationRule& rule,
                                     double* values, std::span<OrbitVector> rows) const {
  integral_values(x, reference, rule, values);
  OrbitVector& row = rows.front();
  row.set_zero();
  for (int i = 0; i < orbits_; ++i)
    row.states.col(static_cast<Eigen::Index>(i) * segments_per_return() * x.shape.nodes()) = phase_row_.col(i);
}

std::string TorusSystem::integral_name(int) const { return "phase condition of the torus"; }

Eigen::MatrixXd section_curve(const TorusSystem& system, const Orbit& x, int s) {
  Eigen::MatrixXd values(x.shape.dimension, system.orbits());
  for (int i = 0; i < system.orbits(); ++i)
    values.col(i) = Eigen::Map<const Eigen::VectorXd>(x.start(i * system.segments_per_return() + s), x.shape.dimension);
  return values;
}

Eigen::MatrixXd periodic_section_curve(const TorusSystem& system, const Orbit& x, int s) {
  Eigen::MatrixXd values = section_curve(system, x, s);
  for (int i = 0; i < system.orbits(); ++i)
    values.col(i) -= static_cast<double>(i) / system.orbits() * system.winding().curve;
  return values;
}

double mean_return_time(const TorusSystem& system, const Orbit& x) { return x.period() / system.orbits(); }

Eigen::VectorXd torus_harmonics(const TorusSystem& system, const Orbit& x) {
  const Eigen::VectorXd largest = x.states.cwiseAbs().rowwise().maxCoeff();
  std::vector<bool> rounding;
  for (const double value : largest) rounding.push_back(value <= level::negligible * largest.maxCoeff());
  const Eigen::VectorXd sizes =
      sizes_of_differences(x.states.rowwise().minCoeff(), x.states.rowwise().maxCoeff(), rounding);
  const Eigen::MatrixXd columns = periodic_columns(x, system.orbits(), system.winding().curve);
  const Eigen::Index m = system.segments_per_return();
  Eigen::VectorXd scale(columns.rows());
  for (Eigen::Index r = 0; r + m < columns.rows(); ++r) scale(r) = sizes(r % x.shape.dimension);
  scale.tail(m).setConstant(mean_return_time(system, x));
  return harmonic_sizes(columns, scale);
}

double last_harmonics(const TorusSystem& system, const Orbit& x) {
  const Eigen::VectorXd sizes = torus_harmonics(system, x);
  return sizes.tail(std::min<Eigen::Index>(2, sizes.size() - 1)).maxCoeff();
}

Orbit resampled_torus(const Orbit& x, int orbits, int new_orbits, const Eigen::VectorXd& winding) {
  const int m = x.shape.segments / orbits;
  Eigen::MatrixXd columns = resampled_curve(periodic_columns(x, orbits, winding), new_orbits);
  for (int l = 0; l < new_orbits; ++l)
    wind(columns.col(l), columns.rows() - m, winding, static_cast<double>(l) / new_orbits);
  Orbit result{x.shape, x.mesh, {}, x.par};
  result.shape.segments = m * new_orbits;
  const Eigen::MatrixXd nodes = columns.topRows(columns.rows() - m);
  result.states = Eigen::Map<const Eigen::MatrixXd>(nodes.data(), x.shape.dimension, result.shape.columns());
  const Eigen::MatrixXd durations = columns.bottomRows(m);
  result.par.durations(x.shape.segments).setZero();
  result.par.durations(result.shape.segments) = Eigen::Map<const Eigen::VectorXd>(durations.data(), durations.size());
  return result;
}

OrbitVector resampled_torus(const OrbitVector& v, const OrbitShape& shape, int orbits, int new_orbits) {
  const int m = shape.segments / orbits;
  const Eigen::MatrixXd columns = resampled_curve(columns_of(v.states, v.durations, orbits), new_orbits);
  OrbitShape new_shape = shape;
  new_shape.segments = m * new_orbits;
  OrbitVector result(new_shape, static_cast<int>(v.globals.size()));
  const Eigen::MatrixXd nodes = columns.topRows(columns.rows() - m);
  result.states = Eigen::Map<const Eigen::MatrixXd>(nodes.data(), shape.dimension, new_shape.columns());
  const Eigen::MatrixXd durations = columns.bottomRows(m);
  result.durations = Eigen::Map<const Eigen::VectorXd>(durations.data(), durations.size());
  result.globals = v.globals;
  return result;
}

NodeWeights node_weights(const Orbit& x, const CollocationRule& rule, double tau) {
  const auto beyond = std::upper_bound(x.mesh.begin(), x.mesh.end() - 1, tau);
  const auto j = std::max<std::ptrdiff_t>(beyond - x.mesh.begin() - 1, 0);
  const double left = x.mesh[static_cast<std::size_t>(j)];
  NodeWeights result{static_cast<int>(j), Eigen::VectorXd(rule.points() + 1)};
  Eigen::VectorXd slopes(rule.points() + 1);
  rule.basis((tau - left) / (x.mesh[static_cast<std::size_t>(j + 1)] - left), result.weights.data(), slopes.data());
  return result;
}

Orbit empty_return(const TorusSystem& system, const Orbit& x) {
  Orbit result{x.shape, x.mesh, {}, x.par};
  result.shape.segments = system.segments_per_return();
  result.states.resize(x.shape.dimension, result.shape.columns());
  return result;
}

Orbit return_at(const TorusSystem& system, const Orbit& x, double phi, int derivative) {
  Orbit result = empty_return(system, x);
  set_return_at(system, x, phi, derivative, interpolation_weights(system.orbits(), phi, derivative), result);
  return result;
}

void set_return_at(const TorusSystem& system, const Orbit& x, double phi, int derivative,
                   const Eigen::RowVectorXd& weights, Orbit& result) {
  const int m = system.segments_per_return();
  const Eigen::VectorXd& w = system.winding().curve;
  const double factor = derivative == 0 ? phi : derivative == 1 ? 1.0 : 0.0;
  result.mesh = x.mesh;
  result.par = x.par;
  result.states.setZero();
  result.par.durations(m).setZero();
  double mean_phase = 0.0;  // what the weights make of l / N
  const Eigen::Index columns = result.shape.columns();
  for (int l = 0; l < system.orbits(); ++l) {
    result.states += weights(l) * x.states.middleCols(l * columns, columns);
    for (int s = 0; s < m; ++s) result.duration(s) += weights(l) * x.duration(l * m + s);
    mean_phase += weights(l) * l / system.orbits();
  }
  for (Eigen::Index c = 0; c < columns; ++c) result.states.col(c) += (factor - mean_phase) * w;
}

}  // namespace tchat
