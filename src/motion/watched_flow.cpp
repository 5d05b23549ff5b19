#include "motion/watched_flow.hpp"

#include "motion/cvodes_flow.hpp"
#include "motion/runge_kutta_flow.hpp"

namespace tchat {

std::unique_ptr<WatchedFlow> make_flow(const HybridSystem& system, int field, const Eigen::VectorXd& x0,
                                       const Eigen::VectorXd& par, const FlowOptions& options) {
  if (options.method == IntegrationMethod::runge_kutta)
    return std::make_unique<RungeKuttaFlow>(system, field, x0, par, options);
  return std::make_unique<CvodesFlow>(system, field, x0, par, options);
}

}  // namespace tchat
