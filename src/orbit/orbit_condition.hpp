/// What a curve in two parameters adds to the equations of one solution.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "orbit/orbit.hpp"

namespace tchat {

class CondensedSystem;

/// The vectors of a multiplier at the ends of segments, of any length: S(mu) right = 0, left S(mu) = 0
/// (condensed_return_map.hpp).
struct CriticalVectors {
  std::complex<double> multiplier;
  Eigen::VectorXcd right, left;
};

/// A function G of the orbit, durations and free parameters, of a few numbers, with its gradients.
class OrbitCondition {
 public:
  static constexpr int most = 5;

  virtual ~OrbitCondition() = default;
  /// How many numbers; constant.
  virtual int count() const { return 1; }
  /// G and its gradients at x, whose linearisation is in `condensed`. False when they cannot be found.
  virtual bool evaluate(CondensedSystem& condensed, const Orbit& x) = 0;
  /// Of number k = 0 .. count() - 1.
  virtual double value(int k) const = 0;
  virtual const OrbitVector& gradient(int k) const = 0;
  /// The multiplier that is kept exactly, where it is one number: 1 or -1.
  virtual std::optional<int> kept_multiplier() const { return std::nullopt; }
  /// The vectors of the multiplier that is kept on the unit circle, in the closed upper half plane, at the point of the
  /// last evaluation. False where there is no such multiplier.
  virtual bool put_critical_vectors(CriticalVectors& /*vectors*/) const { return false; }
  /// "" on the curve, or why the last point, which solves the equations, lies beyond its end.
  virtual std::string beyond_end() const { return {}; }

  /// What evaluations near the point of the last one begin from; `memory` is overwritten, empty before the first one.
  virtual void remember(std::vector<double>& memory) const = 0;
  virtual void recall(const std::vector<double>& memory) = 0;
};

/// What linearisations near a point of the branch begin from; empty without a condition.
using ConditionMemory = std::vector<double>;

}  // namespace tchat
