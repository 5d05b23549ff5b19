#include "verification/segment_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "hybrid/event_at.hpp"
#include "simulation/cvodes_flow.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// A duration below this share of the period needs no integrator: two terms of the Taylor series are exact to rounding.
constexpr double shortest_duration = 1e-7;
constexpr int samples_of_a_step = 8;

/// h and its derivatives along the flow of a field, at one state.
struct EventToSecondOrder {
  double h = 0.0;
  double rate = 0.0;          // h_x f
  double acceleration = 0.0;  // d (h_x f) / dt = f' h_xx f + h_x f_x f
  double size = 1.0;          // sum |h_x| scale: what a change of all states by their scales makes of h

  EventToSecondOrder(const HybridSystem& system, int field, int event, const VectorXd& x, const VectorXd& par,
                     const VectorXd& scale) {
    const EventAt at = event_at(system, event, field, x.data(), par.data());
    h = at.h;
    rate = at.rate();
    acceleration = rate_gradient(system, at, event, field, x.data(), par.data()).dot(at.f);
    size = at.gradient.cwiseAbs().dot(scale);
    if (!(size > 0.0)) size = 1.0;
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
};

double largest(const VectorXd& difference, const VectorXd& scale) {
  return difference.cwiseAbs().cwiseQuotient(scale).maxCoeff();
}

/// The events of one segment while the flow passes: which fell when, and how far below zero each has gone since.
class Watcher {
 public:
  Watcher(const HybridSystem& system, const StoredSegment& segment, const VectorXd& par, const VectorXd& scale)
      : system_(system), segment_(segment), par_(par), scale_(scale) {
    for (const int event : segment.monitored) depths_[event] = {event, 0.0, 0.0};
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
    for (auto& [event, met] : depths_) {
      if (met.depth == 0.0 && fallen_.count(event) == 0) met.time = time;
      deepen(met, x);
    }
    for (EventMet& met : passed_) deepen(met, x);
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
    if (!(h < 0.0)) return;
    met.depth =
        std::max(met.depth, -h / EventToSecondOrder(system_, segment_.index.field, met.event, x, par_, scale_).size);
  }

  static std::vector<EventMet> deep_ones(std::vector<EventMet> all, double tolerance) {
    std::erase_if(all, [&](const EventMet& met) { return met.depth <= tolerance; });
    std::sort(all.begin(), all.end(), [](const EventMet& a, const EventMet& b) { return a.time < b.time; });
    return all;
  }

  /// Would the state and the field after the event be those before it?
  bool changes_nothing(int event, const VectorXd& x) const {
    const auto is_neutral = [&](int jump) {
      VectorXd after(x.size());
      system_.value(FunctionKind::jump, jump, x.data(), par_.data(), after.data());
      return all_finite(after.data(), static_cast<int>(after.size())) && largest(after - x, scale_) < 1e-9;
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
  std::map<int, EventMet> depths_;  // of events that matter: monitored ones, and those that have fallen
  std::set<int> fallen_;
  std::vector<EventMet> passed_;
};

struct Passage {
  std::string message;
  VectorXd end;
  MatrixXd flow;
  std::vector<EventMet> wrong, passed;
};

Passage taylor(const HybridSystem& system, const StoredSegment& segment, const VectorXd& par) {
  const int n = system.dimension();
  VectorXd f(n);
  MatrixXd fx(n, n);
  double no_parameters = 0.0;
  const double t = segment.duration;
  system.first(FunctionKind::field, segment.index.field, segment.start.data(), par.data(), {}, f.data(), fx.data(),
               &no_parameters);
  return {"", segment.start + t * f + 0.5 * t * t * (fx * f), MatrixXd::Identity(n, n) + t * fx, {}, {}};
}

Passage integrate(const HybridSystem& system, const StoredSegment& segment, const VectorXd& par, const VectorXd& scale,
                  const FlowOptions& options, double tolerance) {
  CvodesFlow flow(system, segment.index.field, segment.start, par, options);
  Watcher watcher(system, segment, par, scale);
  if (segment.duration > 0.0) {
    flow.watch(watcher.events());
    flow.on_piece([&](double from, double to) {
      for (int k = 1; k <= samples_of_a_step; ++k) {
        const double t = from + (to - from) * k / samples_of_a_step;
        watcher.look(flow.state_at(t), t);
      }
      return true;
    });
  }
  Progress progress = Progress::root;
  while (progress == Progress::root) {
    progress = flow.advance(segment.duration);
    if (progress == Progress::root) watcher.fall(flow.fallen(), flow.state(), flow.time());
  }
  if (progress == Progress::failed) return {flow.message(), {}, {}, {}, {}};
  return {"", flow.state(), flow.jacobian(), watcher.wrong(tolerance), watcher.passed(tolerance)};
}

/// Adams' method first; what is stiff for it goes to the other one.
Passage pass(const HybridSystem& system, const StoredSegment& segment, const VectorXd& par, const VectorXd& scale,
             double tolerance) {
  if (std::abs(segment.duration) < shortest_duration * std::abs(segment.period)) return taylor(system, segment, par);
  FlowOptions options;
  options.relative_tolerance = 1e-13;
  options.absolute_tolerance = 1e-15 * std::min(1.0, scale.minCoeff());
  options.max_steps = 20000;
  Passage passage = integrate(system, segment, par, scale, options, tolerance);
  if (passage.message.empty()) return passage;
  options.method = IntegrationMethod::bdf;
  options.relative_tolerance = 1e-11;
  options.absolute_tolerance *= 100.0;
  options.max_steps = 1000000;
  return integrate(system, segment, par, scale, options, tolerance);
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
  const MatrixXd scaled = scale.cwiseInverse().asDiagonal() * check.flow * scale.asDiagonal();
  check.growth = std::max(1.0, scaled.cwiseAbs().rowwise().sum().maxCoeff());
  check.state_defect = largest(check.end - segment.end, scale);
  if (segment.index.event == no_function) return check;
  const EventToSecondOrder at(system, segment.index.field, segment.index.event, check.end, par, scale);
  check.event_level = std::abs(at.h) / at.size;
  check.time_defect = segment.grazing ? at.time_to_contact() : at.time_to_zero();
  const EventToSecondOrder stored(system, segment.index.field, segment.index.event, segment.end, par, scale);
  check.leaves_surface = !segment.grazing && stored.rate > tolerance * std::abs(stored.size);
  return check;
}

}  // namespace tchat
