/// Grazing of an invariant torus: the least value of an event function over all of it,
///
///     psi = min over phi and tau of h(x(tau; phi)),
///
/// x(.; phi) the orbit of one return that starts at the phase phi: the trigonometric polynomial through the N orbits
/// (orbit/torus_system.hpp), node by node. On each orbit the least value is found as on a periodic orbit
/// (orbit/event_minima.hpp), polished by the flow, and then over phi between the neighbours of each that may have the
/// least one beside it.
#pragma once

#include "orbit/torus_system.hpp"
#include "stability/test_function.hpp"

namespace tchat {

struct TorusContact {
  double phi = 0.0;  ///< in [0, 1), of the return
  double tau = 0.0;  ///< along the segment
  double value = 0.0;
  Eigen::VectorXd state;
};

/// Finds the least values of one event function on one segment of the return.
class TorusContactSearch {
 public:
  /// `segment` counts from 0, within the return. `system` outlives this.
  TorusContactSearch(const TorusSystem& system, int segment, int event);

  int segment() const { return segment_; }
  int event() const { return event_; }
  /// Over the whole torus; nothing where h has neither a minimum on the segment nor ends of its own.
  std::optional<TorusContact> least(const Orbit& x, const CollocationRule& rule) const;
  /// The one near the phase phi, within the distance to the neighbouring orbits.
  std::optional<TorusContact> least_near(const Orbit& x, const CollocationRule& rule, double phi) const;

 private:
  double stationary(const Orbit& x, const CollocationRule& rule, double phi) const;
  double slope(const Orbit& x, const CollocationRule& rule, double phi) const;
  std::optional<TorusContact> at(const Orbit& x, const CollocationRule& rule, double phi) const;

  const TorusSystem& system_;
  PeriodicOrbitSystem one_return_;
  int segment_;
  int event_;
};

class TorusContactTest final : public TestFunction {
 public:
  /// Beyond a falling zero the torus violates the model: `stop` ends the branch there.
  TorusContactTest(const TorusSystem& system, int segment, int event, bool stop);
  std::string name() const override;
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  const TorusSystem& system_;
  TorusContactSearch search_;
  bool stop_;
};

/// The rotation number passes p / q, q = 1..4: a strong resonance, where the motion on the torus may lock and the torus
/// break. Where it is not broken, another parametrisation of the curve that goes with the rotation by p / q solves the
/// equations too, so that they are singular: the passage is told, not located.
class StrongResonanceTest final : public TestFunction {
 public:
  StrongResonanceTest(int p, int q) : p_(p), q_(q) {}
  std::string name() const override;
  bool is_only_reported() const override { return true; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  int p_, q_;
};

}  // namespace tchat
