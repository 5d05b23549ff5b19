/// P_smooth of a periodic orbit in grazing contact: its Taylor polynomial at x*, in the state and in parameters.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "maps/quadratic_map.hpp"
#include "maps/section_map.hpp"
#include "maps/suspended_system.hpp"
#include "model/index_vector.hpp"
#include "motion/flow_options.hpp"

namespace tchat {

/// The orbit as it is cut: from x*, index vectors, durations.
struct GrazingTurn {
  Eigen::VectorXd x;    ///< x*, on P, n
  ParameterVector par;  ///< p*
  /// From x* to x*; the last one ends at x*, whatever its event. Jumps may be `no_function`.
  Signature segments;
  std::vector<double> durations;  ///< of each
  Eigen::VectorXd extent;         ///< range of each state over the orbit, n
};

class PeriodicReturn : public SmoothMap {
 public:
  /// `section` is the event function of `suspended` that is the section: `suspended.least_distance()`, its plane, or
  /// one of the problem's. `order` 1 or 2. Throws ComputationError when the turn does not come back to x*.
  PeriodicReturn(std::shared_ptr<const SuspendedSystem> suspended, const GrazingTurn& turn, int section, int order,
                 const FlowOptions& options = {});

  Eigen::VectorXd image(const Eigen::VectorXd& x, const ParameterVector& par) const override;
  Eigen::MatrixXd derivative(const Eigen::VectorXd& x, const ParameterVector& par) const override;
  double time(const Eigen::VectorXd&) const override { return map_.time; }
  const Eigen::VectorXd& extent() const override { return extent_; }
  double distance(const Eigen::VectorXd& x) const override;

  /// In (x, q) of the suspended system.
  const QuadraticMap& map() const { return map_; }
  const Signature& path() const { return path_; }

 private:
  std::shared_ptr<const SuspendedSystem> suspended_;
  Signature path_;
  QuadraticMap map_;
  Eigen::VectorXd extent_;
};

}  // namespace tchat
