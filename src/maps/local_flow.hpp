/// Short flows near a grazing point, in deviations d = x - x*.
///
/// With deviations all that is small keeps its digits: the field's rounding is relative to the length of the flow, and
/// h_D, h_P and what a jump changes come from integrals of their gradients between x* and x* + d instead of differences
/// of values. Along the flow h_D' = h_P and h_P' = a(x) = h_{P,x} f are integrated with it.
///
/// x* is taken to lie on h_D = h_P = 0 and to be left as it is by the jump, exactly, at the parameters `base`.
/// Explicit Runge-Kutta steps of order 8 with errors at rounding level. Flows that cannot be followed (a function
/// without a value, a zero that is not there) return false.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "maps/cross_section.hpp"
#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "model/parameter_vector.hpp"
#include "orbit/ring_system.hpp"

namespace tchat {

class LocalFlow {
 public:
  /// Views of all four, which outlive this object. `contact`: (f, h_D, g_D). Deviations are from x*, at parameters
  /// `par`.
  LocalFlow(const HybridSystem& system, const IndexVector& contact, const Eigen::VectorXd& x_star,
            const ParameterVector& base, const ParameterVector& par);

  const ParameterVector& parameters() const { return par_; }

  double height(const Eigen::VectorXd& d);                    ///< h_D(x* + d)
  Eigen::VectorXd height_gradient(const Eigen::VectorXd& d);  ///< h_{D,x} there
  double rate(const Eigen::VectorXd& d);                      ///< h_P(x* + d)
  double acceleration(const Eigen::VectorXd& d);              ///< h_{P,x} f there
  /// Of P' (or its level through x*): its function and gradient at x* + d.
  double section(const CrossSection& section, const Eigen::VectorXd& d);
  Eigen::VectorXd section_gradient(const CrossSection& section, const Eigen::VectorXd& d);
  Eigen::VectorXd field(const Eigen::VectorXd& d);
  /// g_D(x* + d) - x*; `derivative`, where given, is multiplied by g_{D,x} from the left.
  Eigen::VectorXd jumped(const Eigen::VectorXd& d, Eigen::MatrixXd* derivative = nullptr);

  /// d flows to where h_D has risen by y^2 from its least value: backward for y > 0, forward for y < 0 (2.63, 2.66).
  /// `derivative` (n columns of changes of d) becomes that of the flow to the surface h_D = 0 itself.
  bool to_height(Eigen::VectorXd& d, double y, Eigen::MatrixXd* derivative = nullptr);
  /// d flows to h_P = 0 (2.65, 2.67).
  bool to_least_height(Eigen::VectorXd& d, Eigen::MatrixXd* derivative = nullptr);
  /// d flows to P' (2.74, 2.76).
  bool to_section(Eigen::VectorXd& d, const CrossSection& section, Eigen::MatrixXd* derivative = nullptr);

 private:
  struct Motion;
  Motion motion(const Eigen::VectorXd& d, const CrossSection* section, bool variational) const;
  void slopes(const Motion& motion, const std::vector<double>& z, std::vector<double>& out);
  bool follow(Motion& motion, double time);
  bool to_zero(Motion& motion);
  Eigen::VectorXd state(const Eigen::VectorXd& d) const { return x_star_ + d; }
  void change(const Motion& motion, const Eigen::VectorXd& gradient, Eigen::MatrixXd& derivative);

  const HybridSystem& system_;
  IndexVector contact_;
  const Eigen::VectorXd& x_star_;
  const ParameterVector& base_;
  const ParameterVector& par_;
  bool is_at_base_;
  SurfaceRate surface_;
  Eigen::VectorXd x_, f_, g_;
  Eigen::MatrixXd fx_;
  double height_offset_ = 0.0, rate_offset_ = 0.0;  // of x* at `par`
  Eigen::VectorXd jump_offset_;
};

}  // namespace tchat
