#include "maps/reduced_map.hpp"

#include <cmath>
#include <utility>

#include "base/user_error.hpp"
#include "maps/circle.hpp"

namespace tchat {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Iterate ReducedMap::step(const VectorXd& x, const ParameterVector& par) const {
  const InvariantCurve& curve = smooth_->curve();
  const VectorXd on_curve = smooth_->on_curve(smooth_->projection().phase(x));
  const LocalContact::Result after = contact_.apply(on_curve, par);
  const double phi = smooth_->projection().phase(after.x);
  return {smooth_->on_curve(phi + curve.rotation()),
          after.penetration,
          after.contact,
          after.missed,
          smooth_->time(after.x),
          after.depth};
}

MatrixXd ReducedMap::tangent(const VectorXd& x, const ParameterVector& par) const {
  const CurveProjection& projection = smooth_->projection();
  const double phi = projection.phase(x);
  const VectorXd on_curve = smooth_->on_curve(phi);
  const LocalContact::Result after = contact_.apply(on_curve, par);
  if (!after.contact) return MatrixXd::Ones(1, 1);
  return projection.gradient(after.x, projection.phase(after.x)) * contact_.derivative(on_curve, par) *
         smooth_->curve().derivative(phi);
}

EllipseMap::EllipseMap(std::shared_ptr<const TorusReturn> smooth, std::shared_ptr<const DiscontinuityMap> map,
                       double phase)
    : smooth_(std::move(smooth)), map_(std::move(map)), phase_(phase) {
  const ParameterVector& par = map_->point().par;
  const VectorXd at = map_->point().x;
  // By differences of fourth order: P' is reached by the flow.
  const auto depth = [&](double t) {
    const VectorXd x = at + smooth_->curve().difference(smooth_->on_curve(phase_ + t), smooth_->on_curve(phase_));
    return map_->penetration(x, par);
  };
  const double t = 2e-3;
  const double first = depth(t) + depth(-t) - 2.0 * depth(0.0);
  const double second = depth(2.0 * t) + depth(-2.0 * t) - 2.0 * depth(0.0);
  curvature_ = -(16.0 * first - second) / (12.0 * t * t);
  if (!(curvature_ > 0.0))
    throw UserError(
        "the torus touches the wall along more than a point, or from behind: h_D has no minimum along the "
        "invariant curve at the grazing point");
  const CurveProjection& projection = smooth_->projection();
  shift_ = projection.gradient(at, projection.phase(at)).dot(map_->expansion().y);
}

ContactEllipse EllipseMap::ellipse(const ParameterVector& par) const {
  ContactEllipse ellipse{phase_, 0.0, 0.0, map_->penetration(map_->point().x, par)};
  if (!(ellipse.depth > 0.0)) return ellipse;
  ellipse.height = -shift_ * std::sqrt(ellipse.depth);
  ellipse.width = std::sqrt(2.0 * ellipse.depth / curvature_);
  return ellipse;
}

Iterate EllipseMap::step(const VectorXd& x, const ParameterVector& par) const {
  const double phi = smooth_->projection().phase(x);
  const ContactEllipse contact = ellipse(par);
  const double off = nearest_phase(phi - phase_);
  const double penetration = contact.depth - 0.5 * curvature_ * off * off;
  const bool touches = penetration > 0.0;
  const double moved = touches ? phi + shift_ * std::sqrt(penetration) : phi;
  return {smooth_->on_curve(moved + smooth_->curve().rotation()),
          penetration,
          touches,
          false,
          smooth_->time(smooth_->on_curve(moved)),
          touches ? penetration / event_range(map_->point(), smooth_->extent()) : 0.0};
}

MatrixXd EllipseMap::tangent(const VectorXd& x, const ParameterVector& par) const {
  const double phi = smooth_->projection().phase(x);
  const ContactEllipse contact = ellipse(par);
  const double off = nearest_phase(phi - phase_);
  const double penetration = contact.depth - 0.5 * curvature_ * off * off;
  if (!(penetration > 0.0)) return MatrixXd::Ones(1, 1);
  return MatrixXd::Constant(1, 1, 1.0 - shift_ * 0.5 * curvature_ * off / std::sqrt(penetration));
}

}  // namespace tchat
