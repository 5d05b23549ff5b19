/// One initial value problem x' = f_i(x, p), x(0) = x0, whose event functions are watched: what a hybrid simulation
/// asks of an integrator.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "motion/event_watch.hpp"
#include "motion/flow_options.hpp"

namespace tchat {

enum class Progress { root, end_time, stopped, failed };

class WatchedFlow {
 public:
  WatchedFlow() = default;
  WatchedFlow(const WatchedFlow&) = delete;
  WatchedFlow& operator=(const WatchedFlow&) = delete;
  virtual ~WatchedFlow() = default;

  /// Stop where one of these event functions falls through zero (event_watch.hpp says what counts). Once, before the
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

}  // namespace tchat
