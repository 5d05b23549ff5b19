/// Composite maps, reduced maps of tori, and the attractors of their iterates.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/levels.hpp"
#include "maps/discontinuity_map.hpp"
#include "maps/smooth_return.hpp"
#include "maps/torus_return.hpp"
#include "motion/growth_series.hpp"

namespace tchat {

// The composite map P = P_smooth o g_P (2.80), (2.81): one return of a trajectory near a grazing orbit or torus,
// contact included.

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

// Reduced composite maps of tori, of the phase phi alone (3.22), (3.34):
//
//     phi -> phase(g_P(u(phi))) + rho
//
// the dynamics along the invariant curve, as if the rest came back to it at once; and to lowest order (3.27), (3.39)
//
//     phi -> phi - r_1 sqrt(1 - (phi - phi*)^2 / r_2^2) + rho   for |phi - phi*| < r_2,   phi + rho elsewhere.

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

// What the iterates of a map settle on.

struct MapIteration {
  long transient = 1000;                ///< returns that are dropped
  long returns = 1000;                  ///< returns that are kept of a motion that does not repeat itself
  long most_returns = 64000;            ///< that exponents are computed over to tell its kind
  int max_period = 16;                  ///< in returns
  double recognition = level::located;  ///< states that are equal, relative to the range of the iterates
  double escape = 1.0;  ///< distance from the orbit or torus, in its extents, beyond which the map has no meaning
  int exponents = 0;    ///< how many are wanted always; without any they are computed to tell a kind
  std::function<bool()> interrupted;
};

struct MapAttractor {
  /// Periodic unless a multiplier says that the orbit is unstable; chaotic if chaos_evidence() finds it so.
  AttractorKind kind = AttractorKind::none;
  std::string message;  ///< why it has escaped or not settled
  int period = 0;       ///< in returns; 0: not periodic
  double time = 0.0;    ///< of one period; NaN
  /// Section states, n x K: one period, also of an unstable orbit, or all after the transient; with the penetration of
  /// each and whether it has been in contact.
  Eigen::MatrixXd points;
  Eigen::VectorXd penetrations;
  std::vector<bool> contacts;
  std::optional<LyapunovSpectrum> spectrum;  ///< per unit of time; of a periodic orbit by its multipliers
  Eigen::VectorXd last;                      ///< to go on from
};

/// Iterates from x0. What goes wrong is a value; ComputationError when interrupted.
MapAttractor iterate_to_attractor(const IteratedMap& map, const Eigen::VectorXd& x0, const ParameterVector& par,
                                  const MapIteration& settings);

}  // namespace tchat
