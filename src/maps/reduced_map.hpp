/// Reduced composite maps of tori, of the phase phi alone (3.22), (3.34):
///
///     phi -> phase(g_P(u(phi))) + rho
///
/// the dynamics along the invariant curve, as if the rest came back to it at once; and to lowest order (3.27), (3.39)
///
///     phi -> phi - r_1 sqrt(1 - (phi - phi*)^2 / r_2^2) + rho   for |phi - phi*| < r_2,   phi + rho elsewhere.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "maps/composite_map.hpp"
#include "maps/torus_return.hpp"

namespace tchat {

class ReducedMap : public IteratedMap {
 public:
  ReducedMap(std::shared_ptr<const TorusReturn> smooth, LocalContact contact)
      : smooth_(std::move(smooth)), contact_(std::move(contact)) {}

  /// Of the point of the curve that x is projected to; its image is on the curve.
  Iterate step(const Eigen::VectorXd& x, const ParameterVector& par) const override;
  /// 1 x 1: d phi' / d phi.
  Eigen::MatrixXd tangent(const Eigen::VectorXd& x, const ParameterVector& par) const override;
  Eigen::Index coordinates() const override { return 1; }
  Eigen::Index exponents() const override { return 1; }
  const SmoothMap& smooth() const override { return *smooth_; }

 private:
  std::shared_ptr<const TorusReturn> smooth_;
  LocalContact contact_;
};

/// What contact does to the phase, to lowest order: half a height r_1 and half a width r_2 of the ellipse.
struct ContactEllipse {
  double phase = 0.0;   ///< phi* of the grazing point
  double height = 0.0;  ///< r_1, with its sign; 0 without contact
  double width = 0.0;   ///< r_2
  double depth = 0.0;   ///< penetration of the curve at phi*
};

class EllipseMap : public IteratedMap {
 public:
  /// x* = u(phi*): `phase`.
  EllipseMap(std::shared_ptr<const TorusReturn> smooth, std::shared_ptr<const DiscontinuityMap> map, double phase);

  ContactEllipse ellipse(const ParameterVector& par) const;
  /// The second derivative of h_D along the curve at x*, by phi.
  double curvature() const { return curvature_; }

  Iterate step(const Eigen::VectorXd& x, const ParameterVector& par) const override;
  Eigen::MatrixXd tangent(const Eigen::VectorXd& x, const ParameterVector& par) const override;
  Eigen::Index coordinates() const override { return 1; }
  Eigen::Index exponents() const override { return 1; }
  const SmoothMap& smooth() const override { return *smooth_; }

 private:
  std::shared_ptr<const TorusReturn> smooth_;
  std::shared_ptr<const DiscontinuityMap> map_;
  double phase_;
  double curvature_ = 0.0;
  double shift_ = 0.0;  // of phi for each sqrt(penetration)
};

}  // namespace tchat
