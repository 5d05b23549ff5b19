#include "motion/runge_kutta_flow.hpp"
#include "model/undefined_value.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/dense_output_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/util/odeint_error.hpp>
#include <cmath>
#include <optional>
#include <utility>

namespace tchat {

namespace {

namespace odeint = boost::numeric::odeint;
using Eigen::VectorXd;
using DopriState = std::vector<double>;
using DormandPrince = odeint::runge_kutta_dopri5<DopriState>;
using DenseDormandPrince = odeint::result_of::make_dense_output<DormandPrince>::type;

constexpr double no_value = 1e200;       // of a field that has none: the step is refused, and a smaller one tried
constexpr double smallest_step = 1e-13;  // relative to the time
constexpr double short_steps = 1e-7;     // a tolerance from which on one look a step for falls of events is enough

}  // namespace

struct RungeKuttaFlow::Implementation {
  const HybridSystem& system;
  int field;
  VectorXd par;
  FlowOptions options;
  DopriState start;
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
  DopriState dense, single_state;
  const DenseOutput output = [this](double t) { return dense_output(t); };
  std::optional<VectorXd> at_fall;  // the state at `time`, by a step of the method

  Implementation(const HybridSystem& s, int i, const VectorXd& x0, const VectorXd& p, const FlowOptions& o)
      : system(s),
        field(i),
        par(p),
        options(o),
        start(x0.begin(), x0.end()),
        stepper(odeint::make_dense_output(o.absolute_tolerance, o.relative_tolerance, DormandPrince())),
        dense(start),
        single_state(start) {}

  auto right_hand_side() {
    return [this](const DopriState& x, DopriState& dxdt, double) {
      system.value(FunctionKind::field, field, x.data(), par.data(), dxdt.data());
      if (all_finite(dxdt.data(), static_cast<int>(dxdt.size()))) return;
      remember_trouble(FunctionKind::field, field, x);
      std::fill(dxdt.begin(), dxdt.end(), no_value);
    };
  }

  /// Ignores stages that were computed from the substitute value no_value.
  void remember_trouble(FunctionKind kind, int index, const DopriState& x) {
    const bool is_reached =
        std::all_of(x.begin(), x.end(), [](double value) { return std::abs(value) < no_value / 2; });
    if (is_reached) not_evaluated = undefined_value(system, kind, index, x.data());
  }

  /// The first step is tried with a length that moves x by one part in a hundred; the error control does the rest.
  double first_step() {
    right_hand_side()(start, dense, 0.0);
    const Eigen::Map<const VectorXd> x(start.data(), static_cast<Eigen::Index>(start.size()));
    const Eigen::Map<const VectorXd> f(dense.data(), x.size());
    const double speed = f.norm();
    return speed > 0.0 ? 0.01 * std::max(x.norm(), 1e-3) / speed : 0.01;
  }

  double reached() const { return steps == 0 ? 0.0 : stepper.current_time(); }

  const double* dense_output(double t) {
    if (steps == 0) return start.data();
    stepper.calc_state(t, dense);
    return dense.data();
  }

  Progress fail(const std::string& why) {
    message = fmt::format("integration of {} failed at time {:.6g}: {}",
                          system.function_name(FunctionKind::field, field), reached(), why);
    return Progress::failed;
  }

  /// "" or why the integrator cannot go on.
  std::string step() {
    if (steps == 0) stepper.initialize(start, 0.0, first_step());
    not_evaluated.clear();
    try {
      stepper.do_step(right_hand_side());
    } catch (const odeint::odeint_error&) {
      return not_evaluated.empty() ? "the steps become too small" : not_evaluated;
    }
    if (++steps > options.max_steps)
      return fmt::format("more than {} steps; a stiff problem wants --stiff", options.max_steps);
    const double length = stepper.current_time() - stepper.previous_time();
    if (!(length > smallest_step * (1.0 + stepper.current_time())))
      return not_evaluated.empty() ? "the steps become too small" : not_evaluated;
    const DopriState& x = stepper.current_state();
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
    single.do_step(right_hand_side(), stepper.previous_state(), stepper.previous_time(), single_state,
                   t - stepper.previous_time());
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
  p_->watch.emplace(p_->system, p_->field, events, p_->par, p_->start.data(), p_->options.surface_tolerance, after);
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
