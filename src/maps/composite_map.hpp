/// The composite map P = P_smooth o g_P (2.80), (2.81): one return of a trajectory near a grazing orbit or torus,
/// contact included.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>

#include "maps/discontinuity_map.hpp"
#include "maps/section_map.hpp"

namespace tchat {

/// g_P near x*, the identity elsewhere.
class LocalContact {
 public:
  /// `neighbourhood`: the largest distance from x*, states by `smooth`'s extents, at which contact is accounted for; of
  /// a torus other parts of the attractor may come by where h_D < 0 is no matter of x*.
  LocalContact(std::shared_ptr<const SmoothMap> smooth, std::shared_ptr<const DiscontinuityMap> map, MapOrder order,
               double neighbourhood = std::numeric_limits<double>::infinity());

  struct Result {
    Eigen::VectorXd x;
    double penetration = 0.0;  ///< NaN where it has no value: far from x* on P'
    bool contact = false;
    bool missed = false;  ///< positive, but outside the neighbourhood
    double depth = 0.0;   ///< see Iterate
  };
  Result apply(const Eigen::VectorXd& x, const ParameterVector& par) const;
  Eigen::MatrixXd derivative(const Eigen::VectorXd& x, const ParameterVector& par) const;

  const DiscontinuityMap& map() const { return *map_; }
  const SmoothMap& smooth() const { return *smooth_; }

 private:
  double distance(const Eigen::VectorXd& x) const;
  /// Where angles have gone round, the same point by the side of x*.
  Eigen::VectorXd beside(const Eigen::VectorXd& x) const;

  std::shared_ptr<const SmoothMap> smooth_;
  std::shared_ptr<const DiscontinuityMap> map_;
  MapOrder order_;
  double neighbourhood_;
  double range_;  // of h_D over the motion
};

/// What h_D ranges over when states range over `extent`.
double event_range(const GrazingPoint& point, const Eigen::VectorXd& extent);

class CompositeMap : public IteratedMap {
 public:
  explicit CompositeMap(LocalContact contact) : contact_(std::move(contact)) {}

  Iterate step(const Eigen::VectorXd& x, const ParameterVector& par) const override;
  Eigen::MatrixXd tangent(const Eigen::VectorXd& x, const ParameterVector& par) const override;
  Eigen::Index coordinates() const override { return contact_.map().point().x.size(); }
  Eigen::Index exponents() const override { return coordinates() - 1; }
  const SmoothMap& smooth() const override { return contact_.smooth(); }

 private:
  LocalContact contact_;
};

}  // namespace tchat
