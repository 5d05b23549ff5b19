#include "maps/smooth_return.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"
#include "motion/cvodes_flow.hpp"
#include "motion/hybrid_simulation.hpp"
#include "motion/orbit_flow.hpp"

namespace tchat {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd QuadraticMap::operator()(const VectorXd& z) const {
  const VectorXd u = z - at;
  VectorXd image = value + first * u;
  for (std::size_t i = 0; i < second.size(); ++i) image(static_cast<Eigen::Index>(i)) += 0.5 * u.dot(second[i] * u);
  return image;
}

MatrixXd QuadraticMap::derivative(const VectorXd& z) const {
  MatrixXd jacobian = first;
  const VectorXd u = z - at;
  for (std::size_t i = 0; i < second.size(); ++i)
    jacobian.row(static_cast<Eigen::Index>(i)) += (second[i] * u).transpose();
  return jacobian;
}

namespace {

std::vector<IndexVector> following(const HybridSystem& system, const IndexVector& from, const Eigen::VectorXd& z,
                                   const Eigen::VectorXd& par) {
  return system.successors(from, z.data(), par.data()).value_or(std::vector<IndexVector>{});
}

}  // namespace

Signature return_path(const HybridSystem& system, const Eigen::VectorXd& z, const Eigen::VectorXd& par, int section,
                      int field, const FlowOptions& given, int most) {
  FlowOptions options = given;
  options.variational = false;
  Signature path;
  Eigen::VectorXd x = z;
  std::vector<IndexVector> mode = following(system, {0, 0, 0}, x, par);
  while (static_cast<int>(path.size()) < most) {
    if (!mode.empty()) field = mode.front().field;
    std::vector<int> events{section};
    for (const IndexVector& index : mode)
      if (std::find(events.begin(), events.end(), index.event) == events.end()) events.push_back(index.event);
    CvodesFlow flow(system, field, x, par, options);
    flow.watch(events);
    const Progress progress = flow.advance(options.max_duration);
    if (progress == Progress::failed) throw ComputationError(flow.message());
    if (progress != Progress::root)
      throw ComputationError(fmt::format("the flow from {} does not come back to the section within time {:g}",
                                         state_text(z), options.max_duration));
    if (flow.fallen() == section) {
      path.push_back({field, section, no_function});
      return path;
    }
    const Mode watched{mode, {}};
    const IndexVector index = watched.ended_by(flow.fallen());
    path.push_back(index);
    const Eigen::VectorXd before = flow.state();
    system.value(FunctionKind::jump, index.jump, before.data(), par.data(), x.data());
    mode = following(system, index, before, par);
  }
  throw ComputationError(
      fmt::format("the flow from {} does not come back to the section within {} events", state_text(z), most));
}

namespace {

using Eigen::RowVectorXd;

using Second = std::vector<MatrixXd>;

/// A function with its derivatives at a point: F, F_z, and F_zz as a map of two vectors.
class Expanded {
 public:
  Expanded(const HybridSystem& system, FunctionKind kind, int index, const VectorXd& z, const VectorXd& par)
      : system_(system),
        kind_(kind),
        index_(index),
        z_(z),
        par_(par),
        value(system.rows(kind)),
        first(system.rows(kind), z.size()) {
    system_.first(kind, index, z.data(), par.data(), {}, value.data(), first.data(), nullptr);
  }

  /// F_zz v, a matrix of as many rows as F has.
  MatrixXd second(const VectorXd& v) const {
    VectorXd along(value.size());
    MatrixXd out(value.size(), z_.size());
    system_.second(kind_, index_, z_.data(), par_.data(), {}, v.data(), along.data(), out.data(), nullptr);
    return out;
  }

 private:
  const HybridSystem& system_;
  FunctionKind kind_;
  int index_;
  const VectorXd& z_;
  const VectorXd& par_;

 public:
  VectorXd value;
  MatrixXd first;
};

/// z, Phi and S in one vector: the columns S_ab, a <= b, behind those of Phi.
class SecondVariation {
 public:
  using State = std::vector<double>;

  SecondVariation(const HybridSystem& system, int field, const VectorXd& par)
      : system_(system), field_(field), par_(par), n_(system.dimension()) {}

  std::size_t size() const { return static_cast<std::size_t>(n_ * (1 + n_ + n_ * (n_ + 1) / 2)); }

  State start(const VectorXd& z) const {
    State y(size(), 0.0);
    Eigen::Map<VectorXd>(y.data(), n_) = z;
    Eigen::Map<MatrixXd>(y.data() + n_, n_, n_).setIdentity();
    return y;
  }

  void operator()(const State& y, State& rate, double) const {
    const VectorXd z = Eigen::Map<const VectorXd>(y.data(), n_);
    const Eigen::Map<const MatrixXd> columns(y.data() + n_, n_, n_ + n_ * (n_ + 1) / 2);
    const Expanded f(system_, FunctionKind::field, field_, z, par_);
    Eigen::Map<VectorXd>(rate.data(), n_) = f.value;
    Eigen::Map<MatrixXd> out(rate.data() + n_, n_, columns.cols());
    out.noalias() = f.first * columns;
    for (Eigen::Index a = 0, column = n_; a < n_; ++a) {
      const MatrixXd along = f.second(columns.col(a));
      for (Eigen::Index b = a; b < n_; ++b) out.col(column++) += along * columns.col(b);
    }
  }

  Second second(const State& y) const {
    Second s(static_cast<std::size_t>(n_), MatrixXd(n_, n_));
    const Eigen::Map<const MatrixXd> columns(y.data() + n_, n_, n_ + n_ * (n_ + 1) / 2);
    for (Eigen::Index a = 0, column = n_; a < n_; ++a)
      for (Eigen::Index b = a; b < n_; ++b, ++column)
        for (Eigen::Index i = 0; i < n_; ++i)
          s[static_cast<std::size_t>(i)](a, b) = s[static_cast<std::size_t>(i)](b, a) = columns(i, column);
    return s;
  }

 private:
  const HybridSystem& system_;
  int field_;
  const VectorXd& par_;
  Eigen::Index n_;
};

Second second_of_flow(const HybridSystem& system, int field, const VectorXd& z, const VectorXd& par, double duration) {
  namespace odeint = boost::numeric::odeint;
  const SecondVariation equations(system, field, par);
  SecondVariation::State y = equations.start(z);
  const auto stepper = odeint::make_controlled(level::reference_flow.absolute, level::reference_flow.relative,
                                               odeint::runge_kutta_fehlberg78<SecondVariation::State>());
  odeint::integrate_adaptive(stepper, equations, y, 0.0, duration, 0.01 * duration);
  return equations.second(y);
}

/// Second derivatives of F(map(u)) where the first ones of `map` are `inner` and its second ones `second`:
/// F_z second + F_zz inner inner.
Second composed(const Expanded& outer, const MatrixXd& inner, const Second& second) {
  Second out(static_cast<std::size_t>(outer.value.size()), MatrixXd::Zero(inner.cols(), inner.cols()));
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::size_t k = 0; k < second.size(); ++k)
      out[i] += outer.first(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) * second[k];
  for (Eigen::Index a = 0; a < inner.cols(); ++a) {
    const MatrixXd along = outer.second(inner.col(a)) * inner;
    for (std::size_t i = 0; i < out.size(); ++i) out[i].row(a) += along.row(static_cast<Eigen::Index>(i));
  }
  return out;
}

/// What has been passed so far, as a function of the start.
struct Passed {
  VectorXd z;
  MatrixXd first;
  Second second;
  double time = 0.0;
};

/// The flow over a fixed time, whose end is where the event is met at the expansion's centre.
void pass_flow(Passed& passed, const MatrixXd& phi, const Second& second, const VectorXd& end) {
  Second out(second.size());
  for (std::size_t i = 0; i < second.size(); ++i) {
    out[i] = passed.first.transpose() * second[i] * passed.first;
    for (std::size_t k = 0; k < second.size(); ++k)
      out[i] += phi(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) * passed.second[k];
  }
  passed.second = std::move(out);
  passed.first = phi * passed.first;
  passed.z = end;
}

/// Onto the surface h = 0 along the flow: z + f tau + 1/2 f_z f tau^2, tau to second order from h = 0.
void pass_event(Passed& passed, const HybridSystem& system, const IndexVector& index, const VectorXd& par) {
  const Expanded f(system, FunctionKind::field, index.field, passed.z, par);
  const Expanded h(system, FunctionKind::event, index.event, passed.z, par);
  const double rate = h.first.row(0).dot(f.value);
  const RowVectorXd tau = change_of_time(f.value, h.first.transpose(), passed.first);
  const MatrixXd onto = passed.first + f.value * tau;
  if (!passed.second.empty()) {
    const MatrixXd turned = f.first * passed.first;  // f_z Phi
    const VectorXd bent = f.first * f.value;
    for (std::size_t i = 0; i < passed.second.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      passed.second[i] +=
          turned.row(row).transpose() * tau + tau.transpose() * turned.row(row) + bent(row) * tau.transpose() * tau;
    }
    const Second of_h = composed(h, onto, passed.second);
    for (std::size_t i = 0; i < passed.second.size(); ++i)
      passed.second[i] -= f.value(static_cast<Eigen::Index>(i)) / rate * of_h[0];
  }
  passed.first = onto;
}

void pass_jump(Passed& passed, const HybridSystem& system, int jump, const VectorXd& par) {
  if (jump == no_function) return;
  const Expanded g(system, FunctionKind::jump, jump, passed.z, par);
  if (!passed.second.empty()) passed.second = composed(g, passed.first, passed.second);
  passed.first = g.first * passed.first;
  passed.z = g.value;
}

}  // namespace

QuadraticMap smooth_return(const HybridSystem& system, const Signature& path, const VectorXd& z,
                           const VectorXd& par_given, int order, const FlowOptions& given) {
  const VectorXd par = full_parameters(system, par_given);
  FlowOptions options = given;
  options.variational = true;
  const Eigen::Index n = system.dimension();
  Passed passed{z, MatrixXd::Identity(n, n), {}, 0.0};
  if (order > 1) passed.second.assign(static_cast<std::size_t>(n), MatrixXd::Zero(n, n));
  for (std::size_t s = 0; s < path.size(); ++s) {
    const VectorXd start = passed.z;
    const SegmentFlow flow = integrate_segment(system, path[s], start, par, options);
    if (flow.status != FlowStatus::event_reached)
      throw ComputationError(fmt::format("segment {} of the return to the section: {}", s + 1, flow.message));
    const EventAt met = event_at(system, path[s].event, path[s].field, flow.end_state.data(), par.data());
    if (!(std::abs(met.rate()) > level::negligible * met.rate_scale(sizes_at(system, path[s].field, start, par))))
      throw ComputationError(
          fmt::format("segment {} of the return to the section meets {} tangentially, the map has "
                      "no derivative there",
                      s + 1, system.function_name(FunctionKind::event, path[s].event)));
    if (order > 1)
      pass_flow(passed, flow.jacobian, second_of_flow(system, path[s].field, start, par, flow.duration),
                flow.end_state);
    else
      pass_flow(passed, flow.jacobian, {}, flow.end_state);
    pass_event(passed, system, path[s], par);
    pass_jump(passed, system, path[s].jump, par);
    passed.time += flow.duration;
  }
  if (!passed.z.allFinite() || !passed.first.allFinite())
    throw ComputationError("the return to the section has no finite derivatives");
  return {z, passed.z, passed.first, passed.second, passed.time};
}

namespace {

using Eigen::Index;

constexpr double closure = level::same;  // of the turn, relative to the orbit's extent

double scaled_distance(const VectorXd& d, const VectorXd& scale) {
  return d.cwiseQuotient(scale).cwiseAbs().maxCoeff();
}

/// How often the section is met on the last segment up to x*, where it ends: the orbit has further least distances.
int crossings_before(const SuspendedSystem& suspended, const IndexVector& index, int section, const VectorXd& start,
                     const VectorXd& par, double duration, const FlowOptions& given) {
  FlowOptions options = given;
  options.variational = false;
  CvodesFlow flow(suspended.system(), index.field, start, par, options);
  flow.watch({section});
  int crossings = 0;
  // x* itself is met within the errors of `duration`, and does not count.
  while (flow.advance(duration * (1.0 - level::located)) == Progress::root) ++crossings;
  return crossings;
}

}  // namespace

PeriodicReturn::PeriodicReturn(std::shared_ptr<const SuspendedSystem> suspended, const GrazingTurn& turn, int section,
                               int order, const FlowOptions& options)
    : suspended_(std::move(suspended)) {
  const HybridSystem& system = suspended_->system();
  const VectorXd start = suspended_->suspended(turn.x, turn.par);
  extent_ = sizes_from_ranges(turn.extent, sizes_at(suspended_->base(), suspended_->field(), turn.x, turn.par));
  FlowOptions waiting = options;
  for (const double duration : turn.durations) waiting.max_duration = std::max(waiting.max_duration, 2.0 * duration);
  VectorXd last = start;
  if (turn.segments.size() > 1) {
    const Signature before(turn.segments.begin(), turn.segments.end() - 1);
    last = smooth_return(system, before, start, turn.par, 1, waiting).value;
    path_ = before;
  }
  const IndexVector onto{turn.segments.back().field, section, no_function};
  const int crossings = crossings_before(*suspended_, onto, section, last, turn.par, turn.durations.back(), waiting);
  path_.insert(path_.end(), static_cast<std::size_t>(crossings + 1), onto);
  map_ = smooth_return(system, path_, start, turn.par, order, waiting);
  const double miss = scaled_distance(suspended_->state(map_.value - start), extent_);
  if (!(miss <= closure))
    throw ComputationError(
        fmt::format("the smooth flow from the grazing point x* = {} does not come back to it: after time {:.6g} it is "
                    "{:.1e} of the orbit's extent away",
                    state_text(turn.x), map_.time, miss));
  // The orbit's own error must not look like a drift of the map: x* is its fixed point.
  map_.value = start;
}

VectorXd PeriodicReturn::image(const VectorXd& x, const ParameterVector& par) const {
  return suspended_->state(map_(suspended_->suspended(x, par)));
}

MatrixXd PeriodicReturn::derivative(const VectorXd& x, const ParameterVector& par) const {
  const Index n = x.size();
  return map_.derivative(suspended_->suspended(x, par)).topLeftCorner(n, n);
}

double PeriodicReturn::distance(const VectorXd& x) const {
  return scaled_distance(x - suspended_->state(map_.at), extent_);
}

}  // namespace tchat
