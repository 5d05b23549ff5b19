/// One initial value problem x' = f_i(x, p), x(0) = x0, integrated by CVODES with root finding on one event function.
///
/// With it, if wanted, the variational equations Phi' = f_x Phi, Phi(0) = Id, and X' = f_x X + f_p, X(0) = 0, as
/// forward sensitivities under the same error control. The integrator's linear systems are dense, n x n.
/// Trouble of the integrator is a value (Progress::failed, message()), never an exception.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "hybrid/hybrid_system.hpp"
#include "simulation/flow_options.hpp"

namespace tchat {

enum class Progress { root, end_time, failed };

class CvodesFlow {
 public:
  /// `par` has parameter_length entries. A view of `system`, which outlives this object.
  CvodesFlow(const HybridSystem& system, int field, const Eigen::VectorXd& x0, const Eigen::VectorXd& par,
             const FlowOptions& options);
  ~CvodesFlow();

  /// Stop where event function j falls through zero (from + to -). Once, before the first advance(). The zeros of
  /// h_P = h_x f where h is least are found too, and the sign of h there is looked at (2.57-2.60), so that a pair of
  /// crossings inside one step, near grazing, is not missed.
  void watch(int event);
  /// Integrates on to `end_time` exactly, or to the next root.
  Progress advance(double end_time);

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
