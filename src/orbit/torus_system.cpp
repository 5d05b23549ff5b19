#include "orbit/torus_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "orbit/coupling.hpp"
#include "orbit/rotation.hpp"

namespace tchat {

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
  const Eigen::VectorXd ranges =
      (x.states.rowwise().maxCoeff() - x.states.rowwise().minCoeff()).cwiseMax(1e-12 * x.states.cwiseAbs().maxCoeff());
  const Eigen::MatrixXd columns = periodic_columns(x, system.orbits(), system.winding().curve);
  const Eigen::Index m = system.segments_per_return();
  Eigen::VectorXd scale(columns.rows());
  for (Eigen::Index r = 0; r + m < columns.rows(); ++r) scale(r) = ranges(r % x.shape.dimension);
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
