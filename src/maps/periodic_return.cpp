#include "maps/periodic_return.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "base/user_error.hpp"
#include "maps/smooth_return.hpp"
#include "motion/cvodes_flow.hpp"
#include "motion/mode_rule.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double closure = 1e-5;  // of the turn, relative to the orbit's extent

VectorXd floored(const VectorXd& extent) { return extent.cwiseMax(1e-3 * extent.maxCoeff()); }

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
  while (flow.advance(duration * (1.0 - 1e-6)) == Progress::root) ++crossings;
  return crossings;
}

}  // namespace

PeriodicReturn::PeriodicReturn(std::shared_ptr<const SuspendedSystem> suspended, const GrazingTurn& turn, int section,
                               int order, const FlowOptions& options)
    : suspended_(std::move(suspended)), extent_(floored(turn.extent)) {
  const HybridSystem& system = suspended_->system();
  const VectorXd start = suspended_->suspended(turn.x, turn.par);
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
