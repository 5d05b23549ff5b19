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

#include "model/hybrid_system.hpp"
#include "motion/watched_flow.hpp"

namespace tchat {

class CvodesFlow final : public WatchedFlow {
 public:
  /// `par` has the room of the problem's ParameterLayout. A view of `system`, which outlives this object.
  CvodesFlow(const HybridSystem& system, int field, const Eigen::VectorXd& x0, const Eigen::VectorXd& par,
             const FlowOptions& options);
  CvodesFlow(const CvodesFlow&) = delete;
  CvodesFlow& operator=(const CvodesFlow&) = delete;
  ~CvodesFlow() override;

  /// CVODES finds the zeros of h and of h_P = h_x f; the watch looks at every step it takes, so that a pair of
  /// crossings inside one step, near grazing, is not missed, and zeros that CVODES finds too close are no harm.
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
  /// Phi, n x n: d x(t) / d x0. Empty without `variational`.
  Eigen::MatrixXd jacobian() const;
  /// X, n x active: d x(t) / d PAR(active). Empty without `variational`.
  Eigen::MatrixXd parameter_derivative() const;
  const std::string& message() const override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> p_;
};

}  // namespace tchat
