#include "orbit/monitor_gradient.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/levels.hpp"
#include "linear/dense_matrix.hpp"

namespace tchat {

namespace {

constexpr double noise = level::located;  // of the terms of a second derivative
/// Closer to a singular matrix there is no family in these parameters.
constexpr double least_distance = level::converged;

std::vector<const Monitor*> with_objective(const Monitor& objective, const std::vector<const Monitor*>& held) {
  std::vector<const Monitor*> list{&objective};
  list.insert(list.end(), held.begin(), held.end());
  return list;
}

}  // namespace

ReducedGradient::ReducedGradient(const DefiningSystem& system, const OrbitShape& shape, const Monitor& objective,
                                 const std::vector<const Monitor*>& held)
    : system_(system),
      rule_(shape.collocation),
      monitors_(with_objective(objective, held)),
      nodal_(system, shape),
      map_(system, shape),
      derivatives_(std::ssize(monitors_), system.free_count()),
      terms_(std::ssize(monitors_), system.free_count()),
      adjoint_(monitors_.size()),
      values_(system.free_count() - std::ssize(held)),
      sizes_(values_.size()),
      tangent_(shape, system.free_count()),
      row_(shape, system.free_count()),
      second_row_(row_) {}

bool ReducedGradient::evaluate(const Orbit& x) {
  why_none_ = "these orbits are no family in the parameters (multiplier 1)";
  if (!nodal_.factorize(x) || !(nodal_.singular_distance() > least_distance)) return false;
  const Eigen::MatrixXd& columns = nodal_.parameter_columns();
  for (std::size_t i = 0; i < monitors_.size(); ++i) {
    const auto r = static_cast<Eigen::Index>(i);
    const double q = monitors_[i]->gradient(x, rule_, row_);
    nodal_.solve_adjoint(row_, adjoint_[i]);
    derivatives_.row(r) = row_.globals.transpose() - adjoint_[i].transpose() * columns;
    terms_.row(r) = row_.globals.cwiseAbs().transpose() + adjoint_[i].cwiseAbs().transpose() * columns.cwiseAbs();
    for (Eigen::Index k = 0; k < terms_.cols(); ++k)
      terms_(r, k) += std::abs(q) / parameter_size(system_, x, static_cast<int>(k));
  }
  why_none_ = "a derivative of a monitor is not finite";
  if (!derivatives_.allFinite()) return false;
  why_none_ = "what is held does not depend on the last parameters, which are to follow: give ICP another order";
  if (!find_multipliers()) return false;
  combined_ = adjoint_.front();
  for (std::size_t i = 1; i < adjoint_.size(); ++i)
    combined_ += combination_(static_cast<Eigen::Index>(i)) * adjoint_[i];
  weights_ = nodal_.by_kind(combined_);
  return true;
}

/// Within a period.
bool ReducedGradient::depends_on_phase(const Orbit& x) {
  constexpr double zero = level::located;
  for (int s = 0; s < x.shape.segments; ++s)
    for (std::size_t i = 0; !system_.has_event(s) && i < monitors_.size(); ++i)
      if (std::abs(x.period() * nodal_.phase_derivative(adjoint_[i], x, s)) >
          zero * terms_.row(static_cast<Eigen::Index>(i)).maxCoeff())
        return true;
  return false;
}

/// nu from the derivatives by the parameters that depend on the others, and with it H.
bool ReducedGradient::find_multipliers() {
  const Eigen::Index held = derivatives_.rows() - 1;
  const Eigen::Index independent = values_.size();
  combination_ = Eigen::VectorXd::Unit(1 + held, 0);
  dependent_.resize(held, independent);
  if (held > 0) {
    const Eigen::MatrixXd by_held = derivatives_.bottomRightCorner(held, held);
    const PivotedLu of_held(by_held);
    if (!of_held.is_regular()) return false;
    dependent_ = -of_held.solve(derivatives_.bottomLeftCorner(held, independent));
    combination_.tail(held) = -solve(by_held.transpose(), derivatives_.row(0).tail(held).transpose());
  }
  values_ = (combination_.transpose() * derivatives_.leftCols(independent)).transpose();
  sizes_ = (combination_.cwiseAbs().transpose() * terms_.leftCols(independent)).transpose();
  return values_.allFinite();
}

const OrbitVector& ReducedGradient::tangent(int k) {
  tangent_.globals = Eigen::VectorXd::Unit(tangent_.globals.size(), k);
  tangent_.globals.tail(dependent_.rows()) = dependent_.col(k);
  nodal_.solve(tangent_);
  return tangent_;
}

/// The largest change of a free parameter against its own size, which is the scale on which monitors may change.
double ReducedGradient::relative_change(const Orbit& x, const OrbitVector& y) const {
  constexpr double least = level::located;
  double largest = 0.0;
  for (Eigen::Index k = 0; k < y.globals.size(); ++k) {
    const double p = std::abs(x.par(system_.free_parameters()[static_cast<std::size_t>(k)] - 1));
    const double known = parameter_size(system_, x, static_cast<int>(k)) - p;
    largest = std::max(largest, std::abs(y.globals(k)) / (p > least * known ? p : known));
  }
  return largest;
}

double ReducedGradient::distance(const Orbit& x, int k) {
  derivative(x, k, second_row_);
  const OrbitVector& y = tangent(k);
  const double second = dot(second_row_, y);
  if (!(std::abs(second) > noise * dot_of_sizes(second_row_, y))) return std::numeric_limits<double>::infinity();
  return std::abs(values_(k) / second) / parameter_size(system_, x, k);
}

void ReducedGradient::derivative(const Orbit& x, int k, OrbitVector& row) {
  constexpr double share = 2e-3;  // of the orbit's size: the fifth root of rounding, about
  const OrbitVector& y = tangent(k);
  const double size = std::max({y.states.cwiseAbs().maxCoeff() / (1.0 + x.states.cwiseAbs().maxCoeff()),
                                y.durations.cwiseAbs().maxCoeff() / (time_size(system_, x) + std::abs(x.period())),
                                relative_change(x, y)});
  const double step = share / size;
  row.set_zero();
  add_monitor_gradient(x, y, step, 8.0 / (12.0 * step), row);
  add_monitor_gradient(x, y, -step, -8.0 / (12.0 * step), row);
  add_monitor_gradient(x, y, 2.0 * step, -1.0 / (12.0 * step), row);
  add_monitor_gradient(x, y, -2.0 * step, 1.0 / (12.0 * step), row);
  map_.subtract_derivative(x, weights_, y, row);
}

/// Adds `factor` times the gradient of q - nu . r at x + step along.
void ReducedGradient::add_monitor_gradient(const Orbit& x, const OrbitVector& along, double step, double factor,
                                           OrbitVector& row) {
  displaced_ = x;
  advance(displaced_, step, along, system_.free_parameters());
  for (std::size_t i = 0; i < monitors_.size(); ++i) {
    monitors_[i]->gradient(displaced_, rule_, row_);
    const double share = factor * combination_(static_cast<Eigen::Index>(i));
    row.states += share * row_.states;
    row.durations += share * row_.durations;
    row.globals += share * row_.globals;
  }
}

/// In units of the parameters in which the diagonal is 1, for signs are the same in all units.
ReducedGradient::Nature ReducedGradient::nature(const Orbit& x, const std::vector<int>& parameters) {
  constexpr double least = level::visible;  // far more than differences and the distance to the point leave
  const auto count = std::ssize(parameters);
  Eigen::MatrixXd second(count, count), terms(count, count);
  OrbitVector row(x.shape, system_.free_count());
  for (Eigen::Index i = 0; i < count; ++i) {
    derivative(x, parameters[static_cast<std::size_t>(i)], row);
    for (Eigen::Index k = 0; k < count; ++k) {
      const OrbitVector& y = tangent(parameters[static_cast<std::size_t>(k)]);
      second(i, k) = dot(row, y);
      terms(i, k) = dot_of_sizes(row, y);
    }
  }
  const Eigen::VectorXd units =
      second.diagonal().cwiseAbs().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = units.asDiagonal() * second * units.asDiagonal();
  const Eigen::MatrixXd of_terms = units.asDiagonal() * terms * units.asDiagonal();
  const double uncertainty =
      least + (scaled - scaled.transpose()).cwiseAbs().maxCoeff() + noise * of_terms.cwiseAbs().maxCoeff();
  const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(0.5 * (scaled + scaled.transpose()));
  if (!eigenvalues.allFinite() || !(eigenvalues.cwiseAbs().minCoeff() > uncertainty)) return Nature::unknown;
  if (eigenvalues.minCoeff() > 0.0) return Nature::minimum;
  return eigenvalues.maxCoeff() < 0.0 ? Nature::maximum : Nature::saddle;
}

std::vector<const Monitor*> held_monitors(const std::vector<HeldMonitor>& held) {
  std::vector<const Monitor*> list;
  for (const HeldMonitor& one : held) list.push_back(one.monitor.get());
  return list;
}

StationaryMonitor::StationaryMonitor(const DefiningSystem& system, const OrbitShape& shape,
                                     std::shared_ptr<const Monitor> objective, const std::vector<HeldMonitor>& held)
    : objective_(std::move(objective)),
      held_(held),
      gradient_(system, shape, *objective_, held_monitors(held_)),
      rows_(static_cast<std::size_t>(count()), OrbitVector(shape, system.free_count())) {}

bool StationaryMonitor::evaluate(CondensedSystem&, const Orbit& x) {
  if (!gradient_.evaluate(x)) return false;
  next_scales_.resize(rows_.size());
  for (int k = 0; k < count(); ++k) next_scales_[static_cast<std::size_t>(k)] = gradient_.size(k);
  if (scales_.empty()) scales_ = next_scales_;
  for (int k = 0; k < count(); ++k) {
    OrbitVector& row = rows_[static_cast<std::size_t>(k)];
    gradient_.derivative(x, k, row);
    row.scale(1.0 / scales_[static_cast<std::size_t>(k)]);
  }
  return std::all_of(rows_.begin(), rows_.end(), [](const OrbitVector& row) { return row.states.allFinite(); });
}

void StationaryMonitor::remember(std::vector<double>& memory) const { memory = next_scales_; }

bool is_stationary(const DefiningSystem& system, const Orbit& x, const Monitor& objective,
                   const std::vector<HeldMonitor>& held) {
  constexpr double near = 1e-2;  // far more than a located point leaves, whatever its tolerances
  ReducedGradient gradient(system, x.shape, objective, held_monitors(held));
  if (!gradient.evaluate(x) || gradient.depends_on_phase(x)) return false;
  for (int k = 0; k < gradient.count() - 1; ++k)
    if (!(gradient.distance(x, k) <= near)) return false;
  return true;
}

}  // namespace tchat
