#include "motion/watched_flow.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/dense_output_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/util/odeint_error.hpp>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/levels.hpp"
#include "model/events.hpp"
#include "model/function_values.hpp"
#include "model/scales.hpp"
#include "motion/cvodes_flow.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;

/// Between a, where f > 0, and b, where it is not: the first time after which it is not.
double last_change(double a, double b, const std::function<double(double)>& f) {
  const double f_a = f(a);
  const double f_b = f(b);
  if (f_a > 0.0 && f_b < 0.0 && std::isfinite(f_a) && std::isfinite(f_b)) {
    std::uintmax_t evaluations = 60;
    const boost::math::tools::eps_tolerance<double> tolerance(52);
    return boost::math::tools::toms748_solve(f, a, b, f_a, f_b, tolerance, evaluations).second;
  }
  for (int halving = 0; halving < 60 && a < b; ++halving) {
    const double middle = 0.5 * (a + b);
    (f(middle) > 0.0 ? a : b) = middle;
  }
  return b;
}

/// So many derivatives by states are had at once: of more states the rate h_x f is had without the gradient.
constexpr int states_of_a_pass = 8;

}  // namespace

EventWatch::EventWatch(const HybridSystem& system, int field, const std::vector<int>& events, const VectorXd& par,
                       const double* x0, const FlowOptions& options, const std::vector<int>& after)
    : system_(system), field_(field), par_(par), sizes_(options.sizes), f_(system.dimension()), h_x_(f_.size()) {
  if (system.has_third() && system.dimension() > states_of_a_pass) along_.setZero(8 * f_.size());
  const double tolerance = options.surface_tolerance;
  for (const int event : events) {
    const Value start = at(event, x0);
    const double start_scale = scale(event, x0);
    const bool is_after = std::find(after.begin(), after.end(), event) != after.end();
    const bool is_near = std::abs(start.h) <= tolerance * start_scale;
    const double around = is_after && !is_near ? std::abs(start.h) / start_scale : tolerance;
    const bool on_surface = is_after || is_near;
    const double rate_scale = on_surface ? this->rate_scale(event, x0) : 0.0;
    const bool is_at_rest = std::abs(start.rate) <= level::rounding_of_sums * rate_scale;
    Readiness readiness = start.h > 0.0 ? Readiness::armed : Readiness::below;
    if (on_surface) readiness = start.rate > 0.0 && !is_at_rest ? Readiness::leaving_upwards : Readiness::below;
    events_.push_back({event, readiness, start.h, start.rate, around, is_at_rest ? level::located * rate_scale : 0.0});
  }
}

double EventWatch::rate_scale(int event, const double* x) const {
  const bool has_sizes = sizes_.size() > 0;
  return event_at(system_, event, field_, x, par_.data()).rate_scale(has_sizes ? sizes_ : VectorXd::Ones(f_.size()));
}

void EventWatch::set_field(const double* x) const {
  system_.value(FunctionKind::field, field_, x, par_.data(), f_.data());
}

EventWatch::Value EventWatch::on_field(int event, const double* x) const {
  Value value;
  double rate = 0.0;
  if (along_.size() > 0) {
    along_.head(f_.size()) = Eigen::Map<const VectorXd>(x, f_.size());
    along_.segment(f_.size(), f_.size()) = f_;
    std::array<double, 8> coefficients;
    system_.third(FunctionKind::event, event, along_.data(), par_.data(), coefficients.data());
    value.h = coefficients[0];
    rate = coefficients[1];
  } else {
    system_.first(FunctionKind::event, event, x, par_.data(), {}, &value.h, h_x_.data(), nullptr);
    rate = h_x_.dot(f_);
  }
  value.rate = std::isfinite(rate) ? rate : 0.0;
  return value;
}

EventWatch::Value EventWatch::at(int event, const double* x) const {
  set_field(x);
  return on_field(event, x);
}

double EventWatch::scale(int event, const double* x) const {
  double h = 0.0;
  system_.first(FunctionKind::event, event, x, par_.data(), {}, &h, h_x_.data(), nullptr);
  const double scale = surface_scale(h_x_, x, sizes_);
  return scale > 0.0 ? scale : 1.0;  // no gradient: a problem that does not give the one it says it has
}

bool EventWatch::roots(const double* x, double* out) const {
  set_field(x);
  for (int i = 0; i < count(); ++i) {
    const Value now = on_field(events_[static_cast<std::size_t>(i)].event, x);
    out[i] = now.h;
    out[count() + i] = now.rate;
  }
  return all_finite(out, count());
}

double EventWatch::rate(int event, const double* x) const { return at(event, x).rate; }

bool EventWatch::is_armed(int event) const {
  return std::any_of(events_.begin(), events_.end(), [&](const Watched& watched) {
    return watched.event == event && watched.readiness == Readiness::armed;
  });
}

std::vector<EventWatch::Contact> EventWatch::take_contacts() { return std::exchange(contacts_, {}); }

std::optional<double> EventWatch::fall(Watched& watched, double end, double h, double rate, bool is_minimum,
                                       const DenseOutput& state) {
  const int event = watched.event;
  const auto h_at = [&](double t) { return value(event, state(t)); };
  if (watched.readiness == Readiness::armed) {
    if (h <= 0.0) return last_change(time_, end, h_at);
    if (!is_minimum && !(watched.rate < 0.0 && rate > 0.0)) return std::nullopt;
    const auto falls = [&](double t) { return -this->rate(event, state(t)); };
    const double least = is_minimum ? end : last_change(time_, end, falls);
    const double h_least = value(event, state(least));
    if (h_least < 0.0) return last_change(time_, least, h_at);
    contacts_.push_back({event, least, h_least, Eigen::Map<const VectorXd>(state(least), system_.dimension())});
    return std::nullopt;
  }
  // Below zero or just leaving it: a maximum between the two times may have been above.
  if (watched.rate > 0.0 && rate < 0.0 && h <= 0.0) {
    const double top = last_change(time_, end, [&](double t) { return this->rate(event, state(t)); });
    const double least_top = watched.at_rest > 0.0 ? watched.tolerance * scale(event, state(top)) : 0.0;
    const bool is_above = h_at(top) > least_top;
    if (is_above) return last_change(top, end, h_at);
    if (watched.readiness == Readiness::leaving_upwards) return top;  // a flight as short as rounding
  }
  if (!(h > 0.0)) return std::nullopt;
  const bool has_risen = watched.readiness == Readiness::leaving_upwards || rate > watched.at_rest ||
                         h > watched.tolerance * scale(event, state(end));
  if (has_risen) watched.readiness = Readiness::armed;
  return std::nullopt;
}

/// Steps of an integration follow the states, and an event function may change faster: h at two places inside is
/// compared with the cubic that has h and h_x f at both ends. In the middle alone a wave about it would agree.
bool EventWatch::is_resolved(double time, const DenseOutput& state) const {
  constexpr double alike = 0.01;
  const double length = time - time_;
  for (const double s : {0.3, 0.7}) {
    const double rest = 1.0 - s;
    const double* const inside = state(time_ + s * length);
    for (std::size_t i = 0; i < events_.size(); ++i) {
      const Watched& watched = events_[i];
      const double h = now_[i], rate = now_[events_.size() + i];
      const double expected = rest * rest * ((1.0 + 2.0 * s) * watched.h + s * length * watched.rate) +
                              s * s * ((1.0 + 2.0 * rest) * h - rest * length * rate);
      const double found = value(watched.event, inside);
      const double largest = std::max({std::abs(watched.h), std::abs(h), std::abs(found)});
      if (!std::isfinite(found) || std::abs(found - expected) <= alike * largest) continue;
      if (!(largest <= watched.tolerance * scale(watched.event, inside))) return false;
    }
  }
  return true;
}

/// Up to where no event function changes faster than it is looked at; now_ holds what they are there. By chance a long
/// time may seem to be resolved that is none, so looks become longer by and by. What no look resolves is noise.
double EventWatch::resolved_until(double time, const DenseOutput& state) {
  constexpr int most_halvings = 16;
  constexpr double longer = 4.0;
  if (resolved_ > 0.0) time = std::min(time, time_ + longer * resolved_);
  now_.resize(2 * events_.size());
  double until = time;
  for (int halving = 0; halving <= most_halvings; ++halving, until = time_ + 0.5 * (until - time_)) {
    roots(state(until), now_.data());
    if (!is_resolved(until, state)) continue;
    resolved_ = halving > 0 ? until - time_ : std::max(resolved_, until - time_);
    return until;
  }
  resolved_ = 0.0;
  roots(state(time), now_.data());
  return time;
}

std::optional<EventWatch::Fall> EventWatch::look(double time, const DenseOutput& state, const int* is_root) {
  while (true) {
    const double until = resolved_until(time, state);
    const std::optional<Fall> fall = look_until(until, state, until == time ? is_root : nullptr);
    if (fall || until == time) return fall;
  }
}

/// now_ holds what event functions are at this time.
std::optional<EventWatch::Fall> EventWatch::look_until(double time, const DenseOutput& state, const int* is_root) {
  before_ = events_;
  std::optional<Fall> first;
  for (std::size_t i = 0; i < events_.size(); ++i) {
    Watched& watched = events_[i];
    const bool is_fall = is_root != nullptr && is_root[i] != 0 && watched.readiness == Readiness::armed;
    const bool is_minimum = is_root != nullptr && is_root[events_.size() + i] != 0;
    const double rate = is_minimum ? std::max(now_[events_.size() + i], 0.0) : now_[events_.size() + i];
    const std::optional<double> at =
        is_fall && now_[i] > 0.0 ? time : fall(watched, time, now_[i], rate, is_minimum, state);
    if (at && (!first || *at < first->time)) first = Fall{watched.event, *at};
    watched.h = now_[i];
    watched.rate = rate;
  }
  time_ = time;
  if (!first) return first;
  events_ = before_;  // what came after the fall is looked at again
  look_again_from(first->time, state);
  for (Watched& watched : events_)
    if (watched.event == first->event) watched.readiness = Readiness::below;
  return first;
}

void EventWatch::look_again_from(double time, const DenseOutput& state) {
  time_ = time;
  std::erase_if(contacts_, [&](const Contact& contact) { return contact.time > time; });
  const VectorXd x = Eigen::Map<const VectorXd>(state(time), system_.dimension());
  for (Watched& watched : events_) {
    const Value now = at(watched.event, x.data());
    watched.h = now.h;
    watched.rate = now.rate;
  }
}

std::unique_ptr<WatchedFlow> make_flow(const HybridSystem& system, int field, const Eigen::VectorXd& x0,
                                       const Eigen::VectorXd& par, const FlowOptions& options) {
  if (options.method == IntegrationMethod::runge_kutta)
    return std::make_unique<RungeKuttaFlow>(system, field, x0, par, options);
  return std::make_unique<CvodesFlow>(system, field, x0, par, options);
}

namespace {

namespace odeint = boost::numeric::odeint;
using DopriState = std::vector<double>;
using DormandPrince = odeint::runge_kutta_dopri5<DopriState>;
using DenseDormandPrince = odeint::result_of::make_dense_output<DormandPrince>::type;

constexpr double no_value = 1e200;  // of a field that has none: the step is refused, and a smaller one tried
constexpr double smallest_step = level::rounding_of_sums;  // relative to the time
/// A tolerance from which on one look a step for falls of events is enough.
constexpr double short_steps = level::tolerance;

}  // namespace

struct RungeKuttaFlow::Implementation {
  const HybridSystem& system;
  int field;
  VectorXd par;
  FlowOptions options;
  bool has_units;
  VectorXd units;    // powers of two next to the sizes of states, in which the stepper has them
  DopriState start;  // the states of the problem
  DenseDormandPrince stepper;
  DormandPrince single;  // for the last step to an event
  std::optional<EventWatch> watch;
  std::vector<int> events;
  std::function<bool(double, double)> observer;
  std::string message;
  std::string not_evaluated;
  double time = 0.0;    // of the flow as callers see it
  double looked = 0.0;  // up to here the watch has looked
  long steps = 0;
  int fallen = 0;
  DopriState dense, scaled, single_state, at = start;
  const DenseOutput output = [this](double t) { return dense_output(t); };
  std::optional<VectorXd> at_fall;  // the state at `time`, by a step of the method

  Implementation(const HybridSystem& s, int i, const VectorXd& x0, const VectorXd& p, const FlowOptions& o)
      : system(s),
        field(i),
        par(p),
        options(o),
        has_units(!are_usual(o.sizes)),
        units(has_units ? units_of(o.sizes) : VectorXd(VectorXd::Ones(x0.size()))),
        start(x0.begin(), x0.end()),
        stepper(odeint::make_dense_output(o.absolute_tolerance, o.relative_tolerance, DormandPrince())),
        dense(start),
        scaled(start),
        single_state(start) {}

  const DopriState& multiply(const DopriState& x, DopriState& result) const {
    result = x;
    if (has_units)
      for (std::size_t i = 0; i < x.size(); ++i) result[i] *= units(static_cast<Eigen::Index>(i));
    return result;
  }
  /// What the stepper has as states of the problem: `y` itself where they have no units, else in `room`.
  const DopriState& in_states(const DopriState& y, DopriState& room) const { return has_units ? multiply(y, room) : y; }
  void divide(DopriState& x) const {
    if (!has_units) return;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] /= units(static_cast<Eigen::Index>(i));
  }

  auto right_hand_side() {
    return [this](const DopriState& y, DopriState& dydt, double) {
      const DopriState& x = in_states(y, at);
      system.value(FunctionKind::field, field, x.data(), par.data(), dydt.data());
      if (all_finite(dydt.data(), static_cast<int>(dydt.size()))) return divide(dydt);
      multiply(y, at);
      remember_trouble(FunctionKind::field, field, y);
      std::fill(dydt.begin(), dydt.end(), no_value);
    };
  }

  /// Ignores stages that were computed from the substitute value no_value.
  void remember_trouble(FunctionKind kind, int index, const DopriState& y) {
    const bool is_reached =
        std::all_of(y.begin(), y.end(), [](double value) { return std::abs(value) < no_value / 2; });
    if (is_reached) not_evaluated = undefined_value(system, kind, index, at.data());
  }

  /// The first step is tried with a length that moves x by one part in a hundred; the error control does the rest.
  double first_step() {
    right_hand_side()(scaled, dense, 0.0);
    const Eigen::Map<const VectorXd> y(scaled.data(), static_cast<Eigen::Index>(scaled.size()));
    const Eigen::Map<const VectorXd> f(dense.data(), y.size());
    if (are_usual(options.sizes)) {
      const double speed = f.norm();
      return speed > 0.0 ? 0.01 * std::max(y.norm(), 1e-3) / speed : 0.01;
    }
    const double fastest = f.cwiseAbs().maxCoeff();  // in sizes a unit of time
    return fastest > 0.0 ? 0.01 / fastest : 0.01;
  }

  double reached() const { return steps == 0 ? 0.0 : stepper.current_time(); }

  const double* dense_output(double t) {
    if (steps == 0) return start.data();
    if (t == stepper.current_time()) return in_states(stepper.current_state(), dense).data();
    stepper.calc_state(t, scaled);
    return in_states(scaled, dense).data();
  }

  Progress fail(const std::string& why) {
    message = fmt::format("integration of {} failed at time {:.6g}: {}",
                          system.function_name(FunctionKind::field, field), reached(), why);
    return Progress::failed;
  }

  /// "" or why the integrator cannot go on.
  std::string step() {
    if (steps == 0) {
      scaled = start;
      divide(scaled);
      stepper.initialize(scaled, 0.0, first_step());
    }
    not_evaluated.clear();
    try {
      stepper.do_step(right_hand_side());
    } catch (const odeint::odeint_error&) {
      return not_evaluated.empty() ? "the steps become too small" : not_evaluated;
    }
    if (++steps > options.max_steps)
      return fmt::format("more than {} steps; a stiff problem wants --stiff", options.max_steps);
    const double length = stepper.current_time() - stepper.previous_time();
    if (!(length > smallest_step * stepper.current_time()))
      return not_evaluated.empty() ? "the steps become too small" : not_evaluated;
    const DopriState& x = in_states(stepper.current_state(), at);
    if (!all_finite(x.data(), static_cast<int>(x.size()))) return "the state is not finite";
    return unevaluated_event(x);
  }

  std::string unevaluated_event(const DopriState& x) {
    for (const int event : events) {
      const double h = watch->value(event, x.data());
      if (all_finite(&h, 1)) continue;
      return undefined_value(system, FunctionKind::event, event, x.data());
    }
    return "";
  }

  /// Looks for falls from where it has looked up to `until`, in the last step.
  bool look(double until) {
    at_fall.reset();
    if (!watch) {
      time = looked = until;
      return false;
    }
    const double from = looked;
    const int looks_a_step = options.relative_tolerance <= short_steps ? 1 : 3;
    for (int k = 1; k <= looks_a_step; ++k) {
      looked = k == looks_a_step ? until : from + (until - from) * k / looks_a_step;
      const std::optional<EventWatch::Fall> fall = watch->look(looked, output, nullptr);
      if (!fall) continue;
      fallen = fall->event;
      time = looked = fall->time;
      polish_fall();
      return true;
    }
    time = until;
    return false;
  }

  /// x(t) by one step of the method from the last one's start.
  const double* step_to(double t) {
    single.reset();  // it takes the field at its last step's end for that at this one's start
    single.do_step(right_hand_side(), stepper.previous_state(), stepper.previous_time(), scaled,
                   t - stepper.previous_time());
    multiply(scaled, single_state);
    return single_state.data();
  }

  /// Newton's method for h = 0; where it goes astray the dense output's zero is the event.
  void polish_fall() {
    const double length = stepper.current_time() - stepper.previous_time();
    double polished = time;
    double h = watch->value(fallen, step_to(polished));
    VectorXd state = Eigen::Map<const VectorXd>(single_state.data(), static_cast<Eigen::Index>(start.size()));
    for (int iteration = 0; iteration < 4 && h != 0.0; ++iteration) {
      const double moved = polished - h / watch->rate(fallen, state.data());
      if (!(std::abs(moved - time) <= 1e-3 * length)) break;
      const double h_moved = watch->value(fallen, step_to(moved));
      if (!(std::abs(h_moved) < std::abs(h))) break;
      polished = moved;
      h = h_moved;
      state = Eigen::Map<const VectorXd>(single_state.data(), state.size());
    }
    at_fall = state;
    time = std::clamp(polished, stepper.previous_time(), stepper.current_time());
  }

  Progress advance(double end_time) {
    while (time < end_time) {
      const double from = time;
      if (looked >= reached())
        if (const std::string why = step(); !why.empty()) return fail(why);
      const bool has_fallen = look(std::min(reached(), end_time));
      const bool goes_on = !observer || observer(std::min(from, time), time);
      if (has_fallen) return Progress::root;
      if (!goes_on) return Progress::stopped;
    }
    return Progress::end_time;
  }

  VectorXd copy(const double* x) const { return Eigen::Map<const VectorXd>(x, system.dimension()); }
};

RungeKuttaFlow::RungeKuttaFlow(const HybridSystem& system, int field, const VectorXd& x0, const VectorXd& par,
                               const FlowOptions& options)
    : p_(std::make_unique<Implementation>(system, field, x0, par, options)) {}

RungeKuttaFlow::~RungeKuttaFlow() = default;

void RungeKuttaFlow::watch(const std::vector<int>& events, const std::vector<int>& after) {
  p_->events = events;
  p_->watch.emplace(p_->system, p_->field, events, p_->par, p_->start.data(), p_->options, after);
}

void RungeKuttaFlow::on_piece(std::function<bool(double, double)> observer) { p_->observer = std::move(observer); }

Progress RungeKuttaFlow::advance(double end_time) { return p_->advance(end_time); }

int RungeKuttaFlow::fallen() const { return p_->fallen; }

std::vector<EventWatch::Contact> RungeKuttaFlow::take_contacts() {
  return p_->watch ? p_->watch->take_contacts() : std::vector<EventWatch::Contact>{};
}

bool RungeKuttaFlow::is_armed(int event) const { return p_->watch && p_->watch->is_armed(event); }

VectorXd RungeKuttaFlow::state_at(double t) const {
  if (p_->at_fall && t == p_->time) return *p_->at_fall;
  return p_->copy(p_->dense_output(t));
}

const DenseOutput& RungeKuttaFlow::dense_output() const { return p_->output; }

double RungeKuttaFlow::time() const { return p_->time; }

VectorXd RungeKuttaFlow::state() const { return state_at(p_->time); }

const std::string& RungeKuttaFlow::message() const { return p_->message; }

}  // namespace tchat
