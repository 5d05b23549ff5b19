#include "kinds/segment_check.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>

#include "base/levels.hpp"
#include "model/events.hpp"
#include "motion/cvodes_flow.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// A duration below this share of the period needs no integrator: two terms of the Taylor series are exact to rounding.
constexpr double shortest_duration = level::double_zero;
constexpr int samples_of_a_step = 8;

/// h and its derivatives along the flow of a field, at one state.
struct EventToSecondOrder {
  double h = 0.0;
  double rate = 0.0;          // h_x f
  double acceleration = 0.0;  // d (h_x f) / dt = f' h_xx f + h_x f_x f

  EventToSecondOrder(const HybridSystem& system, int field, int event, const VectorXd& x, const VectorXd& par) {
    const EventAt at = event_at(system, event, field, x.data(), par.data());
    h = at.h;
    rate = at.rate();
    acceleration = rate_gradient(system, at, event, field, x.data(), par.data()).dot(at.f);
  }

  /// How far in time the event is; of a surface that is hardly more than touched, h is least.
  double time_to_zero() const {
    if (h == 0.0) return 0.0;
    const double by_rate = rate != 0.0 ? std::abs(h / rate) : INFINITY;
    const double by_parabola = acceleration != 0.0 ? std::sqrt(2.0 * std::abs(h / acceleration)) : INFINITY;
    return by_rate <= by_parabola ? by_rate : time_to_contact();
  }
  /// How far in time h_x f = 0 is.
  double time_to_contact() const {
    if (rate == 0.0) return 0.0;
    return acceleration != 0.0 ? std::abs(rate / acceleration) : INFINITY;
  }
  /// Does the flow meet the surface as a parabola touches its tangent, as far as h can be told from h + `level`?
  bool touches(double level) const {
    return rate * rate <= 2.0 * std::abs(acceleration) * level && acceleration != 0.0;
  }
};

/// sum |h_x| scale: what a change of all states by their scales makes of h, to first order.
double event_size(const HybridSystem& system, int event, const VectorXd& x, const VectorXd& par,
                  const VectorXd& scale) {
  return event_at(system, event, x.data(), par.data()).gradient.cwiseAbs().dot(scale);
}

/// NaN where an entry is.
double largest(const VectorXd& difference, const VectorXd& scale) {
  return difference.cwiseAbs().cwiseQuotient(scale).maxCoeff<Eigen::PropagateNaN>();
}

/// The events of one segment while the flow passes: which fell when, and how far below zero each has gone since.
class Watcher {
 public:
  Watcher(const HybridSystem& system, const StoredSegment& segment, const VectorXd& par, const VectorXd& scale)
      : system_(system), segment_(segment), par_(par), scale_(scale) {
    for (const int event : segment.monitored) depths_[event] = {event, 0.0, 0.0};
    all_ = events();
    look(segment.start, 0.0);
  }

  /// The segment's own event, the monitored ones and the alternatives, each once.
  std::vector<int> events() const {
    std::set<int> all(segment_.monitored.begin(), segment_.monitored.end());
    if (segment_.index.event != no_function) all.insert(segment_.index.event);
    for (const IndexVector& v : segment_.alternatives) all.insert(v.event);
    return {all.begin(), all.end()};
  }

  void look(const VectorXd& x, double time) {
    for (const int event : all_) {
      double& size = sizes_[event];
      size = std::max(size, event_size(system_, event, x, par_, scale_));
    }
    for (auto& [event, met] : depths_) {
      if (met.depth == 0.0 && fallen_.count(event) == 0) met.time = time;
      deepen(met, x);
    }
    for (EventMet& met : passed_) deepen(met, x);
  }

  /// The largest sum |h_x| scale that has been seen: where the gradient vanishes at the surface, the size there is none
  /// to measure by. 1 where it vanishes everywhere.
  double size(int event) const {
    const auto found = sizes_.find(event);
    return found != sizes_.end() && found->second > 0.0 ? found->second : 1.0;
  }

  void fall(int event, const VectorXd& x, double time) {
    const bool is_monitored =
        std::find(segment_.monitored.begin(), segment_.monitored.end(), event) != segment_.monitored.end();
    if (!is_monitored && changes_nothing(event, x)) {
      passed_.push_back({event, time, 0.0});
      return;
    }
    if (!fallen_.insert(event).second) return;
    const auto [met, is_new] = depths_.try_emplace(event, EventMet{event, time, 0.0});
    if (!is_new && met->second.depth == 0.0) met->second.time = time;
  }

  std::vector<EventMet> wrong(double tolerance) const {
    std::vector<EventMet> all;
    for (const auto& [event, met] : depths_) all.push_back(met);
    return deep_ones(std::move(all), tolerance);
  }

  std::vector<EventMet> passed(double tolerance) const { return deep_ones(passed_, tolerance); }

 private:
  void deepen(EventMet& met, const VectorXd& x) const {
    const double h = system_.event(met.event, x.data(), par_.data());
    if (h < 0.0) met.depth = std::max(met.depth, -h);
  }

  std::vector<EventMet> deep_ones(std::vector<EventMet> all, double tolerance) const {
    for (EventMet& met : all) met.depth /= size(met.event);
    std::erase_if(all, [&](const EventMet& met) { return met.depth <= tolerance; });
    std::sort(all.begin(), all.end(), [](const EventMet& a, const EventMet& b) { return a.time < b.time; });
    return all;
  }

  /// Would the state and the field after the event be those before it?
  bool changes_nothing(int event, const VectorXd& x) const {
    const auto is_neutral = [&](int jump) {
      VectorXd after(x.size());
      system_.value(FunctionKind::jump, jump, x.data(), par_.data(), after.data());
      return all_finite(after.data(), static_cast<int>(after.size())) && largest(after - x, scale_) < level::orbit;
    };
    if (event == segment_.index.event)
      return segment_.next_field == segment_.index.field && is_neutral(segment_.index.jump);
    return std::any_of(segment_.alternatives.begin(), segment_.alternatives.end(), [&](const IndexVector& v) {
      if (v.event != event || !is_neutral(v.jump)) return false;
      const auto next = system_.successors(v, x.data(), par_.data()).value_or(std::vector<IndexVector>{});
      return std::any_of(next.begin(), next.end(), [&](const IndexVector& w) { return w.field == v.field; });
    });
  }

  const HybridSystem& system_;
  const StoredSegment& segment_;
  const VectorXd& par_;
  const VectorXd& scale_;
  std::vector<int> all_;            // events()
  std::map<int, double> sizes_;     // of each, the largest so far
  std::map<int, EventMet> depths_;  // -min h of events that matter: monitored ones, and those that have fallen
  std::set<int> fallen_;
  std::vector<EventMet> passed_;
};

struct Passage {
  std::string message;
  VectorXd end;
  MatrixXd flow;
  std::vector<EventMet> wrong, passed;
  double size = 1.0;  // of the segment's own event
  IntegralValues integrals;
};

/// The integrals of a problem's integrands along one segment, piece by piece of the integrator's dense output.
class IntegralSum {
 public:
  IntegralSum(const HybridSystem& system, const StoredSegment& segment, const VectorXd& par, const VectorXd& scale)
      : system_(system), segment_(segment), par_(par), scale_(scale) {
    const int count = segment.integrand > 0 ? system.integral_conditions() : 0;
    values_ = {VectorXd::Zero(count), VectorXd::Zero(count)};
  }

  bool is_empty() const { return values_.values.size() == 0; }

  /// With Gauss' rule of seven points.
  void add(const std::function<VectorXd(double)>& state_at, double from, double to) {
    using Gauss = boost::math::quadrature::gauss<double, 7>;
    const double half = 0.5 * (to - from);
    for (std::size_t k = 0; k < Gauss::abscissa().size(); ++k)
      for (const double sign : {1.0, -1.0}) {
        const double node = sign * Gauss::abscissa()[k];
        if (node == 0.0 && sign < 0.0) continue;
        add_point(state_at(from + half * (1.0 + node)), half * Gauss::weights()[k]);
      }
  }

  void add_point(const VectorXd& x, double weight) {
    const Eigen::Index count = values_.values.size();
    VectorXd q(count);
    MatrixXd by_state(count, x.size());
    double no_parameters = 0.0;
    system_.first(FunctionKind::integrand, segment_.integrand, x.data(), par_.data(), {}, q.data(), by_state.data(),
                  &no_parameters);
    values_.values += weight * q;
    values_.sizes += std::abs(weight) * (q.cwiseAbs() + by_state.cwiseAbs() * scale_);
  }

  IntegralValues values() const { return values_; }

 private:
  const HybridSystem& system_;
  const StoredSegment& segment_;
  const VectorXd& par_;
  const VectorXd& scale_;
  IntegralValues values_;
};

Passage taylor(const HybridSystem& system, const StoredSegment& segment, const VectorXd& par, const VectorXd& scale) {
  const int n = system.dimension();
  VectorXd f(n);
  MatrixXd fx(n, n);
  double no_parameters = 0.0;
  const double t = segment.duration;
  system.first(FunctionKind::field, segment.index.field, segment.start.data(), par.data(), {}, f.data(), fx.data(),
               &no_parameters);
  const Watcher watcher(system, segment, par, scale);
  IntegralSum integrals(system, segment, par, scale);
  if (!integrals.is_empty()) integrals.add_point(segment.start, t);
  return {"",
          segment.start + t * f + 0.5 * t * t * (fx * f),
          MatrixXd::Identity(n, n) + t * fx,
          {},
          {},
          watcher.size(segment.index.event),
          integrals.values()};
}

Passage integrate(const HybridSystem& system, const StoredSegment& segment, const VectorXd& par, const VectorXd& scale,
                  const FlowOptions& options, double tolerance) {
  CvodesFlow flow(system, segment.index.field, segment.start, par, options);
  Watcher watcher(system, segment, par, scale);
  IntegralSum integrals(system, segment, par, scale);
  const bool is_forward = segment.duration > 0.0;
  if (is_forward) flow.watch(watcher.events());
  if (is_forward || !integrals.is_empty())
    flow.on_piece([&](double from, double to) {
      for (int k = 1; is_forward && k <= samples_of_a_step; ++k) {
        const double t = from + (to - from) * k / samples_of_a_step;
        watcher.look(flow.state_at(t), t);
      }
      if (!integrals.is_empty()) integrals.add([&flow](double t) { return flow.state_at(t); }, from, to);
      return true;
    });
  Progress progress = Progress::root;
  while (progress == Progress::root) {
    progress = flow.advance(segment.duration);
    if (progress == Progress::root) watcher.fall(flow.fallen(), flow.state(), flow.time());
  }
  if (progress == Progress::failed) return {flow.message(), {}, {}, {}, {}, 1.0, {}};
  return {"",
          flow.state(),
          flow.jacobian(),
          watcher.wrong(tolerance),
          watcher.passed(tolerance),
          watcher.size(segment.index.event),
          integrals.values()};
}

/// The terminal event next to the end of the segment, where the flow crosses the surface.
struct Crossing {
  double time = 0.0;
  VectorXd state;
  MatrixXd flow;  // d x(time) / d x_s(0) at fixed time
  EventAt at;
};

/// Of the duration: a crossing that lies farther from the end is another one.
constexpr double closest = level::located;

/// Nothing where there is none that close to the end.
std::optional<Crossing> crossing(const HybridSystem& system, const StoredSegment& segment, const VectorXd& par,
                                 const FlowOptions& options) {
  CvodesFlow flow(system, segment.index.field, segment.start, par, options);
  flow.watch({segment.index.event});
  while (flow.advance((1.0 + closest) * segment.duration) == Progress::root) {
    if (flow.time() < (1.0 - closest) * segment.duration) continue;
    const VectorXd x = flow.state();
    return Crossing{flow.time(), x, flow.jacobian(),
                    event_at(system, segment.index.event, segment.index.field, x.data(), par.data())};
  }
  return std::nullopt;
}

FlowOptions options_of_check(const VectorXd& scale) {
  FlowOptions options;
  options.set(level::reference_flow);
  options.sizes = scale;
  options.max_steps = 20000;
  return options;
}

/// Adams' method first; what is stiff for it goes to the other one.
Passage pass(const HybridSystem& system, const StoredSegment& segment, const VectorXd& par, const VectorXd& scale,
             double tolerance) {
  if (std::abs(segment.duration) < shortest_duration * std::abs(segment.period))
    return taylor(system, segment, par, scale);
  FlowOptions options = options_of_check(scale);
  Passage passage = integrate(system, segment, par, scale, options, tolerance);
  if (passage.message.empty()) return passage;
  options.method = IntegrationMethod::bdf;
  options.set(level::stiff_flow);
  options.max_steps = 1000000;
  return integrate(system, segment, par, scale, options, tolerance);
}

/// How errors grow, in the row sum norm of scaled states.
double growth_of(const MatrixXd& flow, const VectorXd& scale) {
  const MatrixXd scaled = scale.cwiseInverse().asDiagonal() * flow * scale.asDiagonal();
  return std::max(1.0, scaled.cwiseAbs().rowwise().sum().maxCoeff());
}

/// Beyond this growth a stored duration has too few digits to say where the segment ends.
constexpr double sensitive_to_time = 1e3;

/// A fast motion magnifies errors of time, as at a spike. Where it comes to the event says more, if that is sure.
void compare_at_event(const HybridSystem& system, const StoredSegment& segment, const VectorXd& par,
                      const VectorXd& scale, double size, SegmentCheck& check) {
  const std::optional<Crossing> met = crossing(system, segment, par, options_of_check(scale));
  if (!met) return;
  const double growth = growth_of(met->at.project(met->flow), scale);
  if (!(growth < check.growth)) return;
  check.end = met->state;
  check.flow = met->flow;
  check.growth = growth;
  check.state_defect = largest(met->at.project(met->state - segment.end), scale);
  check.time_defect = std::abs(met->time - segment.duration);
  // Nothing of what the flow meets from there on lies on the segment.
  const double end = met->time - closest * segment.duration;
  std::erase_if(check.wrong, [&](const EventMet& other) {
    return other.time > (other.event == segment.index.event ? end : met->time);
  });
  check.event_level = std::abs(system.event(segment.index.event, segment.end.data(), par.data())) / size;
}

}  // namespace

SegmentCheck check_segment(const HybridSystem& system, const StoredSegment& segment, const VectorXd& par,
                           const VectorXd& scale, double tolerance) {
  SegmentCheck check;
  Passage passage = pass(system, segment, par, scale, tolerance);
  check.message = passage.message;
  if (!check.message.empty()) return check;
  check.end = passage.end;
  check.flow = passage.flow;
  check.wrong = std::move(passage.wrong);
  check.passed = std::move(passage.passed);
  check.integrals = std::move(passage.integrals);
  check.growth = growth_of(check.flow, scale);
  check.state_defect = largest(check.end - segment.end, scale);
  if (segment.index.event == no_function) return check;
  const EventToSecondOrder at(system, segment.index.field, segment.index.event, check.end, par);
  check.event_level = std::abs(at.h) / passage.size;
  check.time_defect = segment.grazing ? at.time_to_contact() : at.time_to_zero();
  check.touches = !segment.grazing && at.touches(tolerance * passage.size);
  const EventToSecondOrder stored(system, segment.index.field, segment.index.event, segment.end, par);
  check.leaves_surface = !segment.grazing && stored.rate > tolerance * passage.size;
  if (!segment.grazing && check.growth > sensitive_to_time)
    compare_at_event(system, segment, par, scale, passage.size, check);
  return check;
}

}  // namespace tchat
