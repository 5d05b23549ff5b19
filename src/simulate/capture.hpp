/// Regions around known periodic attractors from which the motion is known to come to them, so that a start can be left
/// where it has been captured.
///
/// After the last event of a period, in the state x, the region is (x - x*)' W (x - x*) < level, with W = sum over k of
/// (M^k)' D M^k, M the derivative of the return map (2.26) and D the inverse squares of the ranges: in the linear
/// approximation each return lowers that. How far this holds is tried: starts all around on the section, on an
/// ellipsoid of twice the size and inside it, must all come to the attractor, or the region is made smaller.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "model/hybrid_system.hpp"
#include "simulate/sample_record.hpp"

namespace tchat {

struct CaptureRegion {
  IndexVector event;       ///< after whose jump the state is looked at
  Eigen::VectorXd centre;  ///< x*
  Eigen::MatrixXd weight;  ///< W
  double level = 0.0;      ///< 0: nothing is captured

  double level_of(const Eigen::VectorXd& x) const { return (x - centre).dot(weight * (x - centre)); }
};

/// Of a periodic sample whose `last` is the state after the last event of its signature. `comes_to_it` simulates a
/// start to its end. Without a region (level 0) where the orbit is not stable enough, is no periodic one, or nothing
/// holds.
CaptureRegion capture_region(const HybridSystem& system, const AttractorSample& sample, const Eigen::VectorXd& par,
                             const std::function<bool(const MotionState&)>& comes_to_it);

/// Watches one motion.
class Capture {
 public:
  explicit Capture(const std::vector<CaptureRegion>& known) : known_(known), before_(known.size(), -1.0) {}

  /// The state x after an event: number, from 1, of the attractor in whose region it is for the second time, deeper
  /// than before; 0 while there is none.
  int look(const IndexVector& event, const Eigen::VectorXd& x);

 private:
  const std::vector<CaptureRegion>& known_;
  std::vector<double> before_;  // level at the last look in the region; -1 none
};

}  // namespace tchat
