#include "maps/composite_map.hpp"

#include <cmath>
#include <utility>

namespace tchat {

using Eigen::MatrixXd;
using Eigen::VectorXd;

double event_range(const GrazingPoint& point, const VectorXd& extent) {
  return point.event_gradient.cwiseAbs().dot(extent);
}

LocalContact::LocalContact(std::shared_ptr<const SmoothMap> smooth, std::shared_ptr<const DiscontinuityMap> map,
                           MapOrder order, double neighbourhood)
    : smooth_(std::move(smooth)),
      map_(std::move(map)),
      order_(order),
      neighbourhood_(neighbourhood),
      range_(event_range(map_->point(), smooth_->extent())) {}

double LocalContact::distance(const VectorXd& x) const {
  return smooth_->difference(x, map_->point().x).cwiseQuotient(smooth_->extent()).cwiseAbs().maxCoeff();
}

VectorXd LocalContact::beside(const VectorXd& x) const {
  return map_->point().x + smooth_->difference(x, map_->point().x);
}

LocalContact::Result LocalContact::apply(const VectorXd& x, const ParameterVector& par) const {
  const bool near = distance(x) <= neighbourhood_;
  // On P h_D itself tells of contact anywhere; on P' only where the flow to P is short.
  const double penetration = near || !map_->section() ? map_->penetration(beside(x), par) : NAN;
  const bool contact = near && penetration > 0.0;
  const bool missed = !near && penetration > 0.0;
  return {contact ? map_->apply(beside(x), par, order_) : x, penetration, contact, missed,
          contact ? penetration / range_ : 0.0};
}

MatrixXd LocalContact::derivative(const VectorXd& x, const ParameterVector& par) const {
  if (!(distance(x) <= neighbourhood_)) return MatrixXd::Identity(x.size(), x.size());
  return map_->derivative(beside(x), par, order_);
}

Iterate CompositeMap::step(const VectorXd& x, const ParameterVector& par) const {
  const LocalContact::Result after = contact_.apply(x, par);
  Iterate iterate{{}, after.penetration, after.contact, after.missed, smooth().time(after.x), after.depth};
  iterate.image = smooth().image(after.x, par);
  return iterate;
}

MatrixXd CompositeMap::tangent(const VectorXd& x, const ParameterVector& par) const {
  const LocalContact::Result after = contact_.apply(x, par);
  const MatrixXd smooth_part = smooth().derivative(after.x, par);
  return after.contact ? MatrixXd(smooth_part * contact_.derivative(x, par)) : smooth_part;
}

}  // namespace tchat
