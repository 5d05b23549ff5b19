/// P_smooth near the invariant curve of a torus (3.20), (3.33), (4.13):
///
///     P(x, p) = u(phi + rho) + A(phi) (x - u(phi)) + A_p(phi) (p - p_0) [+ second order],   phi the projection of x
///
/// u(phi + rho) is exact on the curve; the derivatives are computed at equal phases by the variational equations and
/// interpolated by trigonometric polynomials. Where the flow does not depend on a parameter (that of h_D alone) A_p is
/// zero to rounding, and so is the torus's dependence on it.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "maps/invariant_curve.hpp"
#include "maps/section_map.hpp"
#include "maps/suspended_system.hpp"
#include "motion/flow_options.hpp"

namespace tchat {

struct TorusSettings {
  int order = 1;           ///< or 2
  int most_nodes = 1024;   ///< phases at which derivatives are computed: doubled up to this,
  double accuracy = 1e-7;  ///< until the highest harmonics are so small beside the largest
  /// Points of the curve lie on the section to the accuracy of the simulation alone.
  FlowOptions flow{.relative_tolerance = 1e-13, .absolute_tolerance = 1e-14, .surface_tolerance = 1e-5, .active = {}};
};

class TorusReturn : public SmoothMap {
 public:
  /// `par`: of the simulation that the curve comes from. `section`: an event function of `suspended`. Throws UserError
  /// when the flow does not take the curve to itself: points and parameters do not belong together; ComputationError
  /// when it cannot be integrated, or the derivatives vary too much for so many nodes.
  TorusReturn(std::shared_ptr<const SuspendedSystem> suspended, InvariantCurve curve, CurveProjection projection,
              const ParameterVector& par, int section, const TorusSettings& settings);

  Eigen::VectorXd image(const Eigen::VectorXd& x, const ParameterVector& par) const override;
  Eigen::MatrixXd derivative(const Eigen::VectorXd& x, const ParameterVector& par) const override;
  double time(const Eigen::VectorXd& x) const override;
  Eigen::VectorXd difference(const Eigen::VectorXd& x, const Eigen::VectorXd& y) const override {
    return curve_.difference(x, y);
  }
  const Eigen::VectorXd& extent() const override { return scale_; }
  double distance(const Eigen::VectorXd& x) const override;

  /// u(phi), angles between 0 and 2 pi.
  Eigen::VectorXd on_curve(double phi) const;
  const InvariantCurve& curve() const { return curve_; }
  const CurveProjection& projection() const { return projection_; }
  const ParameterVector& parameters() const { return par_; }
  int nodes() const { return nodes_; }
  /// Largest |P(u(phi)) - u(phi + rho)| at the nodes, relative to the extents.
  double defect() const { return defect_; }
  /// Of the interpolated derivatives between the nodes, relative to the largest: the size of the highest harmonics.
  double interpolation_error() const { return interpolation_error_; }
  /// Does the smooth flow, and with it the torus, depend on the parameters that it is expanded in?
  bool depends_on_parameters() const { return depends_; }
  double mean_time() const { return mean_time_; }

 private:
  Eigen::Index dimension() const { return curve_.dimension(); }
  struct Deviation {
    double phi;
    Eigen::VectorXd u;  // (x, q) less (u(phi), q_0)
  };
  struct Nodes;
  Nodes nodes_at(int count, const Nodes& known, const ParameterVector& par, int section,
                 const TorusSettings& settings) const;
  Deviation deviation(const Eigen::VectorXd& x, const ParameterVector& par) const;
  Eigen::MatrixXd matrix(double phi, int derivative) const;
  Eigen::VectorXd quadratic(double phi, const Eigen::VectorXd& u, int derivative) const;

  std::shared_ptr<const SuspendedSystem> suspended_;
  InvariantCurve curve_;
  CurveProjection projection_;
  ParameterVector par_;
  Eigen::VectorXd parameters_along_;
  Eigen::VectorXd scale_;
  TrigonometricSeries first_;   // n x N derivatives, column by column
  TrigonometricSeries second_;  // of each component the upper triangle; no rows for first order
  TrigonometricSeries times_;
  int nodes_ = 0;
  double defect_ = 0.0, interpolation_error_ = 0.0, mean_time_ = 0.0;
  bool depends_ = false;
};

}  // namespace tchat
