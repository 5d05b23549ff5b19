/// One initial value problem x' = f_i(x, p), x(0) = x0, integrated by CVODES with root finding on event functions.
///
/// With it, if wanted, the variational equations Phi' = f_x Phi, Phi(0) = Id, and X' = f_x X + f_p, X(0) = 0, as
/// forward sensitivities under the same error control. The integrator's linear systems are dense, n x n.
/// Trouble of the integrator is a value (Progress::failed, message()), never an exception.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hybrid/hybrid_system.hpp"
#include "simulation/event_watch.hpp"
#include "simulation/flow_options.hpp"

namespace tchat {

enum class Progress { root, end_time, stopped, failed };

class CvodesFlow {
 public:
  /// `par` has parameter_length entries. A view of `system`, which outlives this object.
  CvodesFlow(const HybridSystem& system, int field, const Eigen::VectorXd& x0, const Eigen::VectorXd& par,
             const FlowOptions& options);
  CvodesFlow(const CvodesFlow&) = delete;
  CvodesFlow& operator=(const CvodesFlow&) = delete;
  ~CvodesFlow();

  /// Stop where one of these event functions falls through zero (event_watch.hpp says what counts). Once, before the
  /// first advance(). CVODES finds the zeros of h and of h_P = h_x f; the watch looks at every step it takes, so that a
  /// pair of crossings inside one step, near grazing, is not missed, and zeros that CVODES finds too close are no harm.
  void watch(const std::vector<int>& events);
  /// Called for every piece of the flow that has been passed, from one time to the next; state_at() is valid in it.
  /// False stops the flow (Progress::stopped).
  void on_piece(std::function<bool(double from, double to)> observer);
  /// Integrates on to `end_time` exactly, or to the next fall.
  Progress advance(double end_time);

  /// Which event function fell at the last Progress::root.
  int fallen() const;
  /// Least values of watched functions that did not reach zero, since the last call.
  std::vector<EventWatch::Contact> take_contacts();
  /// Has h_j been positive, so that it can fall?
  bool is_armed(int event) const;
  /// x(t) on the piece passed last.
  Eigen::VectorXd state_at(double t) const;
  /// The same without a copy, as long as this object lives.
  const DenseOutput& dense_output() const;

  double time() const;
  Eigen::VectorXd state() const;
  /// Phi, n x n: d x(t) / d x0. Empty without `variational`.
  Eigen::MatrixXd jacobian() const;
  /// X, n x active: d x(t) / d PAR(active). Empty without `variational`.
  Eigen::MatrixXd parameter_derivative() const;
  /// Why advance() failed.
  const std::string& message() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> p_;
};

}  // namespace tchat
