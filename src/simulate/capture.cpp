#include "simulate/capture.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "model/events.hpp"
#include "motion/orbit_correction.hpp"
#include "motion/orbit_flow.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int probes = 64;
constexpr int shrinkings = 12;
constexpr double widest = 1.0;    // of the region tried first, in ranges
constexpr double slowest = 1e12;  // of W: slower orbits capture nothing

/// Directions that fill the sphere evenly, the same ones in every process.
VectorXd probe_direction(int k, Eigen::Index n) {
  VectorXd direction(n);
  for (Eigen::Index i = 0; i < n; ++i)
    direction(i) = std::sin(1.0 + 12.9898 * (k + 1) + 78.233 * static_cast<double>((i + 1) * (i + 2)) +
                            0.618 * k * static_cast<double>(i));
  return direction / direction.norm();
}

/// Starts around an orbit, on the section of its last event.
class CaptureProbe {
 public:
  CaptureProbe(const HybridSystem& system, const VectorXd& par, const CaptureRegion& region, const VectorXd& end,
               const VectorXd& range)
      : system_(system), par_(par), region_(region), end_(end), range_(range) {}

  /// The state after the jump in direction k with about this level; empty when there is none.
  VectorXd at_level(int k, double level) const {
    const VectorXd direction = probe_direction(k, end_.size()).cwiseProduct(range_);
    double length = std::sqrt(level);
    VectorXd x;
    for (int round = 0; round < 6; ++round) {
      x = after_jump(end_ + length * direction);
      if (x.size() == 0) return x;
      const double now = region_.level_of(x);
      if (!(now > 0.0)) return {};
      if (std::abs(now - level) < 0.05 * level) break;
      length *= std::sqrt(level / now);
    }
    return x;
  }

 private:
  /// Onto the surface of the event, then the jump.
  VectorXd after_jump(VectorXd x) const {
    const std::optional<VectorXd> met =
        onto_surface(system_, region_.event.event, no_function, std::move(x), par_.data(), range_);
    if (!met) return {};
    VectorXd g(met->size());
    system_.value(FunctionKind::jump, region_.event.jump, met->data(), par_.data(), g.data());
    return g.allFinite() ? g : VectorXd();
  }

  const HybridSystem& system_;
  const VectorXd& par_;
  const CaptureRegion& region_;
  const VectorXd& end_;
  const VectorXd& range_;
};

}  // namespace

CaptureRegion capture_region(const HybridSystem& system, const AttractorSample& sample, const VectorXd& par,
                             const std::function<bool(const MotionState&)>& comes_to_it) {
  CaptureRegion region;
  if (sample.kind != AttractorKind::periodic) return region;
  region.event = sample.signature.back();
  region.centre = sample.last.x;
  const ReturnMap map = return_map(system, sample.signature, region.centre, par);
  if (!map.ok || !map.derivative.allFinite()) return region;
  const VectorXd sizes = sample.sizes.cwiseMax(std::numeric_limits<double>::min());
  region.weight = decay_weight(map.derivative, sizes);
  if (!region.weight.allFinite() || region.weight.norm() * sizes.squaredNorm() > slowest) return region;

  const CaptureProbe probe(system, par, region, map.segments.back().end, sizes);
  double radius = widest;
  for (int shrinking = 0; shrinking < shrinkings; ++shrinking, radius *= 0.5) {
    bool all_come = true;
    for (int k = 0; k < probes && all_come; ++k) {
      const double share = k % 3 == 2 ? 0.5 : 1.0;
      const VectorXd x = probe.at_level(k, std::pow(share * radius, 2));
      all_come = x.size() > 0 && comes_to_it({x, sample.last.watched});
    }
    if (!all_come) continue;
    region.level = std::pow(0.5 * radius, 2);
    return region;
  }
  return region;
}

int Capture::look(const IndexVector& event, const VectorXd& x) {
  for (std::size_t k = 0; k < known_.size(); ++k) {
    const CaptureRegion& region = known_[k];
    if (region.level <= 0.0 || event != region.event) continue;
    const double level = region.level_of(x);
    if (!(level < region.level)) {
      before_[k] = -1.0;
      continue;
    }
    if (before_[k] >= 0.0 && level <= before_[k]) return static_cast<int>(k) + 1;
    before_[k] = level;
  }
  return 0;
}

}  // namespace tchat
