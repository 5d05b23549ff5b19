/// Flows x' = f_i(x, p) with events: options of integration, event functions between steps, and the explicit Runge-
/// Kutta pair. cvodes_flow.hpp has the other integrator.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/levels.hpp"
#include "model/hybrid_system.hpp"

namespace tchat {

// Settings of forward integration.

enum class IntegrationMethod {
  adams,        ///< order up to 12; for problems that are not stiff, and for the highest accuracy
  bdf,          ///< order up to 5; for stiff problems
  runge_kutta,  ///< order 5; for many short flows of problems that are not stiff; no variational equations
};

struct FlowOptions {
  IntegrationMethod method = IntegrationMethod::adams;
  /// Problems with large derivatives may fail to converge and want level::relaxed_flow. CVODES refuses less than 2e-16.
  double relative_tolerance = level::finest_flow.relative;
  double absolute_tolerance = level::finest_flow.absolute;
  double max_duration = 1e3;                ///< give up waiting for an event after this time
  long max_steps = 100000;                  ///< of the integrator, for one segment
  double surface_tolerance = level::orbit;  ///< |h| below this share of its scale: the start is on the event surface
  Eigen::VectorXd sizes = {};               ///< of the states, n; none: 1 (surface_scale())
  bool variational = true;                  ///< integrate the flow Jacobian along
  std::vector<int> active;  ///< PAR indices, from 1, by which derivatives are wanted (needs `variational`)

  void set(const level::Tolerances& tolerances) {
    relative_tolerance = tolerances.relative;
    absolute_tolerance = tolerances.absolute;
  }
};

// The event functions h_j watched along one flow, looked at from one integration step to the next: does one of them
// fall through zero, and where does one come near zero without reaching it?
//
// Only an *armed* event can fall, one whose h has been positive. At the start: h > tolerance is armed; a start on the
// surface (|h| within tolerance, as after an impact or on a section) that leaves upwards is armed as soon as h > 0;
// one that leaves downwards, a start below zero, and a start just after the event, when h has risen again. The start
// itself never counts.
//
// h_P = h_x f tells where h is least between two looks (2.57-2.60), so that a pair of crossings inside one step is
// found; a least value that is not below zero is a contact. Where h changes faster than the states, as one of a clock
// does, and the time between two looks is too long for it, there are more looks in between.

/// x(t) inside the last integration step; valid until the next call.
using DenseOutput = std::function<const double*(double t)>;

class EventWatch {
 public:
  /// A local minimum of h that does not reach zero.
  struct Contact {
    int event = 0;
    double time = 0.0;
    double h = 0.0;
    Eigen::VectorXd state;
  };
  struct Fall {
    int event = 0;
    double time = 0.0;
  };

  /// A view of `system` and `par`, which outlive this object. |h| up to options.surface_tolerance times its scale is on
  /// the surface at the start x0 (time 0); of the events `after`, which have just happened, the start is on the surface
  /// whatever h.
  EventWatch(const HybridSystem& system, int field, const std::vector<int>& events, const Eigen::VectorXd& par,
             const double* x0, const FlowOptions& options, const std::vector<int>& after = {});

  int count() const { return static_cast<int>(events_.size()); }
  /// h_j and then h_x f of every event: 2 count() values, falling and rising through zero at what is looked for. False
  /// when an h cannot be evaluated.
  bool roots(const double* x, double* out) const;

  /// Looks at the flow from the time last looked at to `time`; the first fall, if there is one, is where the next look
  /// begins. `is_root`, if not null, tells which of roots() the integrator has located at `time`.
  std::optional<Fall> look(double time, const DenseOutput& state, const int* is_root);

  /// Contacts seen since the last call.
  std::vector<Contact> take_contacts();
  bool is_armed(int event) const;
  /// h_j, and its rate h_x f: 0 where it cannot be evaluated.
  double value(int event, const double* x) const { return system_.event(event, x, par_.data()); }
  double rate(int event, const double* x) const;

 private:
  /// h_j and its rate h_x f, 0 where it cannot be evaluated.
  struct Value {
    double h = 0.0, rate = 0.0;
  };
  void set_field(const double* x) const;
  Value on_field(int event, const double* x) const;  // the field has been set
  Value at(int event, const double* x) const;
  double scale(int event, const double* x) const;
  double rate_scale(int event, const double* x) const;  // and of its rate

  enum class Readiness { below, leaving_upwards, armed };
  struct Watched {
    int event;
    Readiness readiness;
    double h, rate;    // at the time last looked at
    double tolerance;  // |h| up to this share of its scale has not risen
    double at_rest;    // nor while its rate is below this: where it starts at rest on its surface both are rounding
  };

  /// When this event falls in (time_, end], where its h and rate are now those given; updates its readiness.
  std::optional<double> fall(Watched& watched, double end, double h, double rate, bool is_minimum,
                             const DenseOutput& state);
  bool is_resolved(double time, const DenseOutput& state) const;
  double resolved_until(double time, const DenseOutput& state);
  std::optional<Fall> look_until(double time, const DenseOutput& state, const int* is_root);
  void look_again_from(double time, const DenseOutput& state);

  const HybridSystem& system_;
  int field_;
  const Eigen::VectorXd& par_;
  Eigen::VectorXd sizes_;
  double time_ = 0.0;
  double resolved_ = 0.0;  // length of the longest look that was short enough
  std::vector<Watched> events_;
  // What is looked at at every step is kept here.
  std::vector<Watched> before_;
  std::vector<double> now_;
  mutable Eigen::VectorXd f_, h_x_, along_;  // the last: x, f and zeros for HybridSystem::third; empty if not used
  std::vector<Contact> contacts_;
};

// One initial value problem x' = f_i(x, p), x(0) = x0, whose event functions are watched: what a hybrid simulation
// asks of an integrator.

enum class Progress { root, end_time, stopped, failed };

class WatchedFlow {
 public:
  WatchedFlow() = default;
  WatchedFlow(const WatchedFlow&) = delete;
  WatchedFlow& operator=(const WatchedFlow&) = delete;
  virtual ~WatchedFlow() = default;

  /// Stop where one of these event functions falls through zero (EventWatch says what counts). Once, before the
  /// first advance(). The flow begins just after the events `after`.
  virtual void watch(const std::vector<int>& events, const std::vector<int>& after) = 0;
  void watch(const std::vector<int>& events) { watch(events, {}); }
  /// Called for every piece of the flow that has been passed, from one time to the next; state_at() is valid in it.
  /// False stops the flow (Progress::stopped).
  virtual void on_piece(std::function<bool(double from, double to)> observer) = 0;
  /// Integrates on to `end_time` exactly, or to the next fall.
  virtual Progress advance(double end_time) = 0;

  /// Which event function fell at the last Progress::root.
  virtual int fallen() const = 0;
  /// Least values of watched functions that did not reach zero, since the last call.
  virtual std::vector<EventWatch::Contact> take_contacts() = 0;
  /// Has h_j been positive, so that it can fall?
  virtual bool is_armed(int event) const = 0;
  /// x(t) on the piece passed last.
  virtual Eigen::VectorXd state_at(double t) const = 0;
  /// The same without a copy, as long as this object lives.
  virtual const DenseOutput& dense_output() const = 0;

  virtual double time() const = 0;
  virtual Eigen::VectorXd state() const = 0;
  /// Why advance() failed.
  virtual const std::string& message() const = 0;
};

/// By the method that `options` name. A view of `system`, which outlives the flow; `par` has the room of the problem's
/// ParameterLayout.
std::unique_ptr<WatchedFlow> make_flow(const HybridSystem& system, int field, const Eigen::VectorXd& x0,
                                       const Eigen::VectorXd& par, const FlowOptions& options);

// A watched flow by the explicit Runge-Kutta pair of Dormand and Prince, order 5(4), with dense output between its
// steps. For many short flows of problems that are not stiff, such as a sweep's: ten times cheaper than a multistep
// method, which begins anew with small steps after each event.
//
// Events are found on the dense output, whose error is larger than the steps' own; the state there is a step of the
// method itself, to the time where Newton's method on such steps finds h = 0.

class RungeKuttaFlow final : public WatchedFlow {
 public:
  /// The tolerances and limits of `options`; no variational equations.
  RungeKuttaFlow(const HybridSystem& system, int field, const Eigen::VectorXd& x0, const Eigen::VectorXd& par,
                 const FlowOptions& options);
  RungeKuttaFlow(const RungeKuttaFlow&) = delete;
  RungeKuttaFlow& operator=(const RungeKuttaFlow&) = delete;
  ~RungeKuttaFlow() override;

  using WatchedFlow::watch;
  void watch(const std::vector<int>& events, const std::vector<int>& after) override;
  void on_piece(std::function<bool(double from, double to)> observer) override;
  Progress advance(double end_time) override;
  int fallen() const override;
  std::vector<EventWatch::Contact> take_contacts() override;
  bool is_armed(int event) const override;
  Eigen::VectorXd state_at(double t) const override;
  const DenseOutput& dense_output() const override;
  double time() const override;
  Eigen::VectorXd state() const override;
  const std::string& message() const override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> p_;
};

}  // namespace tchat
